"""A toy plugin over plain numbers, and short ways to build and run graphs of its nodes."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import pytest
from pydantic import Field

from nodegraph import Across, GraphError, InputFile, Refusal, Truth, Unit, Value, node
from nodegraph.api import reported
from nodegraph.errors import Problem
from nodegraph.execute import HowToRun, Run, execute, open_store
from nodegraph.graph import Choices, Graph, build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry

FILE = "toy.yaml"
MARK = "@@"
CALLS: list[str] = []

ProblemsOf = Callable[..., list[Problem]]


class Cut(NamedTuple):
    gappy: float
    truth: Truth[float]
    hidden: int


@dataclass(frozen=True)
class Seen(Value):
    """What reached a gathering node, to be looked at."""

    scores: Across[float]
    truth: float | None = None


@node("read.number")
def read_number(*, start: float = 1.0) -> float:
    CALLS.append("read.number")
    return start


@node("read.file")
def read_file(*, path: InputFile) -> float:
    return float(path.read_text())


@node("gaps.cut")
def cut(
    recording: float,
    *,
    length: Annotated[int, Field(ge=1, le=99), Unit("frames")] = 15,
    seed: int = 0,
) -> Cut:
    """Cut gaps.

    Parameters
    ----------
    length
        Length of each gap.
    seed
        Where they fall.
    """
    CALLS.append("gaps.cut")
    return Cut(recording - length + seed / 10, recording, length)


@node("fill.hold", cite="hold2001")
def hold(recording: float, *, max_gap: int | None = None) -> float:
    """Add one."""
    CALLS.append("fill.hold")
    return recording + 1.0


@node("fill.scale")
def scale(recording: float, *, max_gap: int | None = None, power: float = 2.0) -> float:
    """Multiply."""
    return recording * power


@node("strict.positive")
def positive(recording: float) -> float:
    if recording < 0:
        raise Refusal(f"{recording} is negative")
    return recording


@node("strict.fails")
def fails(recording: float) -> float:
    if recording < 0:
        raise ValueError(f"{recording} is negative")
    return recording


@node("score.gaps")
def score(estimate: float, truth: Truth[float], hidden: int) -> float:
    CALLS.append("score.gaps")
    return abs(estimate - truth) / hidden


@node("compare.table")
def table(scores: Across[float], floor: Across[float] | None = None, *, metric: str = "x") -> Seen:
    CALLS.append("compare.table")
    return Seen(scores)


@node("compare.beside")
def beside(scores: Across[float], reference: float, *, weight: float = 1.0) -> Seen:
    return Seen(scores, reference * weight)


@node("plot.faces")
def faces(recordings: Across[float], truth: Truth[float] | None = None) -> Seen:
    return Seen(recordings, truth)


@node("plot.stages")
def stages(recordings: Across[float], reference: float | None = None) -> Seen:
    return Seen(recordings, reference)


@node("text.write")
def write(*, text: str = "", number: float = 0.0) -> str:
    return text or f"{number:g}"


@node("text.join")
def join(first: str, second: str | None = None, *, mark: str = "+") -> str:
    return f"({first}{mark}{second})"


@node("text.all")
def join_all(parts: Across[str]) -> str:
    return "[" + "; ".join(f"{', '.join(map(str, at.values()))}: {v}" for at, v in parts) + "]"


TOYS = (
    read_number, read_file, cut, hold, scale, positive, fails, score, table, beside, faces, stages,
    write, join, join_all,
)  # fmt: skip


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
