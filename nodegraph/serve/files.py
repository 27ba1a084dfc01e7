"""The page of files: what they hold, played or drawn together, and what reading them guessed."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from pathlib import Path

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from nodegraph.errors import NodegraphError, Refusal
from nodegraph.execute.read_files import ReadFile, read_files
from nodegraph.plugin.hook_results import HookResults
from nodegraph.plugin.hook_types import Rendered
from nodegraph.plugin.registry import Registry
from nodegraph.report.page import SCRIPTS, source
from nodegraph.serve.pages import json_in_script, own_source, page_response
from nodegraph.whole_files import write_whole

MOST_BODY = 1 << 22
"""Bytes of what a page keeps of a file."""


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


def application_of_files(files: Sequence[ReadFile], registry: Registry) -> Starlette:
    """Return the application that shows files; a `Guard` must stand before it.

    Files beside them in which their viewers keep something are read with them. The page is made
    when it is first asked for, while the browser has the address already.
    """
    pages = _Pages(files, registry)
    return Starlette(routes=[Route("/", pages.page), Route("/kept", pages.keep, methods=["POST"])])


class _Pages:
    def __init__(self, files: Sequence[ReadFile], registry: Registry) -> None:
        self._files, self._registry = files, registry
        self._beside = {
            label: Path(file.path + viewer.beside)
            for label, file in _by_label(files).items()
            if (viewer := registry.hooks.viewer(file.value))
            and viewer.beside
            and Path(file.path).exists()
        }
        self._page: Response | None = None

    def page(self, request: Request) -> Response:
        """Show the page, with what is kept by now."""
        if self._page is None:
            try:
                self._page = self._rendered()
            except NodegraphError as error:
                return page_response(
                    "message.html", HTTPStatus.CONFLICT, title="Not shown", message=str(error)
                )
        return self._page

    async def keep(self, request: Request) -> Response:
        """Write what a page keeps of a file."""
        try:
            data = json.loads(await request.body())
            label, text, before = str(data["label"]), str(data["text"]), data["before"]
            path = self._beside[label]
        except (ValueError, LookupError, TypeError, RecursionError) as error:
            return JSONResponse({"message": f"not understood: {error!r}"}, HTTPStatus.BAD_REQUEST)
        try:
            if _text(path) != before:
                message = f"{path} has changed since the page was loaded; load it again"
                return JSONResponse({"message": message}, HTTPStatus.CONFLICT)
            await run_in_threadpool(write_whole, path, text)
        except (OSError, UnicodeError) as error:
            message = f"{path} cannot be written: {error}"
            return JSONResponse({"message": message}, HTTPStatus.CONFLICT)
        self._page = None
        return JSONResponse({})

    def _rendered(self) -> Response:
        named = [Path(file.path) for file in self._files]
        beside = [path for path in self._beside.values() if path.exists() and path not in named]
        files = [*self._files, *read_files(map(str, beside), self._registry)]
        return _page(files, self._registry.hooks, self._beside)


def _text(path: Path) -> str | None:
    try:
        with open(path, encoding="utf-8", newline="") as file:
            return file.read()
    except FileNotFoundError:
        return None


def _page(files: Sequence[ReadFile], hooks: HookResults, beside: Mapping[str, Path]) -> Response:
    named = _by_label(files)
    seen = list(_seen(named, hooks))
    rendered = [each.rendered for each in seen if each.rendered is not None]
    kept = {label: _text(path) for label, path in beside.items()}
    return page_response(
        "files.html",
        HTTPStatus.OK,
        title=", ".join(named),
        files=named,
        # the page changes what it keeps
        changing=[label for label, file in named.items() if Path(file.path) in beside.values()],
        seen=seen,
        scripts=[
            *(source(f"{name}.js") for name in SCRIPTS),
            own_source("kept.js").replace("__KEPT__", json_in_script(kept)),
            *(script for each in rendered for script in each.scripts),
        ],
        styles=[
            own_source("files.css"),
            *(style for each in rendered for style in each.styles),
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
