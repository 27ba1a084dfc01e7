"""Differences between two tables, by columns and rows, and between two figures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import Comparison, listed
from nodegraph_tables.stored_figure import StoredFigure
from nodegraph_tables.types import Table

if TYPE_CHECKING:
    from numpy.typing import NDArray

_NAMED = 5


def comparisons() -> tuple[Comparison, ...]:
    """Return how tables and figures are compared."""
    return (Comparison(Table, compare_tables), Comparison(StoredFigure, compare_drawings))


def compare_tables(one: Table, other: Table) -> Iterator[str]:
    """Yield which columns differ, in how many rows and by how much."""
    before, now = tuple(map(str, one.columns)), tuple(map(str, other.columns))
    if before != now:
        yield from names_apart("columns", before, now)
    if len(one) != len(other):
        yield f"had {len(one)} rows, now {len(other)}"
        return
    for column in (name for name in one.columns if name in other.columns):
        was, here = one[column].to_numpy(), other[column].to_numpy()
        differs = differing(was, here)
        if differs.any():
            yield f"{column}: {_rows(differs)}: {_change(was, here, differs)}"


def compare_drawings(one: StoredFigure, other: StoredFigure) -> Iterator[str]:
    """Yield that two figures are not the same, if they are not."""
    if one.svg != other.svg:
        yield "the drawing is another"


def differing(was: NDArray[Any], now: NDArray[Any]) -> NDArray[np.bool_]:
    """Return where two arrays differ; NaN equals NaN."""
    differs = np.asarray(was != now, dtype=np.bool_)
    return differs & ~(np.asarray(was != was, np.bool_) & np.asarray(now != now, np.bool_))


def names_apart(what: str, one: Sequence[str], other: Sequence[str]) -> Iterator[str]:
    """Yield which names only one of two sequences has, and whether their order differs."""
    for said, names in (
        ("only before", [name for name in one if name not in set(other)]),
        ("only now", [name for name in other if name not in set(one)]),
    ):
        if names:
            yield f"{what} {said}: {listed(names, _NAMED)}"
    if set(one) == set(other):
        yield f"{what} in another order"


def _rows(differs: NDArray[np.bool_]) -> str:
    places = np.flatnonzero(differs)
    return f"row{'s' if len(places) > 1 else ''} {listed(places.tolist(), _NAMED)}"


def _change(was: NDArray[Any], now: NDArray[Any], differs: NDArray[np.bool_]) -> str:
    """Return the largest change, or the first where there are no numbers."""
    place = int(np.argmax(differs))
    if was.dtype.kind in "fiu" and now.dtype.kind in "fiu":
        size = np.abs(now.astype(float) - was.astype(float))
        size[~np.isfinite(size)] = 0.0
        if size.any():
            place = int(np.argmax(size))
            return f"by up to {size[place]:.3g} ({was[place]:.6g}, now {now[place]:.6g})"
    return f"{was[place]}, now {now[place]}"
