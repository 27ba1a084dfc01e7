"""The pages and the data that the server answers with."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from http import HTTPStatus
from typing import Any
from urllib.parse import quote

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from nodegraph.errors import GraphError, NodegraphError, listed, nearest
from nodegraph.execute.results import NotStored, Run
from nodegraph.formatting import labels_of
from nodegraph.report.merge import linked, merged
from nodegraph.report.page import SCRIPTS, page, source
from nodegraph.runs.record import Record
from nodegraph.runs.state import RunState
from nodegraph.runs.why import changes_since
from nodegraph.serve.computing import Computing
from nodegraph.serve.flow import flow
from nodegraph.serve.pages import (
    events_response,
    html_response,
    json_in_script,
    own_source,
    page_response,
)
from nodegraph.serve.runs import Condition, OpenRun, OpenRuns, entry_of
from nodegraph.serve.values import Combinations, Query, labels_in, packed, shown

_MOST_CHANGES = 5
_MOST_COMBINATIONS = 500
_Endpoint = Callable[..., Response]


class NotThere(NodegraphError):
    """Nothing has the name that a request asks for."""


def application(runs: OpenRuns) -> Starlette:
    """Return the application that answers for some runs; a `Guard` must stand before it."""
    return Starlette(routes=routes(runs))


def routes(runs: OpenRuns) -> list[Route]:
    """Return the pages of some runs, and what they request; ``/`` is the report, too."""
    pages = _Pages(runs)
    return [
        Route("/", _as_page(pages.report)),
        Route("/report", _as_page(pages.report)),
        Route("/runs", _as_page(pages.runs)),
        Route("/values", _as_page(pages.values)),
        Route("/value", _as_page(pages.value)),
        Route("/download", _as_page(pages.download)),
        Route("/files/{number:int}/{name:path}", _as_page(pages.file)),
        Route("/progress", pages.progress),
        Route("/detail", as_data(pages.detail)),
        Route("/flow", as_data(pages.flow)),
        Route("/compute", pages.compute, methods=["POST"]),
    ]


def _as_page(answer: Callable[[Request], Response]) -> _Endpoint:
    """Return an endpoint that shows errors as pages."""

    @wraps(answer)
    def endpoint(request: Request) -> Response:
        try:
            return answer(request)
        except Exception as error:
            return page_response(
                "message.html", _status(error), title="Not shown", message=text_of(error)
            )

    return endpoint


def as_data(answer: Callable[[Request], object]) -> _Endpoint:
    """Return an endpoint that gives JSON, errors too."""

    @wraps(answer)
    def endpoint(request: Request) -> Response:
        try:
            return JSONResponse(answer(request))
        except NotComputed as error:
            return JSONResponse(error.data, HTTPStatus.ACCEPTED)
        except Exception as error:
            return refused(error)

    return endpoint


def refused(error: Exception) -> Response:
    """Return an error as data."""
    return JSONResponse({"message": text_of(error)}, _status(error))


def _status(error: Exception) -> HTTPStatus:
    if isinstance(error, NotThere):
        return HTTPStatus.NOT_FOUND
    expected = isinstance(error, (NodegraphError, OSError))
    return HTTPStatus.CONFLICT if expected else HTTPStatus.INTERNAL_SERVER_ERROR


def text_of(error: Exception) -> str:
    """Return what an error says to the user, in one line."""
    if isinstance(error, GraphError):
        return "; ".join(map(str, error.problems))
    if isinstance(error, (NodegraphError, OSError)):
        return str(error)
    return f"internal error; please report it: {type(error).__name__}: {error}"


class NotComputed(NodegraphError):
    """The requested values must be computed first.

    Attributes
    ----------
    data : dict
        How many steps, and what has changed since the run.
    """

    def __init__(self, error: NotStored, run: Run, record: Record | None) -> None:
        super().__init__(str(error))
        self.data = {
            "missing": len(error.steps),
            "changed": _changes(run, record, error.steps),
            "message": str(error),
        }


def _changes(run: Run, record: Record | None, steps: Sequence[int]) -> list[str]:
    """Return what has changed since a run; nothing while it goes on."""
    return list(changes_since(run, record, steps)) if record is not None else []


class _Pages:
    def __init__(self, runs: OpenRuns) -> None:
        self._runs = runs
        self._computing = Computing(text_of)

    def report(self, request: Request) -> Response:
        """Show the report of runs, or their graphs while it is not there."""
        runs = self._named(request.query_params.getlist("run"))
        if not runs:
            return self.runs(request)
        conditions = {run: run.condition() for run in runs}
        states = {condition.state for condition in conditions.values()}
        if states == {RunState.FINISHED}:
            return self._report(runs)
        if states <= {RunState.FINISHED, RunState.UNREADABLE} and len(runs) == 1:
            (condition,) = conditions.values()
            return page_response(
                "message.html",
                HTTPStatus.CONFLICT,
                title=runs[0].name,
                message=condition.message,
                command=condition.command,
            )
        return self._graphs(conditions)

    def runs(self, request: Request) -> Response:
        """List the runs, to be seen side by side."""
        rows = [entry_of(run) for run in self._runs.all().values()]
        return page_response("runs.html", title="Runs", rows=rows, first=self._runs.first)

    def values(self, request: Request) -> Response:
        """Show the graph of a run with the states of its steps, or the combinations of a node."""
        run, query = self._run(request), _query(request)
        if "node" not in query:
            return self._graphs({run: run.condition()})
        condition, node = run.condition(), query["node"]
        nodes = run.snapshot(condition.state)["nodes"]
        if node not in nodes:
            raise NotThere(f"no node {node!r}; {nearest(node, nodes)}")
        combinations = Combinations(run.name, run.states(), query)
        return page_response(
            "combinations.html",
            title=node,
            run=run,
            condition=condition,
            combinations=combinations,
            query=query,
            state=nodes[node],
            described=run.described(node),
            left_out=run.left_out(node),
            most=_MOST_COMBINATIONS,
        )

    def value(self, request: Request) -> Response:
        """Show a value of a run."""
        run = self._run(request)
        query = _query(request)
        context: dict[str, Any] = {"run": run, "title": query.get("node", ""), "query": query}
        context["labels"] = labels_of(labels_in(query))
        scripts = [*(source(f"{name}.js") for name in SCRIPTS), _server([run])]
        values, record = self._values(run, query)
        try:
            value = shown(values, query)
        except NotStored as error:
            missing = NotComputed(error, values, record).data
            scripts.append(own_source("missing.js"))
            return page_response("missing.html", missing=missing, **context, scripts=scripts)
        return page_response(
            "value.html",
            **context,
            value=value,
            graph=values.plan.graph,
            address=request.url.query,
            scripts=[*scripts, *value.rendered.scripts],
            styles=value.rendered.styles,
            trusted=[value.rendered.html, value.rendered.lead],
        )

    def download(self, request: Request) -> Response:
        """Return a value of a run as a file."""
        run, query = self._run(request), _query(request)
        exporters = shown(self._values(run, query)[0], query).exporters
        suffix = query.get("suffix", "")
        if suffix not in exporters:
            raise NotThere(f"no format {suffix!r}; {nearest(suffix, exporters)}")
        content = next(iter(exporters[suffix]().values()))
        return _attachment(content, f"{query.get('node', 'value')}{suffix}")

    def file(self, request: Request) -> Response:
        """Return a file that a report links."""
        number, name = request.path_params["number"], request.path_params["name"]
        run = next((each for each in self._runs.all().values() if each.number == number), None)
        path = run.files().get(name) if run is not None else None
        if path is None or not path.is_file():
            raise NotThere("no such file; the report lists those that it has")
        return _attachment(path.read_bytes(), path.name)

    def detail(self, request: Request) -> object:
        """Return the data of the view of a block."""
        run, query = self._run(request), _query(request)
        values, record = self._values(run, query)
        try:
            return packed(values, query)
        except NotStored as error:
            raise NotComputed(error, values, record) from error

    def flow(self, request: Request) -> object:
        """Return what flows on a link of the graph."""
        query = _query(request)
        return flow(self._run(request).values()[0], query.get("link", ""))

    async def progress(self, request: Request) -> Response:
        """Send how far runs are, until all of them have ended."""
        try:
            runs = await run_in_threadpool(self._named, request.query_params.getlist("run"))
        except NodegraphError as error:
            return refused(error)
        return events_response(
            lambda: {run.name: run.snapshot() for run in runs},
            lambda data: all(each["state"].is_final for each in data.values()),
        )

    async def compute(self, request: Request) -> Response:
        """Compute what a GET request lacked; send how far it is, a line of JSON at a time."""
        try:
            wanted, query = _wanted(await request.body())
            run = await run_in_threadpool(self._run_of, query)
            values, record = await run_in_threadpool(self._values, run, query)
            steps = await run_in_threadpool(_missing, wanted, values, record, query)
        except Exception as error:
            return refused(error)
        lines = (f"{json.dumps(line)}\n" async for line in self._computing.lines(values, steps))
        return StreamingResponse(lines, media_type="application/x-ndjson")

    def _graphs(self, conditions: Mapping[OpenRun, Condition]) -> Response:
        """Show the graphs of runs with the states of their steps, which change as runs go on."""
        parts = [
            {
                "run": run,
                "condition": condition,
                "title": run.title,
                "snapshot": json.dumps(run.snapshot(condition.state)),  # in order
                **run.drawing(),
            }
            for run, condition in conditions.items()
        ]
        going = [run.name for run, each in conditions.items() if not each.state.is_final]
        scripts = [source(f"{name}.js") for name in SCRIPTS]
        scripts.append(own_source("states.js"))
        scripts.append(own_source("progress.js").replace("__RUNS__", json_in_script(going)))
        drawings = [str(part["drawing"]) for part in parts]
        title = " | ".join(dict.fromkeys(str(part["title"]) for part in parts))
        return page_response(
            "graphs.html", title=title, parts=parts, scripts=scripts, trusted=drawings
        )

    def _report(self, runs: Sequence[OpenRun]) -> Response:
        studies = {run.name: linked(run.study(), f"files/{run.number}") for run in runs}
        study = merged(studies) if len(studies) > 1 else next(iter(studies.values()))
        return html_response(page(study, server=_server(runs)))

    def _named(self, names: Sequence[str]) -> list[OpenRun]:
        """Return the runs that are named, by default those that the command named."""
        runs = self._runs.all()
        for name in names:
            if name not in runs:
                raise NotThere(f"no run {name!r}; {nearest(name, runs)}")
        return [runs[name] for name in dict.fromkeys(names or self._runs.first)]

    def _run(self, request: Request) -> OpenRun:
        return self._run_of(_query(request))

    def _run_of(self, query: Query) -> OpenRun:
        runs = self._named([query["run"]] if "run" in query else [])
        if not runs:
            raise NotThere("name a run")
        return runs[0]

    def _values(self, run: OpenRun, query: Query) -> tuple[Run, Record | None]:
        values, record = run.values()
        return values.now if query.get("now") else values, record


def _query(request: Request) -> dict[str, str]:
    return dict(request.query_params)


_WANTED: Mapping[str, Callable[[Run, Query], object]] = {"value": shown, "detail": packed}


def _wanted(body: bytes) -> tuple[str, dict[str, str]]:
    """Return the kind of values to compute, and the query that requested them."""
    try:
        data = json.loads(body)
        wanted, query = data["for"], data["query"]
        texts = {str(name): str(text) for name, text in query.items()}
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise NodegraphError(f"not understood: {error!r}") from error
    if wanted not in _WANTED:
        raise NodegraphError(f"nothing is computed for {wanted!r}; {nearest(wanted, _WANTED)}")
    return wanted, texts


def _missing(wanted: str, run: Run, record: Record | None, query: Query) -> Sequence[int]:
    """Return the steps that have to be computed.

    Raises
    ------
    NodegraphError
        If they cannot be computed as they were in the run.
    """
    try:
        _WANTED[wanted](run, query)
    except NotStored as error:
        changes = _changes(run, record, error.steps)
        if changes:
            raise NodegraphError(
                f"changed since the run: {listed(changes, _MOST_CHANGES)}"
            ) from error
        return error.steps
    return ()


def _attachment(content: bytes, name: str) -> Response:
    """Return a file that the browser saves and does not show: it may be anything."""
    headers = {"Content-Disposition": f"attachment; filename*=utf-8''{quote(name)}"}
    return Response(content, media_type="application/octet-stream", headers=headers)


def _server(runs: Sequence[OpenRun]) -> str:
    """Return the script that defines the module ``server``."""
    return own_source("server.js").replace("__RUNS__", json_in_script([run.name for run in runs]))
