"""The values of a node as one table: a row per combination, or all rows of all its tables."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

    from nodegraph.execute.values import Values
    from nodegraph.plan import Combination

_PLAIN = (bool, int, float, str)


def frame_of(values: Values) -> pd.DataFrame:
    """Return the values of a node, with a leading column for each of its axes.

    Tables are put below each other: their rows get the labels of their combination, a column
    that is named like an axis gives way to it, and the `attrs` of the first table are kept.
    Anything else stands in one column, named after the output or the node. A combination
    without a value is one row in which the value is missing; only if there is such a row, the
    columns ``state`` and ``reason`` tell for every row what became of it.

    Parameters
    ----------
    values : Values
        As ``run["error"]`` or ``run["gaps.hidden"]``.
    """
    import pandas as pd

    found = {tuple(labels.values()): value for labels, value in values}
    absent = _absent(values, found)
    order = [one for one in _combinations(values) if one in found or one in absent]
    if found and all(isinstance(one, pd.DataFrame) for one in found.values()):
        parts = [_rows(found.get(one), values.axes) for one in order]
        body = pd.concat(parts, ignore_index=True)
        body.attrs = dict(next(iter(found.values())).attrs)
        counts = [len(one) for one in parts]
    else:
        column = [found.get(one) for one in order]
        body = pd.DataFrame({_name(values): _series(column)})
        counts = [1] * len(order)
    _insert_axes(body, values.axes, order, counts)
    if absent:
        states = [absent.get(one, ("done", "")) for one in order]
        for place, name in enumerate(("state", "reason")):
            told = [state[place] for state in states]
            # a table may have such a column of its own
            free = f"{values.node}_{name}" if name in body.columns else name
            body[free] = _repeated(told, counts)
    return body


def _combinations(values: Values) -> Iterable[Combination]:
    """Return all combinations of the node's axes, in the order of their labels."""
    axes = values.run.plan.graph.axes
    return itertools.product(*(axes[axis].labels for axis in values.axes))


def _absent(values: Values, found: Mapping[Combination, Any]) -> dict[Combination, tuple[str, str]]:
    """Return the state and the reason of each combination without a value."""
    plan, outcomes = values.run.plan, values.run.outcomes
    steps = {at: outcomes[index] for at, index in plan.cells[values.node].items()}
    left_out = {at: ("skipped", reason) for at, reason in plan.skipped[values.node].items()}
    return left_out | {
        at: (outcome.state, outcome.reason) for at, outcome in steps.items() if at not in found
    }


def _rows(table: pd.DataFrame | None, axes: Sequence[str]) -> pd.DataFrame:
    """Return the rows of one combination: those of its table, or an empty one in its place."""
    import pandas as pd

    if table is None:
        return pd.DataFrame(index=range(1))
    if not isinstance(table.index, pd.RangeIndex) or table.index.name is not None:
        table = table.reset_index()
    return table.drop(columns=[axis for axis in axes if axis in table.columns])


def _series(column: Sequence[Any]) -> pd.Series[Any]:
    import pandas as pd

    plain = all(one is None or isinstance(one, _PLAIN) for one in column)
    return pd.Series(column, dtype=None if plain and column else object)


def _insert_axes(
    body: pd.DataFrame, axes: Sequence[str], order: Sequence[Combination], counts: Sequence[int]
) -> None:
    for place, axis in enumerate(axes):
        body.insert(place, axis, _repeated([one[place] for one in order], counts))


def _repeated(items: Sequence[Any], counts: Sequence[int]) -> list[Any]:
    pairs = zip(items, counts, strict=True)
    return [one for item, count in pairs for one in itertools.repeat(item, count)]


def _name(values: Values) -> str:
    """Return what the column of values is called: a node with alternatives is an axis itself."""
    output = values.run.plan.graph.nodes[values.node].first.node.outputs[0].name
    names = (values.port or values.node, output, f"{values.node}_{output}")
    return next((name for name in names if name not in values.axes), names[-1])
