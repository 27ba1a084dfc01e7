"""Short ways to build and run graphs of toy nodes."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest

from nodegraph import GraphError
from nodegraph.api import reported
from nodegraph.errors import Problem
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.results import Run
from nodegraph.execute.resume import open_store
from nodegraph.execute.run import execute
from nodegraph.graph import Choices, Graph, build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry
from tests.nodegraph.toys import CALLS, TOYS

FILE = "toy.yaml"
MARK = "@@"

ProblemsOf = Callable[..., list[Problem]]


@pytest.fixture
def calls() -> list[str]:
    """Names of the toy nodes that have been called, in order."""
    CALLS.clear()
    return CALLS


@pytest.fixture
def toys() -> Registry:
    """The registry of the toy nodes."""
    return Registry.of(TOYS, plugin="toys")


@pytest.fixture
def graph_of(tmp_path: Path) -> Callable[..., Graph]:
    """Build a graph of toy nodes from the text below its first line, ``nodegraph: 1``."""

    def build_it(
        text: str,
        *,
        more: Iterable[Callable[..., object]] = (),
        plugins: Iterable[Plugin] = (),
        **choices: Any,
    ) -> Graph:
        registry = Registry.of((*TOYS, *more), plugin="toys")
        registry.loaded.extend(plugins)
        spec = read_graph_text(f"nodegraph: 1\n{textwrap.dedent(text)}", FILE, tmp_path)
        return build(spec, registry, Choices(**choices, folder=tmp_path))

    return build_it


@pytest.fixture
def run_of(graph_of: Callable[..., Graph]) -> Callable[..., Run]:
    """Run a graph of toy nodes; ``how`` and ``listeners`` go to `execute`.

    With ``store``, a folder, results are stored there; a warning of the store fails the test,
    unless ``say`` takes it.
    """

    def run_it(
        text: str,
        *,
        how: HowToRun | None = None,
        listeners: Iterable[Any] = (),
        store: Path | None = None,
        say: Callable[[str], None] = pytest.fail,
        **more: object,
    ) -> Run:
        graph = graph_of(text, **more)
        return execute(
            plan(graph),
            how=how or HowToRun("serial"),
            store=open_store(graph.registry, store, say) if store else None,
            keep=reported(graph),
            listeners=listeners,
        )

    return run_it


@pytest.fixture
def problems_of(graph_of: Callable[..., Graph]) -> ProblemsOf:
    """Return the mistakes of a graph, which must be those at the marks ``@@`` and no others."""

    def collect(text: str, **more: object) -> list[Problem]:
        marked = textwrap.dedent(text)
        with pytest.raises(GraphError) as caught:
            graph_of(marked.replace(MARK, ""), **more)
        problems = list(caught.value.problems)
        assert [str(problem.place) for problem in problems] == places(marked), str(caught.value)
        return problems

    return collect


def places(marked: str) -> list[str]:
    """Return where the marks stand, in a file that has one line before the text."""
    marks = []
    for number, line in enumerate(marked.splitlines(), 2):
        parts = line.split(MARK)
        column = 1
        for part in parts[:-1]:
            column += len(part)
            marks.append(f"{FILE}:{number}:{column}")
    return marks
