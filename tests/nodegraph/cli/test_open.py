"""``open`` says what it needs; what it serves is tested beside the server."""

from __future__ import annotations

import socket
import sys
from pathlib import Path

import pytest

from tests.nodegraph.cli.conftest import Command


def test_help_has_an_example(command: Command) -> None:
    status, out, _ = command("open", "--help", nodes=False)
    assert status == 0
    assert "nodegraph open runs/fill" in out


def test_a_missing_extra_is_named(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith("nodegraph.serve")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    status, _, err = command("open", "runs/toy")
    assert status == 2
    assert "pip install 'nodegraph[open]'" in err


def test_a_folder_without_runs_is_named(command: Command) -> None:
    Path("empty").mkdir()
    for folder in ("nowhere", "empty", "toy.yaml"):
        status, _, err = command("open", folder, "--no-browser")
        assert (status, folder in err) == (2, True)


def test_a_port_that_is_not_free_is_named(command: Command) -> None:
    assert command("run", "toy.yaml", "--until", "a", "--out", "ran")[0] == 0
    with socket.create_server(("127.0.0.1", 0)) as other:
        taken = other.getsockname()[1]
        for port in (taken, 99_999, -1):
            status, _, err = command("open", "ran", "--no-browser", "--port", str(port))
            assert (status, str(port) in err) == (2, True)
