"""The values of a node as one table."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from nodegraph.execute.outcome import Outcome
from nodegraph.node.ports import Label
from nodegraph.plan import Combination
from nodegraph.state import State

if TYPE_CHECKING:
    import pandas as pd

_SCALARS = (bool, int, float, str)


def value_table(
    node: str,
    column: str,
    axes: Mapping[str, Sequence[Label]],
    values: Mapping[Combination, Any],
    absent: Mapping[Combination, Outcome],
) -> pd.DataFrame:
    """Return the values of a node, with a leading column for each of its axes.

    Tables are concatenated: their rows get the labels of their combination, a column that is
    named like an axis is replaced by it, and the metadata of the first table is kept. Any other
    values are one column. A combination without a value is one row in which the value is missing;
    only if there is such a row, the columns ``state`` and ``reason`` say for every row how its
    step ended.

    Parameters
    ----------
    node
    column
        Name of the column of values that are not tables.
    axes
        The labels of each axis.
    values
    absent
        The outcomes of the combinations without a value.
    """
    import pandas as pd

    order = [at for at in itertools.product(*axes.values()) if at in values or at in absent]
    if values and all(isinstance(value, pd.DataFrame) for value in values.values()):
        tables = [_rows(values.get(at), axes) for at in order]
        body = pd.concat(tables, ignore_index=True)
        first = next(iter(values.values()))
        body = type(first)(body).__finalize__(first)
        counts = [len(table) for table in tables]
    else:
        body = pd.DataFrame({column: _series([values.get(at) for at in order])})
        counts = [1] * len(order)
    for position, axis in enumerate(axes):
        body.insert(position, axis, _repeated([at[position] for at in order], counts))
    if absent:
        ends = [absent.get(at, Outcome(State.DONE)) for at in order]
        columns = {"state": [end.state.value for end in ends], "reason": [e.reason for e in ends]}
        for name, texts in columns.items():
            # a table may have such a column of its own
            free = f"{node}_{name}" if name in body.columns else name
            body[free] = _repeated(texts, counts)
    return body


def _rows(table: pd.DataFrame | None, axes: Mapping[str, object]) -> pd.DataFrame:
    """Return the rows of one combination: those of its table, or an empty row without one."""
    import pandas as pd

    if table is None:
        return pd.DataFrame(index=range(1))
    if not isinstance(table.index, pd.RangeIndex) or table.index.name is not None:
        table = table.reset_index()
    return table.drop(columns=[axis for axis in axes if axis in table.columns])


def _series(values: Sequence[object]) -> pd.Series[Any]:
    import pandas as pd

    scalars = all(value is None or isinstance(value, _SCALARS) for value in values)
    return pd.Series(values, dtype=None if scalars and values else object)


def _repeated(items: Sequence[object], counts: Sequence[int]) -> list[Any]:
    pairs = zip(items, counts, strict=True)
    return [copy for item, count in pairs for copy in itertools.repeat(item, count)]
