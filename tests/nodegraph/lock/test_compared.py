"""Each result is graded by what a lock holds of it, and put down to where it begins."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from nodegraph.execute import Run
from nodegraph.lock.compare import Compared, compare, first_of_each
from nodegraph.lock.lockfile import Lock, lock_text, read_lock
from nodegraph.lock.results import Recorded, Results

Frozen = tuple[Run, Lock]


def compared(frozen: Frozen, **changes: Recorded) -> Compared:
    """Compare a run with its lock, in which results at the length 3 are others."""
    run, lock = frozen
    results = {group: dict(steps) for group, steps in lock.results.items()}
    for name, one in changes.items():
        group = name.replace("__", "=")
        results[group]["3" if "3" in results[group] else "only"] = one
    return compare(replace(lock, results=results), run, Results(run))


def off(frozen: Frozen, group: str, by: float, at: str = "3", **more: Any) -> Recorded:
    """Return what a lock would hold of a result that is off by so many times its usual size."""
    was = frozen[1].results[group][at]
    assert was.projections is not None
    return replace(was, digest="0" * 10, projections=was.projections + by, **more)


def test_a_run_is_identical_to_its_own_lock(frozen: Frozen) -> None:
    found = compared(frozen)
    assert (found.identical, found.count, found.beyond) == (7, 7, 0)


@pytest.mark.parametrize(("by", "near"), [(1e-11, 1), (1e-7, 0)])
def test_the_tolerance_parts_what_is_near_from_what_moved(
    frozen: Frozen, by: float, near: int
) -> None:
    found = compared(frozen, cut=off(frozen, "cut", by))
    assert (found.identical, found.near, found.beyond) == (6, near, 1 - near)
    apart = found.farthest[1] if found.farthest else found.origins[0].grade.apart
    assert 0.5 * by < apart < by  # of two outputs, which count together


def test_what_must_be_equal_is_not_measured(frozen: Frozen) -> None:
    [moved] = compared(frozen, cut=off(frozen, "cut", 0.0, exact="0" * 8)).origins
    assert moved.grade.said.startswith("types, shapes, texts")


def test_what_follows_from_a_difference_is_counted(frozen: Frozen) -> None:
    found = compared(frozen, cut=off(frozen, "cut", 1.0), fill__hold=off(frozen, "fill=hold", 1.0))
    assert [one.cell.name for one in found.origins] == ["cut(length=3)"]
    assert found.followers == {"fill": 1}


def test_several_that_changed_in_the_same_way_are_told_together(frozen: Frozen) -> None:
    run, lock = frozen
    every = {at: off(frozen, "cut", 1.0, at) for at in lock.results["cut"]}
    lock = replace(lock, results={**lock.results, "cut": every})
    [together] = first_of_each(compare(lock, run, Results(run)).origins)
    assert [one.cell.at for one in together] == ["3", "7"]


def test_what_only_one_of_them_has_is_named(frozen: Frozen) -> None:
    run, lock = frozen
    results = {**lock.results, "cut": {"3": lock.results["cut"]["3"], "9": Recorded()}}
    found = compare(replace(lock, results=results), run, Results(run))
    assert found.only_locked == ["cut at 9"]
    assert found.only_now == ["cut(length=7)"]


def test_what_ended_without_a_result_is_compared_but_for_its_measured_numbers(
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
    found = compare(lock, run, Results(run))
    assert found.identical == 4
    assert found.ended == {"failed": 1, "refused": 1, "skipped": 1}
    other = run_of(text.replace("4.5", "4.25"), store=tmp_path / "store")
    assert compare(lock, other, Results(other)).ended == found.ended


def test_a_result_where_there_was_none_has_moved(frozen: Frozen) -> None:
    [moved] = compared(frozen, cut=Recorded("refused: too small")).origins
    assert moved.grade.said == "was refused: too small, now done"
