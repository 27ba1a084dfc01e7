"""Graph files beside the graph under test."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path

import pytest

from nodegraph import GraphError
from nodegraph.graph import Graph

MARK = "@@"

MessagesOf = Callable[..., list[str]]


@pytest.fixture
def files(tmp_path: Path) -> Callable[..., None]:
    """Write graph files beside the outer graph, without their first line: ``files(clean="...")``.

    A name with ``__`` in it lies in a folder.
    """

    def write(**texts: str) -> None:
        for name, text in texts.items():
            path = tmp_path / f"{name.replace('__', '/')}.yaml"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(f"nodegraph: 1\n{textwrap.dedent(text)}")

    return write


@pytest.fixture
def messages_of(files: Callable[..., None], graph_of: Callable[..., Graph]) -> MessagesOf:
    """Return the error messages of a graph with graph files beside it.

    They must be those at the marks ``@@`` in any of the texts, and no others.
    """

    def collect(
        outer: str, *, more: tuple[Callable[..., object], ...] = (), **texts: str
    ) -> list[str]:
        files(**{name: text.replace(MARK, "") for name, text in texts.items()})
        with pytest.raises(GraphError) as caught:
            graph_of(textwrap.dedent(outer).replace(MARK, ""), more=more)
        named = {"toy": outer, **{name.replace("__", "/"): text for name, text in texts.items()}}
        marked = [mark for name, text in named.items() for mark in _marks(f"{name}.yaml", text)]
        problems = caught.value.problems
        assert sorted(str(problem.place) for problem in problems) == sorted(marked), str(
            caught.value
        )
        return [f"{problem.message} | {problem.instead}" for problem in problems]

    return collect


def _marks(file: str, text: str) -> list[str]:
    """Return where the marks stand, in a file that has one line before the text."""
    return [
        f"{file}:{number}:{len(MARK.join(parts[: index + 1])) - index * len(MARK) + 1}"
        for number, line in enumerate(textwrap.dedent(text).splitlines(), 2)
        for parts in [line.split(MARK)]
        for index in range(len(parts) - 1)
    ]
