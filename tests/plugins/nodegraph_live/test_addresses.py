"""Addresses: what a wrong one is answered with, and what else ends in a message."""

from __future__ import annotations

import socket
import sys

import pytest

from nodegraph import NodegraphError
from nodegraph_live import nodegraph_sinks, nodegraph_sources
from tests.live_peers import HOST, free_port, sending

SOURCES = nodegraph_sources()
SINKS = nodegraph_sinks()


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("lsl:", "no name"),
        ("lsl:face?timeout=-1", "timeout is a number above 0, not '-1'"),
        ("qtm:127.0.0.1:http", "'http' is not a port from 1 to 65535"),
        ("qtm:127.0.0.1?timeout=inf", "timeout is a number above 0, not 'inf'"),
        ("natnet:127.0.0.1:99999", "'99999' is not a port from 1 to 65535"),
        ("natnet:127.0.0.1?rate=fast", "rate is a number above 0, not 'fast'"),
        ("vmc:39539?rate=60&hz=5", "no setting 'hz'; there is rate, timeout"),
        ("livelink:0", "'0' is not a port from 1 to 65535"),
        (f"udp:{'9' * 5000}", f"'{'9' * 5000}' is not a port from 1 to 65535"),
        ("udp:127.0.0.1:", "'' is not a port from 1 to 65535"),
    ],
)
def test_a_wrong_address_is_answered_with_the_form(address: str, message: str) -> None:
    scheme, _, rest = address.partition(":")
    with pytest.raises(NodegraphError) as caught:
        SOURCES[scheme](rest)
    assert str(caught.value).startswith(f"{address}: {message}; expected {scheme}:")


@pytest.mark.parametrize("scheme", ["livelink", "natnet", "qtm", "vmc", "udp"])
def test_an_unknown_host_is_named(scheme: str) -> None:
    rate = "?rate=60&timeout=0.3" if scheme == "vmc" else "?timeout=0.3"
    with pytest.raises(NodegraphError, match=r"nowhere\.invalid"):
        SOURCES[scheme](f"nowhere.invalid:5000{rate}").open()


@pytest.mark.parametrize("scheme", ["livelink", "vmc", "udp"])
def test_silence_garbage_and_a_port_in_use_end_in_a_message(scheme: str) -> None:
    port = free_port()
    source = SOURCES[scheme](f"{port}?timeout=0.3" + "&rate=60" * (scheme == "vmc"))
    nobody = rf"^{scheme}:.*at {HOST}:{port} in 0\.3 s; {HOST} receives .* 0\.0\.0\.0:{port} from"
    with pytest.raises(NodegraphError, match=nobody):
        source.open()
    with (
        sending([b"garbage"], port),
        pytest.raises(
            NodegraphError, match=r"in 0\.3 s; \d+ packets could not be decoded, the last because"
        ),
    ):
        source.open()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind((HOST, port))
        with pytest.raises(NodegraphError, match=f"another program receives at port {port}"):
            source.open()


def test_a_package_that_is_not_installed_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pylsl", None)
    monkeypatch.delitem(sys.modules, "nodegraph_live.lsl", raising=False)
    with pytest.raises(NodegraphError, match=r"^lsl: .* pip install 'nodegraph\[live\]'"):
        SOURCES["lsl"]("face")
