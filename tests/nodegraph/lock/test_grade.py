"""Results of a run judged by those in a lock, and the grade."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from nodegraph.execute.results import Run
from nodegraph.lock.grade import BySketch, changes_everywhere, outcome_of
from nodegraph.lock.portable import FileNames, portable
from nodegraph.lock.results import Results
from nodegraph.runs.compare import Agreement, Agreements, Judged, Pair, StepChange, compare
from nodegraph.runs.record import Cell, Record, RecordedStep
from nodegraph.state import State
from tests.nodegraph.lock.conftest import Frozen

OTHER_DIGEST = "0" * 10


def now_of(run: Run) -> Record:
    return portable(run, FileNames(run.plan.graph), Results(run))


def compared(frozen: Frozen, *steps: RecordedStep) -> Agreements:
    """Compare a run with its lock after changes of steps in the lock."""
    run, lock, _ = frozen
    other = {step.step: step for step in steps}
    was = replace(lock.record, steps=[other.get(step.step, step) for step in lock.record.steps])
    return compare(was, now_of(run), BySketch(lock, Results(run)))


def step_of(frozen: Frozen, node: str, **labels: object) -> RecordedStep:
    return next(
        step
        for step in frozen.lock.record.steps
        if step.node == node and labels.items() <= step.labels.items()
    )


def off(frozen: Frozen, node: str, by: float, **labels: Any) -> RecordedStep:
    """Return a step of the lock with floats that differ by so many times their usual size."""
    step = step_of(frozen, node, **labels)
    results = Results(frozen.run)
    sketch = results.sketch(step.step)
    assert sketch is not None
    leaves = {
        place: replace(leaf, projections=leaf.projections * (1.0 + by))
        for place, leaf in sketch.leaves.items()
    }
    text = replace(sketch, leaves=leaves).text(frozen.lock.sizes[step.cells[0].group])
    return replace(step, sketch=text, digests=[OTHER_DIGEST] * len(step.digests))


def test_a_run_is_identical_to_its_own_lock(frozen: Frozen) -> None:
    result = compared(frozen)
    assert (result.same, result.compared, result.beyond, result.harmless) == (7, 7, 0, Counter())
    assert list(changes_everywhere(frozen.lock.record, now_of(frozen.run))) == []


@pytest.mark.parametrize(("by", "near"), [(1e-11, 1), (1e-7, 0)])
def test_differences_within_the_tolerance_are_near(frozen: Frozen, by: float, near: int) -> None:
    result = compared(frozen, off(frozen, "cut", by, length=3))
    assert (result.same, len(result.near), result.beyond) == (6, near, 1 - near)
    _, judged = (result.near or result.origins)[0]
    assert 0.1 * by < judged.distance < 4 * by


def test_a_difference_of_anything_but_floats_is_reported(frozen: Frozen) -> None:
    step = off(frozen, "cut", 0.0, length=3)
    result = compared(frozen, replace(step, sketch=OTHER_DIGEST[:8] + step.sketch[8:]))
    [(_, judged)] = result.origins
    assert "shapes" in judged.text


def test_differences_that_follow_are_counted(frozen: Frozen) -> None:
    cut, hold = off(frozen, "cut", 1.0, length=3), off(frozen, "fill", 1.0, length=3, fill="hold")
    result = compared(frozen, cut, hold)
    assert [pair.cell.name for pair, _ in result.origins] == ["cut(length=3)"]
    assert result.followers == {"fill": 1}


def test_combinations_with_the_same_change_are_grouped(frozen: Frozen) -> None:
    result = compared(frozen, *(off(frozen, "cut", 1.0, length=length) for length in (3, 7)))
    [group] = result.by_change()
    assert [pair.cell.name for pair, _ in group] == ["cut(length=3)", "cut(length=7)"]


def test_states_and_reasons_are_compared_without_decimal_numbers(
    freeze: Callable[[str], Frozen], run_of: Callable[..., Run], tmp_path: Path
) -> None:
    text = """
    inputs: {start: -4.5}
    nodes:
      a: {use: read.number, with: {start: $start}}
      strict: {in: a, alternatives: strict.*}
      all: {use: plot.faces, in: strict}
    """
    frozen = freeze(text)
    result = compared(frozen)
    assert result.same == 4
    assert result.endings == {"failed": 1, "refused": 1, "skipped": 1}
    other = run_of(text.replace("4.5", "4.25"), store=tmp_path / "store")
    assert compared(frozen._replace(run=other)).endings == result.endings


def test_a_result_in_place_of_a_refusal_is_another(frozen: Frozen) -> None:
    step = replace(step_of(frozen, "cut", length=3), state=State.REFUSED, reason="too small")
    [(_, judged)] = compared(frozen, step).origins
    assert judged.text == "was refused: too small, now done"


def pair_with(change: StepChange) -> tuple[Pair, Judged]:
    step = RecordedStep(0, "fill", "fill.hold", {}, {}, {}, State.DONE, 0.0)
    pair = Pair(Cell("fill", {}), step, step, ())  # type: ignore[arg-type]  # records are not read
    vars(pair)["change"] = change
    return pair, Judged(Agreement.OTHER, 1e-6)


EDITED = pair_with(StepChange(own=("code: a was edited",)))
DRIFTED = pair_with(StepChange(around=("numpy was 1, now 2",)))


@pytest.mark.parametrize(
    ("result", "conclusions", "changed", "expected"),
    [
        (Agreements(), True, [], "identical"),
        (Agreements(), True, ["a tie"], "identical, but conclusions changed"),
        (Agreements(near=[DRIFTED]), True, [], "within tolerance"),
        (Agreements(near=[DRIFTED]), False, [], "within tolerance"),
        (Agreements(near=[DRIFTED]), True, ["a tie"], "within tolerance, but conclusions changed"),
        (Agreements(origins=[DRIFTED]), True, [], "same conclusions"),
        (Agreements(origins=[DRIFTED]), True, ["b < a"], "diverged"),
        (Agreements(origins=[DRIFTED]), False, [], "diverged"),
        (Agreements(origins=[EDITED]), True, [], "diverged"),
        (Agreements(origins=[DRIFTED, EDITED]), True, [], "diverged"),
        (Agreements(only_now=[Cell("fill", {})]), True, [], "diverged"),
        (Agreements(only_was=[Cell("fill", {})]), True, [], "diverged"),
    ],
)
def test_the_grade(
    result: Agreements, conclusions: bool, changed: list[str], expected: str
) -> None:
    result.counts[Agreement.OTHER] = len(result.origins)
    outcome = outcome_of(result, conclusions, changed)
    assert outcome.text == expected
    assert outcome.holds == (expected in ("identical", "within tolerance", "same conclusions"))
