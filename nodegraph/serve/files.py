"""The page of files: what they hold, played or drawn together, and what reading them guessed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from pathlib import Path

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from nodegraph.errors import Refusal
from nodegraph.execute.read_files import ReadFile
from nodegraph.plugin.hook_results import HookResults
from nodegraph.plugin.hook_types import Rendered
from nodegraph.report.page import SCRIPTS, source
from nodegraph.serve.pages import own_source, page_response


@dataclass(frozen=True)
class _Seen:
    """Files that are shown together, or why they are not.

    Attributes
    ----------
    rendered : Rendered or None
    message : str
    """

    rendered: Rendered | None
    message: str = ""


def application_of_files(files: Sequence[ReadFile], hooks: HookResults) -> Starlette:
    """Return the application that shows files; a `Guard` must stand before it."""
    response = _page(files, hooks)

    def page(request: Request) -> Response:
        return response

    return Starlette(routes=[Route("/", page)])


def _page(files: Sequence[ReadFile], hooks: HookResults) -> Response:
    named = _by_label(files)
    seen = list(_seen(named, hooks))
    rendered = [each.rendered for each in seen if each.rendered is not None]
    return page_response(
        "files.html",
        HTTPStatus.OK,
        title=", ".join(named),
        files=named,
        seen=seen,
        scripts=[
            *(source(f"{name}.js") for name in SCRIPTS),
            *dict.fromkeys(script for each in rendered for script in each.scripts),
        ],
        styles=[
            own_source("files.css"),
            *dict.fromkeys(style for each in rendered for style in each.styles),
        ],
        trusted=[each.html for each in rendered],
    )


def _by_label(files: Sequence[ReadFile]) -> Mapping[str, ReadFile]:
    """Return files by their names; by what the user wrote where several have one name."""
    names = [Path(file.path).name for file in files]
    is_alone = {name: bool(name) and count == 1 for name, count in Counter(names).items()}
    return {
        name if is_alone[name] else file.path: file for name, file in zip(names, files, strict=True)
    }


def _seen(files: Mapping[str, ReadFile], hooks: HookResults) -> Iterator[_Seen]:
    """Yield what each viewer shows of the files that are its own."""
    viewers = {label: hooks.viewer(file.value) for label, file in files.items()}
    for viewer in dict.fromkeys(viewers.values()):
        if viewer is not None:
            values = {label: files[label].value for label in files if viewers[label] is viewer}
            try:
                yield _Seen(viewer.view(values))
            except Refusal as refusal:
                yield _Seen(None, str(refusal))
