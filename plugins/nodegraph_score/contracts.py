"""What every score promises, whoever wrote it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import Table

_ANSWERS = ("truth", "reference")


def gives_a_table(tried: Tried) -> Iterator[str]:
    """Give a table first."""
    name, first = next(iter(tried.outputs.items()))
    if not isinstance(first, Table):
        yield f"{name!r} is a {type(first).__name__}, not a pandas DataFrame"


def the_answer_scores_zero(tried: Tried) -> Iterator[str]:
    """Score no error, in every column of millimetres, where the estimate is the answer itself."""
    answer = next((tried.inputs[name] for name in _ANSWERS if name in tried.inputs), None)
    if answer is None or "estimate" not in tried.inputs:
        return
    outputs = tried.again(estimate=answer)
    if outputs is None:
        yield "declines the answer as an estimate"
        return
    table = next(iter(outputs.values()))
    for column, unit in table.attrs.get("units", {}).items():
        if unit.startswith("mm") and column in table and np.any(table[column].abs() > 0):
            yield f"column {column!r} has {table[column].abs().max():.3g} {unit}"


CONTRACTS = (gives_a_table, the_answer_scores_zero)
