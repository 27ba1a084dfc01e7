"""The remaining time is near the truth though steps take very different times."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from nodegraph.execute.remaining_time import RemainingTime
from nodegraph.execute.results import Run
from nodegraph.plan import Step

TEXT = """
    axes: {start: {range: [0, 99, 1]}}
    nodes:
      a: {use: read.number, with: {start: $start}}
      b: {use: fill.hold, in: a}
      c: {use: strict.positive, in: b}
    """
TIMES = {"read.number": 0.0, "fill.hold": 1.0, "strict.positive": 40.0}


@pytest.fixture
def steps(run_of: Callable[..., Run]) -> tuple[Step, ...]:
    return run_of(TEXT).plan.steps


def took(step: Step) -> float:
    return TIMES[step.method.node.name]


@pytest.mark.parametrize("at_once", [1, 2])
def test_after_a_tenth_it_is_right_within_a_tenth(steps: tuple[Step, ...], at_once: int) -> None:
    remaining = RemainingTime(steps, {})
    done = steps[: len(steps) // 10]
    for step in done:
        remaining.add(step, took(step))
    elapsed = sum(map(took, done)) / at_once
    truth = sum(map(took, steps[len(done) :])) / at_once
    assert remaining.estimate(elapsed) == pytest.approx(truth, rel=0.1)


def test_the_last_step_runs_alone(steps: tuple[Step, ...]) -> None:
    remaining = RemainingTime(steps, {})
    for step in steps[:-1]:
        remaining.add(step, took(step))
    assert remaining.estimate(sum(map(took, steps[:-1])) / 2) == pytest.approx(took(steps[-1]))


def test_a_method_that_has_not_run_takes_what_it_took_before(steps: tuple[Step, ...]) -> None:
    cheap = [step for step in steps if step.node != "c"]
    for earlier, seconds in [
        ({"strict.positive": 40.0}, pytest.approx(4000.0, rel=0.1)),
        ({}, None),
    ]:
        remaining = RemainingTime(steps, earlier)
        for step in cheap:
            remaining.add(step, took(step))
        assert remaining.estimate(sum(map(took, cheap))) == seconds


def test_a_method_that_has_not_run_takes_as_long_as_the_longest_first_call_of_others(
    steps: tuple[Step, ...],
) -> None:
    last = steps[-1]
    others = [step for step in steps if step.node != last.node]
    remaining = RemainingTime([*others, last], {})
    done = others[:-20]
    for step in done:
        remaining.add(step, 200.0 if step.index == 1 else took(step))
    elapsed = 200.0 + sum(map(took, done[2:]))
    assert remaining.estimate(elapsed) is None  # what is known to be left takes 10 s
    remaining.add(last, None)
    assert remaining.estimate(elapsed) == pytest.approx(10.0, rel=0.1)


def test_first_calls_that_compile_do_not_count_for_those_after(steps: tuple[Step, ...]) -> None:
    remaining = RemainingTime(steps, {})
    done = steps[: len(steps) // 10]
    for step in done:
        # the second one has waited for the first
        remaining.add(step, 2000.0 if step.index < 6 else took(step))
    elapsed = 2000.0 * 6 + sum(took(step) for step in done[6:])
    truth = sum(map(took, steps[len(done) :]))
    assert remaining.estimate(elapsed) == pytest.approx(truth, rel=0.1)


def test_nothing_is_known_before_a_step_has_ended_and_methods_were_called_often(
    steps: tuple[Step, ...],
) -> None:
    assert RemainingTime(steps, {"strict.positive": 1.0}).estimate(3.0) is None
    remaining = RemainingTime([step for step in steps if step.node == "a"], {})
    for count in range(1, 6):
        remaining.add(steps[3 * count], 1.0)
        assert remaining.estimate(count) == (None if count < 5 else pytest.approx(95.0))


def test_the_last_seconds_are_not_said(steps: tuple[Step, ...]) -> None:
    remaining = RemainingTime([step for step in steps if step.node == "a"], {})
    for count in range(1, 96):
        remaining.add(steps[3 * count], 1.0)
        assert remaining.estimate(count) is not None or count < 5
    remaining.add(steps[0], 1.0)
    assert remaining.estimate(96.0) is None


def test_steps_that_are_skipped_take_no_time(steps: tuple[Step, ...]) -> None:
    remaining = RemainingTime(steps, {})
    for step in steps:
        if step.node == "a":
            remaining.add(step, 1.0)
        else:
            remaining.add(step, None)
    assert remaining.estimate(1.0) is None


def test_a_method_takes_as_long_wherever_it_stands(run_of: Callable[..., Run]) -> None:
    again = "      d: {use: strict.positive, in: c}\n"
    steps = run_of(TEXT.rstrip(" ") + again).plan.steps
    remaining = RemainingTime(steps, {})
    for step in steps:
        if step.node != "d":
            remaining.add(step, took(step))
    assert remaining.estimate(4100.0) == pytest.approx(4000.0, rel=0.1)
