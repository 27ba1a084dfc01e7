"""Names of columns and axes: those that settings take, and whether the tables have them."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Annotated

from nodegraph import Across, ColumnOf, LabelOf

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from nodegraph_mocap import Table

OneColumn = Annotated[str | None, ColumnOf("scores")]
OneName = Annotated[str | None, ColumnOf("scores", or_axis=True)]
OneLabel = Annotated[str | None, LabelOf("scores", axis="compare")]
Names = Annotated[tuple[str, ...], ColumnOf("scores", or_axis=True)]


def check_known(scores: Across[Table], name: str, *, what: str = "axis or column") -> None:
    """Raise a ValueError if a name is no gathered axis, and no column of one of the tables.

    Parameters
    ----------
    scores
    name
    what
        ``metric`` for what must be a column.
    """
    axes = () if what == "metric" else scores.axes
    if name in axes:
        return
    for where, table in placed(scores):
        if name not in table.columns:
            there = f"axes: {listed(axes)}; " if what != "metric" else ""
            near = near_name(name, (*axes, *map(str, table.columns)))
            raise ValueError(
                f"no {what} {name!r}{where}; {near}{there}columns: {listed(table.columns)}"
            )


def placed(scores: Across[Table]) -> Iterator[tuple[str, Table]]:
    """Yield each table, and the words that say which it is: `` in the table of trial=0``."""
    for labels, table in scores:
        told = ", ".join(f"{axis}={label}" for axis, label in labels.items() if label != "")
        yield f" in the table of {told}" if told else "", table


def listed(names: Iterable[object]) -> str:
    """Return names as text."""
    return ", ".join(str(name) for name in names) or "none"


def near_name(name: str, known: Iterable[str]) -> str:
    """Return a question for the nearest name that there is; empty where none is near."""
    close = difflib.get_close_matches(name, list(known), n=1, cutoff=0.6)
    return f"did you mean {close[0]!r}? " if close else ""
