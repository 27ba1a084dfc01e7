"""The order of steps, and steps that have moved to their place in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from nodegraph.plan.steps import Output, Step, StepInput


def lean_order(steps: list[Step]) -> list[int]:
    """Return the steps depth first from the last ones, so that few values wait at a time."""
    read = {needed for step in steps for needed in step.needed}
    order: list[int] = []
    done: set[int] = set()
    for last in (step for step in steps if step.index not in read):
        pending = [(last, iter(last.needed))]
        done.add(last.index)
        while pending:
            step, needs = pending[-1]
            following = next((one for one in needs if one not in done), None)
            if following is None:
                order.append(step.index)
                pending.pop()
            else:
                done.add(following)
                pending.append((steps[following], iter(steps[following].needed)))
    return order


def needed_by(inputs: Mapping[str, StepInput]) -> tuple[int, ...]:
    """Return the steps that feed the ports of another, each once."""
    found: dict[int, None] = {}
    for fed in inputs.values():
        if isinstance(fed, Output):
            found[fed.step] = None
        else:
            found.update((output.step, None) for _, output in fed.entries)
    return tuple(found)


def moved_step(step: Step, moved: Mapping[int, int]) -> Step:
    """Return a step, and what it says of others, with the indices that they have now."""
    inputs = {port: _moved_input(fed, moved) for port, fed in step.inputs.items()}
    return Step(
        moved[step.index],
        step.node,
        step.method,
        step.labels,
        step.settings,
        step.shown,
        inputs,
        tuple([moved[one] for one in step.needed]),
    )


def _moved_input(fed: StepInput, moved: Mapping[int, int]) -> StepInput:
    if isinstance(fed, Output):
        return Output(moved[fed.step], fed.position)
    entries = tuple((at, Output(moved[one.step], one.position)) for at, one in fed.entries)
    return replace(fed, entries=entries)
