"""What could not be stored is told with its count, and nothing where all was."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from nodegraph.execute import Run
from nodegraph.execute.results import not_kept_lines

TEXT = "nodes: {a: {use: read.number}, b: {use: fill.hold, in: a}}"


def test_each_reason_has_a_line(run_of: Callable[..., Run], tmp_path: Path) -> None:
    first = run_of(TEXT, store=tmp_path)
    assert first.recall is not None
    assert not_kept_lines(first) == []
    first.recall.doubt(first.plan.steps[0], "a second call")
    later = run_of(TEXT, store=tmp_path)
    assert not_kept_lines(later) == [
        "1 results are not stored: read.number: an audit found that it gives another answer in a "
        "second call",
        "1 results are not stored: they are made of results that are not stored",
    ]
    assert later.recall is not None
    assert [later.recall.doubted(one) for one in later.plan.steps] == [
        "an audit found that it gives another answer in a second call",
        "",
    ]


def test_a_run_without_a_store_has_nothing_to_tell(run_of: Callable[..., Run]) -> None:
    assert not_kept_lines(run_of(TEXT)) == []
