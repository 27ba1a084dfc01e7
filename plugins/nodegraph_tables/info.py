"""The information that a table carries: title, answer, notes, units, marked cells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING, Any, Literal

from pydantic.dataclasses import dataclass

from nodegraph import Value
from nodegraph_tables.answer import Answer
from nodegraph_tables.poses import Poses

if TYPE_CHECKING:
    import pandas as pd

BetterEnd = Literal["lower", "higher", "none"]
Part = Literal["low", "high", "p"]


@dataclass(frozen=True, config={"defer_build": True})
class Take(Value):
    """The recording that the rows of a table are of.

    Attributes
    ----------
    frames : int
        Its length.
    correlation : float
        Frames over which it is correlated: what happens now says little of what happens later.
    """

    frames: int
    correlation: float


@dataclass(frozen=True, config={"defer_build": True})
class TableInfo:
    """Information of a table beside its rows, for readers and for nodes that compare tables.

    Attributes
    ----------
    title : str
        The caption. Default: what the report calls the result.
    answer : Answer
        To the question of the study; the report begins with it. Empty where there is none.
    notes : tuple of str
        Remarks below the table.
    units : mapping of column to str
        ``share`` for a number from 0 to 1 that is shown in percent; ``chance`` for a p, which is
        shown in four decimals, and below 0.0001 as such.
    better : mapping of column to {"lower", "higher", "none"}
        Which end of a column is the better one; "none" for a value that is best in between, such
        as a lag. Default: lower.
    labels : tuple of columns, optional
        The columns that identify a row. Default: the first column if it holds text.
    best : mapping of column to tuple of int
        The rows whose cells are marked as the best.
    tied : mapping of column to tuple of int
        The rows whose cells are marked, since each may be the best.
    highlights : tuple of int
        Further rows that a folded table shows, such as the nearest that is behind, or a baseline.
    overall : tuple of int
        The rows that are over all labels of the columns in which they have none: a reader sees
        ``all`` there.
    sequences : tuple of columns
        Columns whose labels follow one another, such as the steps of a chain, in the order of the
        rows.
    compared : str
        The column of what is compared. A report marks its rows with what is selected in a chart.
    cells : mapping of column to mapping of {"low", "high", "p"} to column
        The columns that are shown within the cells of another, as ``mean [low, high]``, with a
        dagger where p is below 0.05.
    layout : pair of tuples of columns
        Labels that stand down the side, and along the top, where a reader sees the marked numbers
        in rows and columns; see `crosstab`. The CSV file has a row for each.
    unseen : tuple of columns
        Columns that only the CSV file has.
    take : Take, optional
        The recording that all rows are of; their columns ``start`` and ``frames`` are places in it.
    poses : Poses, optional
        Poses of the recording that is scored, without its damage where that is known: comparisons
        tell by it takes of one person, which are not independent.

    Raises
    ------
    pydantic.ValidationError
        If a field has another type.
    """

    title: str = ""
    answer: Answer = Answer()
    notes: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)
    better: Mapping[str, BetterEnd] = field(default_factory=dict)
    labels: tuple[str, ...] | None = None
    best: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    tied: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    highlights: tuple[int, ...] = ()
    overall: tuple[int, ...] = ()
    sequences: tuple[str, ...] = ()
    compared: str = ""
    cells: Mapping[str, Mapping[Part, str]] = field(default_factory=dict)
    layout: tuple[tuple[str, ...], tuple[str, ...]] = ((), ())
    unseen: tuple[str, ...] = ()
    take: Take | None = None
    poses: Poses | None = None


def with_info(table: pd.DataFrame, info: TableInfo) -> pd.DataFrame:
    """Return the table with this information, which pandas' operations pass on.

    Examples
    --------
    >>> from pandas import DataFrame
    >>> errors = DataFrame({"marker": ["lip", "chin"], "rmse": [0.4, 0.7]})
    >>> errors = with_info(errors, TableInfo(units={"rmse": "mm"}, better={"rmse": "lower"}))
    >>> info_of(errors).units
    {'rmse': 'mm'}
    """
    from nodegraph_tables.frame import TableFrame

    frame = TableFrame(table)
    finalize: Any = frame.__finalize__  # unknown to the stubs of pandas
    finalize(table)
    frame.table_info = info
    return frame


def info_of(table: pd.DataFrame) -> TableInfo:
    """Return the information of a table; an empty `TableInfo` for a plain DataFrame."""
    # a plain DataFrame may have a column of that name
    info = getattr(table, "table_info", None)
    return info if isinstance(info, TableInfo) else TableInfo()
