"""The requests of the scripts of a page on which a file is edited."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from http import HTTPStatus
from threading import RLock
from typing import Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from nodegraph.editor.checking import Checking
from nodegraph.editor.completion import about, options_at
from nodegraph.editor.edits import Edits
from nodegraph.editor.file import EditedFile
from nodegraph.editor.links import Links
from nodegraph.editor.panel import axes_of, installed, panel_of
from nodegraph.editor.running import Running
from nodegraph.editor.view import Places, problems_of_files, unchecked_view_of, view_of
from nodegraph.errors import GraphError, NodegraphError
from nodegraph.graph import Choices, Graph, build
from nodegraph.plugin.registry import Registry
from nodegraph.serve.app import as_data, refused, routes, text_of
from nodegraph.serve.pages import events_response

_NOT_UNDERSTOOD = (ValueError, LookupError, TypeError, OverflowError, RecursionError)
"""What reading the body of a request raises."""

_Places = Mapping[str, Sequence[int]]
"""Labels of axes, by their places."""


def application(file: EditedFile, registry: Registry, running: Running) -> Starlette:
    """Return the application that edits and runs a file; a `Guard` must stand before it.

    Its page is `nodegraph.editor.page`.
    """
    page = _Page(file, registry, running)
    return Starlette(
        routes=[
            Route("/view", as_data(page.view)),
            Route("/revision", as_data(page.revision)),
            Route("/files", as_data(page.files)),
            Route("/options", _at_place(page.options), methods=["POST"]),
            Route("/about", _at_place(page.about), methods=["POST"]),
            Route("/node", as_data(page.node)),
            Route("/nodes", as_data(page.nodes)),
            Route("/targets", as_data(page.targets)),
            Route("/axes", as_data(page.axes)),
            Route("/edit", page.edit, methods=["POST"]),
            Route("/preview", as_data(page.preview)),
            Route("/running", page.running),
            *routes(running.runs),
        ]
    )


def _at_place(answer: Callable[[str, int], object]) -> Callable[..., Awaitable[Response]]:
    """Return an endpoint that answers about a place of a text, which the file need not have yet."""

    async def endpoint(request: Request) -> Response:
        try:
            data = json.loads(await request.body())
            text, at = str(data["text"]), int(data["at"])
        except _NOT_UNDERSTOOD as error:
            return JSONResponse({"message": f"not understood: {error!r}"}, HTTPStatus.BAD_REQUEST)
        index = Places(text, "").index(at)
        try:
            return JSONResponse(await run_in_threadpool(answer, text, index))
        except Exception as error:
            return refused(error)

    return endpoint


class _Page:
    def __init__(self, file: EditedFile, registry: Registry, running: Running) -> None:
        self._file = file
        self._running = running
        self._registry = registry
        self._edits = Edits(registry, file.path)
        self._lock = RLock()
        self._checking = Checking(lambda text: view_of(text, file.path, registry))

    def view(self, request: Request) -> object:
        """Return what is shown of the file now."""
        with self._lock:
            return self._shown()

    def files(self, request: Request) -> object:
        """Return what is wrong with files that the graph reads."""
        with self._lock:
            view, revision = self._checking.view_of(self._file.shown), self._file.revision
        graph = view.graph if view is not None else None
        problems = problems_of_files(graph, self._running.store) if graph is not None else []
        return {"revision": revision, "problems": problems}

    def preview(self, request: Request) -> object:
        """Return what a run of the graph would compute, at some labels of its axes or at all."""
        places = json.loads(request.query_params.get("only", "{}"))
        with self._lock:
            graph = self._graph_at(places)
        return self._running.preview(graph)

    async def running(self, request: Request) -> Response:
        """Send how far the run is, until it has ended."""
        if self._running.shown("") is None:
            return JSONResponse({"message": "nothing has been run"}, HTTPStatus.CONFLICT)
        return events_response(self._running.snapshot, lambda data: bool(data["is_over"]))

    def options(self, text: str, index: int) -> object:
        """Return the words that may stand at a place of a text."""
        word, options = options_at(text, index, self._registry)
        return {"word": word, "options": [each._asdict() for each in options]}

    def about(self, text: str, index: int) -> object:
        """Return what the word at a place of a text means."""
        option = about(text, index, self._registry)
        return option._asdict() if option else None

    def node(self, request: Request) -> object:
        """Return what is shown of the node that a request names."""
        name = request.query_params.get("name", "")
        return panel_of(self._file.text, name, self._registry, self._file.path)

    def nodes(self, request: Request) -> object:
        """Return the nodes that can be added; with a source, those that it can feed."""
        source = request.query_params.get("source", "")
        return installed(self._registry, self._links() if source else None, source)

    def targets(self, request: Request) -> object:
        """Return the ports that an output of the picture fits, and why it does not fit others."""
        box, port = (request.query_params.get(name, "") for name in ("box", "port"))
        return self._links().targets(box, port)

    def _links(self) -> Links:
        return Links(self._file.text, self._file.path, self._registry)

    def axes(self, request: Request) -> object:
        """Return the axes of the graph."""
        return axes_of(self._file.text, self._file.path.name)

    def revision(self, request: Request) -> object:
        """Return the revision, after a look at the file on the disk."""
        with self._lock:
            with suppress(GraphError):  # saving says it
                self._file.look()
            return self._file.revision

    async def edit(self, request: Request) -> Response:
        """Edit the text of the revision that a request names, and return what is shown then.

        A text of another revision is not changed: the answer is what is shown now.
        """
        try:
            data = json.loads(await request.body())
            revision, edit = data["revision"], self._edit_of(data)
        except _NOT_UNDERSTOOD as error:
            return JSONResponse({"message": f"not understood: {error!r}"}, HTTPStatus.BAD_REQUEST)
        return await run_in_threadpool(self._edited, revision, edit)

    def _edit_of(self, data: Mapping[str, Any]) -> Callable[[], None]:
        """Return what does the edit that a request asks for."""
        if "text" in data:
            return partial(self._file.edit, str(data["text"]))
        name, arguments = data["action"], data.get("arguments", {})
        actions = {
            "undo": self._file.undo,
            "redo": self._file.redo,
            "save": self._file.save,
            "save_to_run": self._save_to_run,
            "stop": self._running.stop,
            "take_theirs": self._file.take_theirs,
            "keep_mine": self._file.keep_mine,
        }
        if name in actions:
            return actions[name]
        if name == "run":
            return partial(self._run, {**{**arguments}.get("only", {})})
        edit = self._edits.named(name, arguments)
        return lambda: self._file.put(edit(self._file.text))

    def _save_to_run(self) -> None:
        """Save the text if it is a graph that can be run."""
        self._without_mistakes()
        self._file.save()

    def _run(self, places: _Places) -> None:
        """Run the file, which gets the text that is shown."""
        graph = self._graph_at(places)
        self._file.save()
        self._running.start(self._file.text, graph)

    def _graph_at(self, places: _Places) -> Graph:
        """Return the graph at these labels of axes, and at all of the axes that are not named."""
        graph = self._without_mistakes()
        try:
            only = {
                axis: tuple(graph.axes[axis].labels[place] for place in chosen)
                for axis, chosen in places.items()
            }
        except (LookupError, TypeError) as error:
            raise NodegraphError("the axes have changed meanwhile; choose labels again") from error
        return build(graph.spec, self._registry, Choices(only=only)) if only else graph

    def _without_mistakes(self) -> Graph:
        view = self._checking.view_of(self._file.shown)
        if view is None:
            raise NodegraphError("not run: the text is still checked; run it after that")
        if view.graph is None:
            raise NodegraphError("not run: there are mistakes in the text; mend them first")
        return view.graph

    def _edited(self, revision: object, edit: Callable[[], None]) -> Response:
        with self._lock:
            if revision != self._file.revision:
                return JSONResponse(self._shown(), HTTPStatus.CONFLICT)
            try:
                edit()
            except Exception as error:
                answer = {**self._shown(), "refused": text_of(error)}
                return JSONResponse(answer, HTTPStatus.UNPROCESSABLE_ENTITY)
            return JSONResponse(self._shown())

    def _shown(self) -> dict[str, object]:
        file = self._file
        text = file.shown
        checked = self._checking.view_of(text)
        view = checked or unchecked_view_of(text)
        return {
            "revision": file.revision,
            "text": text,
            "is_checked": checked is not None,
            "run": self._running.shown(file.text),
            "is_saved": file.is_saved,
            "can_undo": file.can_undo,
            "can_redo": file.can_redo,
            "theirs": file.theirs,
            "notice": file.notice,
            "problems": view.problems,
            "svg": view.svg,
            "reason": view.reason,
            "nodes": view.nodes,
            "wrong": view.wrong,
        }
