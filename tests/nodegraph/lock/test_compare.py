"""Results of a run compared with a lock, and the verdict."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from nodegraph.execute import Run
from nodegraph.lock.changes import Change
from nodegraph.lock.compare import (
    Agreement,
    Compared,
    Match,
    Moved,
    compare,
    group_by_change,
    verdict,
)
from nodegraph.lock.locked_result import LockedResult
from nodegraph.lock.lockfile import Lock, lock_text, read_lock
from nodegraph.lock.results import Cell, Results

Frozen = tuple[Run, Lock]


def with_results(lock: Lock, group: str, steps: dict[str, LockedResult]) -> Lock:
    results = dict(lock.study.results)
    results[group] = results[group].model_copy(update={"steps": steps})
    return replace(lock, study=lock.study.model_copy(update={"results": results}))


def compared(frozen: Frozen, **changes: LockedResult) -> Compared:
    """Compare a run with its lock after changes of results at the length 3 in the lock."""
    run, lock = frozen
    for name, recorded in changes.items():
        group = name.replace("__", "=")
        lock = with_results(lock, group, {**lock.study.results[group].steps, "3": recorded})
    return compare(lock, run, Results(run))


def off(frozen: Frozen, group: str, by: float, at: str = "3", **more: Any) -> LockedResult:
    """Return a result of the lock, changed by so many times its usual size."""
    was = frozen[1].study.results[group].steps[at]
    assert was.projections is not None
    return replace(was, digest="0" * 10, projections=was.projections + by, **more)


def test_a_run_is_identical_to_its_own_lock(frozen: Frozen) -> None:
    result = compared(frozen)
    assert (result.identical, result.count, result.beyond) == (7, 7, 0)


@pytest.mark.parametrize(("by", "near"), [(1e-11, 1), (1e-7, 0)])
def test_differences_within_the_tolerance_are_near(frozen: Frozen, by: float, near: int) -> None:
    result = compared(frozen, cut=off(frozen, "cut", by))
    assert (result.identical, result.near, result.beyond) == (6, near, 1 - near)
    distance = result.farthest[1] if result.farthest else result.origins[0].match.distance
    assert 0.5 * by < distance < by  # of two outputs, which count together


def test_a_difference_of_anything_but_floats_is_reported(frozen: Frozen) -> None:
    [moved] = compared(frozen, cut=off(frozen, "cut", 0.0, exact="0" * 8)).origins
    assert "shapes" in moved.match.text


def test_differences_that_follow_are_counted(frozen: Frozen) -> None:
    result = compared(frozen, cut=off(frozen, "cut", 1.0), fill__hold=off(frozen, "fill=hold", 1.0))
    assert [moved.cell.name for moved in result.origins] == ["cut(length=3)"]
    assert result.followers == {"fill": 1}


def test_combinations_with_the_same_change_are_grouped(frozen: Frozen) -> None:
    run, lock = frozen
    steps = {at: off(frozen, "cut", 1.0, at) for at in lock.study.results["cut"].steps}
    result = compare(with_results(lock, "cut", steps), run, Results(run))
    [group] = group_by_change(result.origins)
    assert [moved.cell.at for moved in group] == ["3", "7"]


def test_combinations_of_only_the_lock_or_the_run_are_listed(frozen: Frozen) -> None:
    run, lock = frozen
    steps = {"3": lock.study.results["cut"].steps["3"], "9": LockedResult()}
    result = compare(with_results(lock, "cut", steps), run, Results(run))
    assert result.only_locked == ["cut at 9"]
    assert result.only_now == ["cut(length=7)"]


def test_states_and_reasons_are_compared_without_decimal_numbers(
    run_of: Callable[..., Run], tmp_path: Path
) -> None:
    text = """
    inputs: {start: -4.5}
    nodes:
      a: {use: read.number, with: {start: $start}}
      strict: {in: a, alternatives: strict.*}
      all: {use: plot.faces, in: strict}
    """
    path = tmp_path / "toy.lock"
    run = run_of(text, store=tmp_path / "store")
    path.write_text(lock_text(run, path))
    lock = read_lock(path)
    result = compare(lock, run, Results(run))
    assert result.identical == 4
    assert result.without_value == {"failed": 1, "refused": 1, "skipped": 1}
    other = run_of(text.replace("4.5", "4.25"), store=tmp_path / "store")
    assert compare(lock, other, Results(other)).without_value == result.without_value


def test_a_result_in_place_of_a_refusal_has_moved(frozen: Frozen) -> None:
    [moved] = compared(frozen, cut=LockedResult("refused: too small")).origins
    assert "refused: too small, now done" in moved.match.text


CELL = Cell("fill=hold", "only", "fill", {"fill": "hold"}, 0)
EDITED = Moved(CELL, Match(Agreement.MOVED, 0.1), Change(own=("code: a was edited",)))
DRIFTED = Moved(CELL, Match(Agreement.MOVED, 1e-6), Change(around=("numpy was 1, now 2",)))


@pytest.mark.parametrize(
    ("result", "conclusions", "changed", "expected"),
    [
        (Compared(identical=3), True, [], "identical"),
        (Compared(identical=3), True, ["a tie"], "identical, but conclusions changed"),
        (Compared(identical=3, near=1), True, [], "within tolerance"),
        (Compared(identical=3, near=1), False, [], "within tolerance"),
        (
            Compared(identical=3, near=1),
            True,
            ["a tie"],
            "within tolerance, but conclusions changed",
        ),
        (Compared([DRIFTED], identical=3), True, [], "same conclusions"),
        (Compared([DRIFTED], identical=3), True, ["b < a"], "diverged"),
        (Compared([DRIFTED], identical=3), False, [], "diverged"),
        (Compared([EDITED], identical=3), True, [], "diverged"),
        (Compared([DRIFTED, EDITED]), True, [], "diverged"),
        (Compared(identical=3, only_now=["fill"]), True, [], "diverged"),
        (Compared(identical=3, only_locked=["fill"]), True, [], "diverged"),
    ],
)
def test_the_verdict(
    result: Compared, conclusions: bool, changed: list[str], expected: str
) -> None:
    outcome = verdict(result, conclusions, changed)
    assert outcome.text == expected
    assert outcome.holds == (expected in ("identical", "within tolerance", "same conclusions"))
