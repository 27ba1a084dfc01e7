"""Which steps cannot run, because what they need has no value."""

from __future__ import annotations

from collections.abc import Mapping

from nodegraph.execute.call import Outcome
from nodegraph.plan import Gathered, Plan, Step


def skipped(plan: Plan, step: Step, outcomes: Mapping[int, Outcome]) -> Outcome | None:
    """Return why a step cannot run, if one that it needs has no value.

    Parameters
    ----------
    plan
    step
    outcomes
        How steps before it ended, as far as that is known. While the reason could still be
        another one there is none, so that it never depends on what was known when.
    """
    for fed in step.inputs.values():
        needed = _undone(fed, outcomes) if isinstance(fed, Gathered) else fed.step
        if needed is None:
            continue
        outcome = outcomes.get(needed)
        if outcome is None:
            return None
        if outcome.state != "done":
            return _because(plan.steps[needed], outcome)
    return None


def _undone(fed: Gathered, outcomes: Mapping[int, Outcome]) -> int | None:
    """Return a step of those gathered, or None if any of them is known to be done."""
    known = [outcomes.get(one.step) for _, one in fed.entries]
    if any(outcome is not None and outcome.state == "done" for outcome in known):
        return None
    return fed.entries[known.index(None) if None in known else 0][1].step


def _because(needed: Step, cause: Outcome) -> Outcome:
    said = (
        cause.reason if cause.state == "skipped" else f"{needed.name} {cause.state}: {cause.reason}"
    )
    return Outcome("skipped", reason=said, cause=cause.cause)
