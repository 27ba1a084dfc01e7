"""The values of a node as one table."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from nodegraph.plan import Combination
from nodegraph.state import State

if TYPE_CHECKING:
    import pandas as pd

    from nodegraph.execute.results import Values

_SCALARS = (bool, int, float, str)


def frame_of(values: Values) -> pd.DataFrame:
    """Return the values of a node, with a leading column for each of its axes.

    Tables are concatenated: their rows get the labels of their combination, a column that is
    named like an axis is replaced by it, and the `attrs` of the first table are kept. Any other
    values are one column, named after the output or the node. A combination without a value is
    one row in which the value is missing; only if there is such a row, the columns ``state`` and
    ``reason`` say for every row how its step ended.
    """
    import pandas as pd

    present = {tuple(labels.values()): value for labels, value in values}
    absent = _absent(values, present)
    axes = values.run.plan.graph.axes
    every = itertools.product(*(axes[axis].labels for axis in values.axes))
    order = [at for at in every if at in present or at in absent]
    if present and all(isinstance(value, pd.DataFrame) for value in present.values()):
        tables = [_rows(present.get(at), values.axes) for at in order]
        body = pd.concat(tables, ignore_index=True)
        body.attrs = dict(next(iter(present.values())).attrs)
        counts = [len(table) for table in tables]
    else:
        body = pd.DataFrame({_column_name(values): _column([present.get(at) for at in order])})
        counts = [1] * len(order)
    for position, axis in enumerate(values.axes):
        body.insert(position, axis, _repeated([at[position] for at in order], counts))
    if absent:
        ends = [absent.get(at, (State.DONE.value, "")) for at in order]
        for position, name in enumerate(("state", "reason")):
            # a table may have such a column of its own
            free = f"{values.node}_{name}" if name in body.columns else name
            body[free] = _repeated([end[position] for end in ends], counts)
    return body


def _absent(
    values: Values, present: Mapping[Combination, Any]
) -> dict[Combination, tuple[str, str]]:
    """Return the state and the reason of each combination without a value."""
    plan, outcomes = values.run.plan, values.run.outcomes
    skipped = {at: (State.SKIPPED.value, why) for at, why in plan.skipped[values.node].items()}
    ended = {at: outcomes[index] for at, index in plan.cells[values.node].items()}
    return skipped | {
        at: (outcome.state.value, outcome.reason)
        for at, outcome in ended.items()
        if at not in present
    }


def _rows(table: pd.DataFrame | None, axes: Sequence[str]) -> pd.DataFrame:
    """Return the rows of one combination: those of its table, or an empty row without one."""
    import pandas as pd

    if table is None:
        return pd.DataFrame(index=range(1))
    if not isinstance(table.index, pd.RangeIndex) or table.index.name is not None:
        table = table.reset_index()
    return table.drop(columns=[axis for axis in axes if axis in table.columns])


def _column(values: Sequence[Any]) -> pd.Series[Any]:
    import pandas as pd

    scalars = all(value is None or isinstance(value, _SCALARS) for value in values)
    return pd.Series(values, dtype=None if scalars and values else object)


def _column_name(values: Values) -> str:
    """Return a name that no axis has: a node with alternatives is an axis itself."""
    output = values.run.plan.graph.nodes[values.node].first.node.outputs[0].name
    names = (values.port or values.node, output, f"{values.node}_{output}")
    return next((name for name in names if name not in values.axes), names[-1])


def _repeated(items: Sequence[Any], counts: Sequence[int]) -> list[Any]:
    pairs = zip(items, counts, strict=True)
    return [copy for item, count in pairs for copy in itertools.repeat(item, count)]
