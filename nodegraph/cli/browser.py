"""Pages that a command serves, and the browser that shows them."""

from __future__ import annotations

import atexit
import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

from nodegraph.cli.output import say
from nodegraph.errors import NodegraphError

if TYPE_CHECKING:
    from nodegraph.serve.server import LocalServer

_PAGE = (
    '<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>nodegraph</title>'
    '<meta http-equiv="refresh" content="0; url={0}"><p><a href="{0}">Open the page</a></p></html>'
)


@contextmanager
def needing_pages() -> Iterator[None]:
    """Raise `NodegraphError` where an import within lacks what pages need."""
    try:
        yield
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("starlette", "uvicorn"):
            raise
        raise NodegraphError(
            "the pages need starlette and uvicorn; pip install 'nodegraph[open]'"
        ) from error


def serve(server: LocalServer, *, with_browser: bool) -> None:
    """Print the address of a page, open it if that is wanted, and serve it until the user ends."""
    print(server.address, flush=True)
    say("open this address in one browser; Ctrl-C ends it")
    if with_browser:
        show(server.address)
    server.run()


def show(address: str) -> None:
    """Open an address that lets one browser in, where there is a display.

    The command line of a browser can be read by every user of the machine, so that it names a file
    which leads to the address, and which only this user can read. Returns at once: some browsers
    end only when they are closed.
    """
    is_desktop = sys.platform.startswith(("win", "darwin"))
    if is_desktop or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
        import webbrowser

        folder = tempfile.mkdtemp(prefix="nodegraph-")
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        page = Path(folder, "open.html")
        page.touch(0o600)
        page.write_text(_PAGE.format(escape(address)), encoding="utf-8")
        Thread(target=webbrowser.open, args=(page.as_uri(),), daemon=True).start()
