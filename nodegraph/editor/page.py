"""The page of a file that is edited, which shows its text before the nodes are loaded."""

from __future__ import annotations

from importlib.resources import files

from starlette.responses import Response

from nodegraph.editor.file import MOST_BYTES, EditedFile
from nodegraph.report.page import source
from nodegraph.serve.pages import own_source, page_response

MOST_BODY = 6 * MOST_BYTES + 1000
"""Bytes of a request with a text of the largest size, each character written as an escape."""

_SCRIPTS = ("text", "picture", "editor", "panel", "links", "run")
_PACKAGE = "nodegraph.editor"


def page(file: EditedFile) -> Response:
    """Return the page of a file."""
    bundle = files(_PACKAGE).joinpath("codemirror", "codemirror.js").read_text(encoding="utf-8")
    scripts = [source(f"{name}.js") for name in ("modules", "helpers", "theme")]
    scripts += [bundle, own_source("states.js")]
    scripts += [source(f"{name}.js", _PACKAGE) for name in _SCRIPTS]
    return page_response(
        "editor.html",
        package=_PACKAGE,
        title=file.path.name,
        text=file.shown,
        scripts=scripts,
        styles=[source("editor.css", _PACKAGE)],
    )
