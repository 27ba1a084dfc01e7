"""The command serves one browser on this machine, until it is interrupted."""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.error import HTTPError
from urllib.parse import urlsplit
from urllib.request import urlopen

import pytest
from playwright.sync_api import Page

from tests.browser import until

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


def test_a_browser_opens_the_address_once(folder: Path, tab: Page) -> None:
    shutil.rmtree("store")
    words = ("--plugin", "toys.py", "--store", "store")
    with served(*words) as (address, process):
        host, _, _ = address.partition("/?token=")
        assert host.startswith("http://127.0.0.1:")
        tab.goto(address)
        tab.wait_for_selector(".served-bar")
        assert urlsplit(tab.url).query == ""
        assert tab.evaluate("document.querySelector('h1').textContent") == "<script>bad()</script>"
        assert tab.evaluate("document.cookie") == ""
        until(tab, "window.packed")  # computed, as the store is gone
        assert tab.evaluate("window.packed.inputs") == {"hold": {"estimate": 6, "truth": 5}}
        tab.goto(f"{host}/value?node=fill&at.start=1&at.fill=hold")
        tab.click("#compute")
        tab.wait_for_selector(".rendered")
        assert tab.evaluate("document.querySelector('.rendered').textContent.trim()") == "2.0"
        with pytest.raises(HTTPError, match="403"):
            urlopen(address)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
        assert (process.returncode, "Traceback" in errors) == (130, False)
