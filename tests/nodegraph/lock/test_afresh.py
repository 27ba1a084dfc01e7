"""A run that uses no stored result knows what audits found all the same."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from nodegraph.execute import Run
from nodegraph.execute.step_cache import Recall
from nodegraph.lock.restore import Afresh

TEXT = "nodes: {a: {use: read.number}, b: {use: fill.hold, in: a}}"


def test_it_has_no_result_and_knows_every_doubt(run_of: Callable[..., Run], tmp_path: Path) -> None:
    run = run_of(TEXT, store=tmp_path / "store")
    assert run.recall is not None
    again = Recall(run.plan, Afresh(tmp_path / "afresh", run.recall.store, pytest.fail))
    assert again.look_up() == {}
    run.recall.doubt(run.plan.steps[0], "a second call")
    later = Recall(run.plan, Afresh(tmp_path / "later", run.recall.store, pytest.fail))
    assert "in a second call" in later.doubted(run.plan.steps[0])
