"""A run that uses no stored result knows what audits found all the same."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from nodegraph.execute import Run
from nodegraph.execute.step_cache import StepCache
from nodegraph.lock.restore import Afresh

TEXT = "nodes: {a: {use: read.number}, b: {use: fill.hold, in: a}}"


def test_it_has_no_result_and_knows_every_doubt(run_of: Callable[..., Run], tmp_path: Path) -> None:
    run = run_of(TEXT, store=tmp_path / "store")
    assert run.cache is not None
    again = StepCache(run.plan, Afresh(tmp_path / "afresh", run.cache.store, pytest.fail))
    assert again.known == {}
    run.cache.distrust(run.plan.steps[0], "a second call")
    later = StepCache(run.plan, Afresh(tmp_path / "later", run.cache.store, pytest.fail))
    assert "in a second call" in later.distrusted(run.plan.steps[0])
