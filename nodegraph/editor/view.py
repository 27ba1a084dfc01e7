"""What a page shows of a text: its mistakes, its picture, and where its nodes stand."""

from __future__ import annotations

import re
from bisect import bisect
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from nodegraph.draw import Picture, svg
from nodegraph.draw.from_graph import picture_of
from nodegraph.draw.from_spec import picture_of_spec
from nodegraph.editor.outline import Span, outline_of
from nodegraph.errors import GraphError, Place, Problem, Problems, one_line
from nodegraph.execute.preflight import check_files_and_settings
from nodegraph.execute.resume import StoredSteps, open_store
from nodegraph.formatting import number_of
from nodegraph.graph import Graph, build
from nodegraph.graphfile import GraphSpec, read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry

_MOST_BOXES = 1000
_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")


@dataclass(frozen=True, slots=True)
class View:
    """What is shown of a text.

    Attributes
    ----------
    graph : Graph or None
        None if there are mistakes.
    problems : list of mapping
        Each with its `place`, where it is in the text or None, `message`, `instead`, and whether
        it `is_error`.
    svg : str
        Empty if there is none.
    reason : str
        Why there is no picture.
    nodes : mapping of name to Span
    wrong : sequence of str
        Nodes with mistakes.
    """

    graph: Graph | None
    problems: list[Mapping[str, object]]
    svg: str
    reason: str
    nodes: Mapping[str, Span]
    wrong: Sequence[str] = ()


def view_of(text: str, path: Path, registry: Registry) -> View:
    """Return what a page shows of the text of a graph file.

    Parameters
    ----------
    text
    path
        The graph file.
    registry
    """
    places = Places(text, path.name)
    nodes = outline_of(text).nodes()
    spec = None
    try:
        spec = read_graph_text(text, path.name, path.parent)
        graph = build(spec, registry)
    except GraphError as error:
        problems = places.problems(error.problems, is_error=True)
        drawing = _drawn_spec(spec, registry) if spec else ""
        how = "drawn as far as the text can be read" if drawing else "the picture is that of before"
        reason = f"{number_of(len(problems), 'mistake')}: {how}"
        lines = {
            problem.place.line for problem in error.problems if problem.place.file == path.name
        }
        wrong = [name for name, (first, last) in nodes.items() if lines & {*range(first, last + 1)}]
        reason = reason if text.strip() else "the file is empty: add a node, or write the text"
        return View(None, problems, drawing, reason, nodes, wrong)
    except Exception as error:  # of a plugin, or of ours: the text must stay editable
        message = f"internal error; please report it: {type(error).__name__}: {error}"
        problem = Problem(Place(path.name), message)
        return View(None, places.problems([problem], is_error=True), "", message, nodes)
    drawing = _drawn(picture_of(graph, whole=True))
    reason = "" if drawing else _too_many(len(graph.nodes), path.name)
    return View(graph, places.problems(graph.notices, is_error=False), drawing, reason, nodes)


def unchecked_view_of(text: str) -> View:
    """Return what a page shows of a text whose check takes long."""
    reason = (
        "the check takes long, as of a pattern that walks through a whole disk: "
        "the picture is that of before"
    )
    return View(None, [], "", reason, outline_of(text).nodes())


def _too_many(nodes: int, name: str) -> str:
    return (
        f"{nodes:,} nodes: more than {_MOST_BOXES:,} are not drawn here. The text can be edited "
        f"and run all the same; `nodegraph draw {name} -o graph.svg` draws all into a file. "
        "Nodes that repeat are fewer as an axis or as alternatives."
    )


def _drawn(picture: Picture) -> str:
    """Return a picture as SVG; empty if it is too large for a page."""
    return svg(picture, sockets=True, heading=False) if len(picture.boxes) <= _MOST_BOXES else ""


def _drawn_spec(spec: GraphSpec, registry: Registry) -> str:
    """Return the picture of a graph with mistakes; empty if it goes in circles, or is too large."""
    try:
        return _drawn(picture_of_spec(spec, registry))
    except ValueError:
        return ""


def problems_of_files(graph: Graph, store: Path | None) -> list[Mapping[str, object]]:
    """Return what is wrong with the files that a graph reads, and with settings for their content.

    They are the checks of ``nodegraph check`` that take longer; what is stored in a folder, by
    default in that of the user, spares some of them.
    """
    places = Places(graph.spec.text, graph.spec.file)
    planned = plan(graph)
    problems = Problems()
    stored = StoredSteps(planned, open_store(graph.registry, store, lambda message: None))
    warnings = check_files_and_settings(planned, stored, problems)
    notices = [Problem(Place(graph.spec.file), warning) for warning in warnings]
    return [
        *places.problems(problems.all(), is_error=True),
        *places.problems(notices, is_error=False),
    ]


class Places:
    """Where lines and columns are in a text, in the units in which browsers count.

    Parameters
    ----------
    text
    file
        Its name in messages.
    """

    def __init__(self, text: str, file: str) -> None:
        self._file = file
        self._starts = [0, *(match.end() for match in _BREAK.finditer(text))]
        # a browser counts these twice
        self._wide = [at for at, character in enumerate(text) if character > "\uffff"]
        self._length = len(text)

    def problems(
        self, problems: Iterable[Problem], *, is_error: bool
    ) -> list[Mapping[str, object]]:
        """Return problems as data."""
        return [
            {
                "at": self.position(problem.place),
                "place": str(problem.place),
                "message": one_line(problem.message),
                "instead": one_line(problem.instead),
                "is_error": is_error,
            }
            for problem in problems
        ]

    def position(self, place: Place) -> int | None:
        """Return the position of a place in this file."""
        if place.file != self._file or not 0 < place.line <= len(self._starts):
            return None
        position = min(self._starts[place.line - 1] + place.column - 1, self._length)
        return position + bisect(self._wide, position - 1)

    def index(self, position: int) -> int:
        """Return the index in the text of a position in a browser."""
        index = position
        for wide in self._wide:
            if wide >= index:
                break
            index -= 1
        return max(0, min(index, self._length))
