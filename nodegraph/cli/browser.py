"""Pages that a command serves, and the browser that shows them."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from nodegraph.errors import NodegraphError


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


def show(address: str) -> None:
    """Open an address in a browser, where there is a display."""
    is_desktop = sys.platform.startswith(("win", "darwin"))
    if is_desktop or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
        import webbrowser

        webbrowser.open(address)
