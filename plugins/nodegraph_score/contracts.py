"""Contracts of every score, third-party ones included."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import Table, Trajectories
from nodegraph_tables import info_of

_ANSWERS = ("truth", "reference")
_ROUNDING = 1e-9
_FAR = 50.0
"""Factor that reveals a score in another unit than it states."""


def gives_a_table(tried: Tried) -> Iterator[str]:
    """Give a table first."""
    name, first = next(iter(tried.outputs.items()))
    if not isinstance(first, Table):
        yield f"{name!r} is a {type(first).__name__}, not a pandas DataFrame"


def the_answer_scores_zero(tried: Tried) -> Iterator[str]:
    """Score no error, in millimetres better low, where the estimate is the answer itself."""
    answer = next((tried.inputs[name] for name in _ANSWERS if name in tried.inputs), None)
    if answer is None or "estimate" not in tried.inputs:
        return
    outputs = tried.again(estimate=answer)
    if outputs is None:
        yield "declines the answer as an estimate"
        return
    table = next(iter(outputs.values()))
    info = info_of(table)
    for column, unit in info.units.items():
        error = unit.startswith("mm") and info.better.get(column, "lower") == "lower"
        if error and column in table and np.any(table[column].abs() > 0):
            yield f"column {column!r} has {table[column].abs().max():.3g} {unit}"


def marks_millimetres(tried: Tried) -> Iterator[str]:
    """Score an estimate that is off by a millimetre everywhere near 1, where the unit is mm."""
    truth = next((tried.inputs[name] for name in _ANSWERS if name in tried.inputs), None)
    if not isinstance(truth, Trajectories) or "estimate" not in tried.inputs:
        return
    shifted = replace(truth, positions=truth.positions + np.array([1.0, 0.0, 0.0]))
    outputs = tried.again(estimate=shifted)
    if outputs is None:
        return
    table = next(iter(outputs.values()))
    for column, unit in info_of(table).units.items():
        largest = table[column].abs().max() if unit == "mm" and column in table else 0.0
        if _ROUNDING < largest < 1.0 / _FAR or largest > _FAR:
            yield f"column {column!r} has {largest:.3g} mm: is it in metres?"


CONTRACTS = (gives_a_table, the_answer_scores_zero, marks_millimetres)
