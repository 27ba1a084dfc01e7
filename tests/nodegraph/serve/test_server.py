"""The command serves one browser on this machine, until it is interrupted."""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import urlopen

import pytest

from tests.browser import BROWSER, Tab, open_tab

_PATIENCE = 1000
_COMMAND = (sys.executable, "-m", "nodegraph.cli.main", "open", "runs/toy", "--no-browser")


@contextmanager
def served(*words: str) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """Start the command; yield the address that it prints."""
    with subprocess.Popen(
        [*_COMMAND, *words], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        try:
            assert process.stdout is not None
            yield process.stdout.readline().strip(), process
        finally:
            process.kill()


@pytest.mark.skipif(BROWSER is None, reason="needs Chromium")
def test_a_browser_opens_the_address_once(folder: Path, tmp_path: Path) -> None:
    shutil.rmtree("store")
    words = ("--plugin", "toys.py", "--store", "store")
    with served(*words) as (address, process), open_tab(tmp_path / "profile") as tab:
        host, _, _ = address.partition("/?token=")
        assert host.startswith("http://127.0.0.1:")
        tab.send("Page.navigate", url=address)
        wait(tab, "location.search === '' && document.querySelector('.served-bar')")
        assert tab.value("document.querySelector('h1').textContent") == "<script>bad()</script>"
        assert tab.value("document.cookie") == ""
        wait(tab, "window.packed")  # computed, as the store is gone
        assert tab.value("window.packed.inputs") == {"hold": {"estimate": 6, "truth": 5}}
        tab.send("Page.navigate", url=f"{host}/value?node=fill&at.start=1&at.fill=hold")
        wait(tab, "document.querySelector('#compute')")
        tab.click("#compute")
        wait(tab, "document.querySelector('.rendered')")
        assert tab.value("document.querySelector('.rendered').textContent.trim()") == "2.0"
        assert tab.console == []
        with pytest.raises(HTTPError, match="403"):
            urlopen(address)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
        assert (process.returncode, "Traceback" in errors) == (130, False)


def wait(tab: Tab, condition: str) -> None:
    """Wait until a condition holds in the page that the tab is on the way to."""
    for _ in range(_PATIENCE):
        with suppress(AssertionError):  # a page that is left in the meantime
            if tab.value(f"document.readyState === 'complete' && Boolean({condition})"):
                return
        time.sleep(0.02)
    pytest.fail(f"{condition}: {tab.console}")
