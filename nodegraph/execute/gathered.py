"""What a gathering port takes: the values that there are, and what became of the others."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from nodegraph.execute.call import Outcome
from nodegraph.plan import Gathered, Output, absent_of
from nodegraph.ports import Absent, Across


def gathered(
    fed: Gathered, outcomes: Mapping[int, Outcome], value_of: Callable[[Output], Any]
) -> Across[Any]:
    """Return the values of a gathering port with their labels.

    Parameters
    ----------
    fed
        What the plan gathers.
    outcomes
        How the steps ended that feed it, all of them.
    value_of
        Returns the value of one output of a step that is done.
    """
    entries = []
    absent = list(absent_of(fed))
    for at, output in fed.entries:
        labels = dict(zip(fed.axes, at, strict=True))
        outcome = outcomes[output.step]
        if outcome.state == "done":
            entries.append((labels, value_of(output)))
        else:
            absent.append(Absent(labels, outcome.cause, outcome.reason))
    known = dict(zip(fed.axes, fed.known, strict=True))
    return Across(fed.axes, tuple(entries), tuple(absent), known)
