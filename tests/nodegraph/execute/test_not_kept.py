"""What could not be stored is told with its count, and nothing where all was."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from nodegraph.execute import Run

TEXT = "nodes: {a: {use: read.number}, b: {use: fill.hold, in: a}}"


def test_each_reason_has_a_line(run_of: Callable[..., Run], tmp_path: Path) -> None:
    first = run_of(TEXT, store=tmp_path)
    assert first.cache is not None
    assert first.not_stored() == []
    first.cache.distrust(first.plan.steps[0], "a second call")
    later = run_of(TEXT, store=tmp_path)
    assert later.not_stored() == [
        "1 results are not stored: read.number: an audit found that it gives another answer in a "
        "second call",
        "1 results are not stored: they are made of results that are not stored",
    ]
    assert later.cache is not None
    assert [later.cache.distrusted(one) for one in later.plan.steps] == [
        "an audit found that it gives another answer in a second call",
        "",
    ]


def test_a_run_without_a_store_has_nothing_to_tell(run_of: Callable[..., Run]) -> None:
    assert run_of(TEXT).not_stored() == []
