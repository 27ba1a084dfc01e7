"""Which labels of a comparison stand down the side of its table, and which along the top."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from nodegraph import Across
    from nodegraph_compare.question import Question
    from nodegraph_mocap import Table

Names = tuple[str, ...]


@dataclass(frozen=True)
class Layout:
    """Names that stand down the side, and along the top; without the latter, a row per mean."""

    rows: Names
    columns: Names


def implied(
    scores: Across[Table], compare: str | None, within: Names, layout: Layout, blocks: Names
) -> tuple[str | None, Names]:
    """Return what is compared, and within what, as far as the layout says so.

    Every name laid out is compared or in `within`; compared is, if nothing else is said, the
    last gathered axis among them.

    Parameters
    ----------
    scores
        The gathered tables.
    compare, within, blocks
        As the user gave them.
    layout
        Which names stand down the side, and along the top.

    Raises
    ------
    ValueError
        If a name is laid out twice.
    """
    named = (*layout.rows, *layout.columns)
    repeated = sorted({name for name in named if named.count(name) > 1})
    if repeated:
        raise ValueError(f"rows and columns share a name: {', '.join(repeated)}")
    axes = [name for name in scores.axes if name in named and name not in (*within, *blocks)]
    if compare is None and axes:
        compare = axes[-1]
    return compare, (*within, *(name for name in named if name not in (compare, *within)))


def completed(layout: Layout, question: Question) -> Layout:
    """Return the layout with a place for every name of the question, in rows if it has columns."""
    names = (*question.within, *question.compared)
    rest = tuple(name for name in names if name not in (*layout.rows, *layout.columns))
    if layout.columns:
        return Layout((*layout.rows, *rest), layout.columns)
    return Layout(layout.rows, rest if layout.rows else ())
