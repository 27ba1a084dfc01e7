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
    folder = files(_PACKAGE)
    scripts = [source("modules.js"), source("helpers.js"), source("theme.js")]
    bundle = folder.joinpath("codemirror", "codemirror.js").read_text(encoding="utf-8")
    own = (folder.joinpath("templates", f"{name}.js") for name in _SCRIPTS)
    scripts += [
        bundle,
        own_source("states.js"),
        *(script.read_text(encoding="utf-8") for script in own),
    ]
    style = folder.joinpath("templates", "editor.css").read_text(encoding="utf-8")
    return page_response(
        "editor.html",
        package=_PACKAGE,
        title=file.path.name,
        text=file.shown,
        scripts=scripts,
        styles=[style],
    )
