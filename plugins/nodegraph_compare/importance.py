"""How much of a metric's variance each axis explains, and how often the winner changes."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph import Across, Label, listed, node
from nodegraph_compare.blocks import Columns, columns_of, unsuccessful, values_of
from nodegraph_compare.left_out import absences, end_text, shortened
from nodegraph_compare.question import (
    Better,
    Names,
    OneColumn,
    OneName,
    Question,
    ask,
    sign_of,
    unit_of,
)
from nodegraph_compare.ties import ROUNDING, tied
from nodegraph_compare.unused_axes import unused_axes
from nodegraph_mocap import Figure, Table, figure_text
from nodegraph_tables import TableInfo, with_info
from nodegraph_tables.axes import plain
from nodegraph_tables.style import BEST, BLACK, LINE, REST

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

_MOST_BARS = 20
_LEAST = 0.005
_MOST = 6
_MOST_CELLS = 20_000_000
HIGHER = "higher interactions"

Sources = tuple[int, ...]


class Explained(NamedTuple):
    """What explains a metric: its numbers and their picture."""

    table: Table
    figure: Figure


@dataclass(frozen=True)
class _Grid:
    """A value for every combination of labels; `dropped` lists the labels that were left out."""

    labels: tuple[tuple[Label, ...], ...]
    values: NDArray[np.float64]
    dropped: tuple[str, ...]


@node("compare.importance", cite=("hoeffding1948class", "hutter2014efficient"))
def importance(
    scores: Across[Table],
    *,
    metric: OneColumn = None,
    compare: OneName = None,
    factors: Names = (),
    better: Better = "declared",
) -> Explained:
    """Variance of a metric that each axis explains, and how often the best method changes with it.

    A cell is one combination of the labels of the factors; its value is the mean of the metric
    over its rows. The functional analysis of variance splits the variance of the cells exactly:
    ``V = sum of V_a + sum of V_ab + rest``, ``V_a`` the variance of the means along axis a,
    ``V_ab`` what the means along two axes add to those along each, the rest the
    interactions of three axes or more. ``eta squared`` is the share of V, ``partial eta squared``
    of an effect is ``V_a / (V_a + V_rest)``; of two factors, the rest is their interaction. These
    are shares of the cells available: an axis explains more the further its labels lie apart. Cells
    that compete, at most 1e-9 of their size apart, are equal: each stands as the first of them. A
    variance that rounding alone would make, at most the square of 1e-9 times the cells' root mean
    square, is 0.

    The split holds for a full table only. Where cells are missing (refused, failed, skipped, or
    with a row without a number), labels are left out until none is: each time the label with the
    largest share of missing cells, of equals one of the axis with most labels. What goes is named
    in a warning and in the notes.

    Parameters
    ----------
    scores
        Tables, a row per unit (a gap, a marker, a take).
    metric
        The column of numbers to explain. Default: the first column of floats.
    compare
        The factor whose labels compete. Default: the last gathered axis.
    factors
        Axes, or columns. Default: every gathered axis; where there is one only, the first column
        of the tables too, if it identifies the unit of a row.
    better
        Which end of the metric wins: ``lower``, ``higher``, or ``none`` (no label wins).
        ``declared``: as the scores declare it, else ``lower``.

    Returns
    -------
    table
        A row per factor, pair of factors, and for what is left: ``labels`` (of a factor),
        ``variance`` (the metric's unit, squared), ``eta squared``, ``partial eta squared``,
        ``winner changes`` (share of pairs of labels of that factor, all other factors equal,
        whose best label of `compare` is another; equal values: the first).
    figure
        The shares.

    Raises
    ------
    ValueError
        If a name is neither axis nor column or is used twice, `compare` is not a factor, the metric
        holds no numbers, or there are more than twenty million cells.
    """
    question = _ask(scores, metric, compare, factors, better)
    grid = _grid(scores, question)
    table = _table(grid, question)
    absent = absences(unsuccessful(scores), question.compare)
    if grid.dropped or absent:
        warnings.warn(shortened([*grid.dropped, *absent]), stacklevel=2)
    notes = (
        f"A cell is one combination of {', '.join(_factors(question))}, the mean of "
        f"{question.metric} over its rows; {grid.values.size} cells. {end_text(question)}",
        "eta squared: share of the cells' variance. winner changes: share of pairs of labels of "
        "the factor, all others equal, between which the best changes.",
        *grid.dropped,
        *absences(scores.absent, question.compare),
        *unused_axes(scores, question.compare).values(),
    )
    unit = unit_of(scores, question.metric)
    shares = ("eta squared", "partial eta squared", "winner changes")
    info = TableInfo(
        title=f"What explains the variance of {question.metric}",
        answer=tuple(answers(table, question)),
        notes=notes,
        units=dict.fromkeys(shares, "share") | ({"variance": f"({unit})^2"} if unit else {}),
    )
    return Explained(with_info(table, info), _draw(table, question))


def answers(table: Table, question: Question) -> list[str]:
    """Return how much the largest sources explain, and with what the best changes."""
    if not table["variance"].notna().any():
        return ["no full table of combinations is left; nothing can be said."]
    if not table["variance"].sum() > 0.0:
        return [f"{question.metric} is the same in all combinations; nothing is to be explained."]
    ordered = table.sort_values("eta squared", ascending=False, kind="stable").head(_MOST)
    shares = [
        f"{source} {100 * share:.0f} %"
        for source, share in zip(ordered["source"], ordered["eta squared"], strict=True)
        if share >= _LEAST
    ]
    sentences = [f"Share of the variance of {question.metric}: {', '.join(shares)}."]
    changes = [
        f"{100 * share:.0f} % of the time with {source}"
        for source, share in zip(table["source"], table["winner changes"], strict=True)
        if np.isfinite(share)
    ]
    if changes:
        sentences.append(
            f"From one label to another, the best {question.compare} changes {listed(changes)}."
        )
    return sentences


def whole(values: NDArray[np.float64]) -> tuple[NDArray[np.intp], ...]:
    """Return the places along each axis that make a table without missing values.

    As long as something is missing, the place with the largest share missing goes; of equals,
    one of the axis with the most places, the last of them.
    """
    places: list[NDArray[np.intp]] = [np.arange(size) for size in values.shape]
    missing = np.isnan(values)
    while missing.any():
        shares = [_mean(missing, (axis,)) for axis in range(missing.ndim)]
        largest = max(share.max() for share in shares)
        axis = max(
            (axis for axis, share in enumerate(shares) if share.max() == largest),
            key=lambda axis: missing.shape[axis],
        )
        # what is missing altogether goes at once
        gone = np.flatnonzero(shares[axis] == largest)
        gone = gone if largest == 1.0 else gone[-1:]
        places[axis] = np.delete(places[axis], gone)
        missing = np.delete(missing, gone, axis=axis)
    return tuple(places)


def effects(values: NDArray[np.float64]) -> Mapping[Sources, float]:
    """Return the variance that each axis, and each pair of axes, explains.

    The functional analysis of variance of a full table y (Hoeffding 1948; Hutter et al. 2014 for
    settings of algorithms), population variances: with m the mean over all cells, ``m_a`` the
    means along axis a and ``m_ab`` those along two, ``V_a = mean((m_a - m)^2)`` and
    ``V_ab = mean((m_ab - m_a - m_b + m)^2)``. The key ``()`` has what is left of
    ``V = mean((y - m)^2)``; of one or two axes, nothing is. A variance that rounding alone would
    make, at most ``mean(y^2)`` times the square of 1e-9, is 0.
    """
    left = values - values.mean()
    least = ROUNDING**2 * float(np.square(values).mean())
    axes = range(values.ndim)
    main = {axis: _mean(left, (axis,)) for axis in axes}
    parts: dict[Sources, NDArray[np.float64]] = {(axis,): part for axis, part in main.items()}
    for first, other in combinations(axes, 2):
        both = _mean(left, (first, other)) - main[first][:, np.newaxis] - main[other]
        parts[first, other] = both
    for sources, part in parts.items():
        left -= np.expand_dims(part, tuple(axis for axis in axes if axis not in sources))
    variances = {sources: float(np.square(part).mean()) for sources, part in parts.items()}
    variances[()] = float(np.square(left).mean()) if values.ndim > 2 else 0.0
    return {sources: size if size > least else 0.0 for sources, size in variances.items()}


def winner_changes(values: NDArray[np.float64], compared: int, axis: int) -> float:
    """Return how often two places along an axis, all else equal, have another lowest place.

    The share of all pairs of places along `axis`, over all places along the others, for which
    the first of the lowest values along `compared` stands elsewhere; NaN for a single place.

    Parameters
    ----------
    values
        A full table, an array with an axis per factor.
    compared
        The axis along which the lowest wins.
    axis
        The axis whose places are taken in pairs.
    """
    if values.shape[axis] < 2:
        return np.nan
    winners = np.moveaxis(values, compared, -1).argmin(axis=-1)
    along = np.moveaxis(winners, axis - (axis > compared), -1)
    count = along.shape[-1]
    wins = np.stack([(along == place).sum(axis=-1) for place in range(values.shape[compared])])
    same = (wins * (wins - 1)).sum(axis=0) / (count * (count - 1))
    return float(1.0 - same.mean())


def _mean(
    values: NDArray[np.float64] | NDArray[np.bool_], axes: tuple[int, ...]
) -> NDArray[np.float64]:
    """Return the means over all axes but these."""
    rest = tuple(axis for axis in range(values.ndim) if axis not in axes)
    return np.asarray(np.mean(values, axis=rest, dtype=np.float64))


def _ask(
    scores: Across[Table],
    metric: str | None,
    compare: str | None,
    factors: tuple[str, ...],
    better: Better,
) -> Question:
    """Return the question: its `within` are the factors that are not compared, in order."""
    if factors and compare is not None and compare not in factors:
        raise ValueError(f"{compare!r} is not a factor; factors are: {', '.join(factors)}")
    gathered = [name for name in factors if name in scores.axes]
    compare = compare if compare is not None or not factors else (gathered or factors)[-1]
    within = tuple(name for name in factors if name != compare)
    if len({*factors}) < len(factors):
        raise ValueError(f"factors name something twice: {', '.join(factors)}")
    question = ask(scores, metric=metric, compare=compare, within=within, blocks=(), better=better)
    if factors:
        return question
    # the defaults of `blocks` are the other axes, and the unit
    rest = tuple(name for name in question.blocks if name in scores.axes) or question.blocks
    return ask(
        scores, metric=metric, compare=question.compare, within=rest, blocks=(), better=better
    )


def _factors(question: Question) -> tuple[str, ...]:
    return (*question.within, *question.compared)


def _grid(scores: Across[Table], question: Question) -> _Grid:
    columns = columns_of(scores, _factors(question))
    values = _cell_means(columns, values_of(scores, question.metric), _factors(question))
    complete = whole(values)
    labels = tuple(
        tuple(all_of[place] for place in places)
        for all_of, places in zip(columns.labels, complete, strict=True)
    )
    gone = [
        f"{name}: left out {listed([label for label in all_of if label not in left])}"
        for name, all_of, left in zip(_factors(question), columns.labels, labels, strict=True)
        if len(left) < len(all_of)
    ]
    missing = int(np.isnan(values).sum())
    dropped = (f"{missing} of {values.size} cells have no number", *gone) if gone else ()
    return _Grid(labels, tied(values[np.ix_(*complete)]), dropped)


def _cell_means(
    columns: Columns, value: NDArray[np.float64], names: tuple[str, ...]
) -> NDArray[np.float64]:
    """Return the mean of the rows of each cell, an axis per factor; NaN without one."""
    sizes = [len(labels) for labels in columns.labels]
    cells = math.prod(sizes)
    if cells > _MOST_CELLS:
        counts = ", ".join(f"{name} {size}" for name, size in zip(names, sizes, strict=True))
        raise ValueError(
            f"{cells} cells are more than {_MOST_CELLS}; labels: {counts}; name fewer factors"
        )
    cell = columns.combined()
    count = np.bincount(cell, minlength=cells)
    total = np.bincount(cell, weights=value, minlength=cells)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan).reshape(sizes)


def _table(grid: _Grid, question: Question) -> Table:
    from pandas import DataFrame

    count = len(_factors(question))
    variances = effects(grid.values) if grid.values.size else _unknown(count)
    listed_sources = [sources for sources in variances if sources or count > 2]
    frame = DataFrame([_row(sources, variances, grid, question) for sources in listed_sources])
    frame["labels"] = frame["labels"].astype("Int64")
    return frame


def _row(
    sources: Sources, variances: Mapping[Sources, float], grid: _Grid, question: Question
) -> dict[str, object]:
    names = _factors(question)
    # of two factors, what is left is their interaction
    rest: Sources = (0, 1) if len(names) == 2 else ()
    variance, beside = variances[sources], variances[sources] + variances[rest]
    alone = len(sources) == 1
    return {
        "source": " x ".join(names[axis] for axis in sources) or HIGHER,
        "labels": len(grid.labels[sources[0]]) if alone else np.nan,
        "variance": variance,
        "eta squared": _share(variance, sum(variances.values())),
        "partial eta squared": np.nan if sources == rest else _share(variance, beside),
        "winner changes": _changes(grid, question, sources[0]) if alone else np.nan,
    }


def _unknown(count: int) -> Mapping[Sources, float]:
    return dict.fromkeys(effects(np.zeros((1,) * count)), np.nan)


def _share(part: float, total: float) -> float:
    return part / total if total > 0.0 else np.nan


def _changes(grid: _Grid, question: Question, axis: int) -> float:
    compared = len(question.within)
    if not grid.values.size or not question.compare or question.better == "none":
        return np.nan
    if axis == compared:
        return np.nan
    return winner_changes(sign_of(question.better) * grid.values, compared, axis)


def _draw(table: Table, question: Question) -> Figure:
    """Return the figure: a bar per source, the largest on top, at most 20."""
    from matplotlib.figure import Figure as Drawing

    from nodegraph_compare.pictures import without_drawing

    ordered = table.dropna(subset="eta squared")
    ordered = ordered.sort_values("eta squared", ascending=False, kind="stable").head(_MOST_BARS)
    if not len(ordered):
        return without_drawing("nothing to explain")
    places = range(len(ordered))
    factors = ordered["labels"].notna()
    pairs = ordered["source"].str.contains(" x ", regex=False)
    colours = [
        BEST if factor else REST if pair else LINE
        for factor, pair in zip(factors, pairs, strict=True)
    ]
    figure = Drawing(figsize=(6.0, 0.9 + 0.3 * len(ordered)), layout="constrained")
    axis = figure.subplots()
    axis.barh(places, ordered["eta squared"], color=colours, height=0.7)
    for place, share in zip(places, ordered["eta squared"], strict=True):
        axis.annotate(
            f"{100 * share:.1f} %", (share, place), xytext=(3, 0), textcoords="offset points",
            va="center", fontsize=9,
        )  # fmt: skip
    axis.set_yticks(places, [figure_text(source) for source in ordered["source"]])
    axis.invert_yaxis()
    axis.set_xlim(0, min(1.0, 1.15 * ordered["eta squared"].max()) + 0.05)
    axis.xaxis.set_major_formatter(lambda share, _: f"{100 * share:.0f} %")
    axis.set_xlabel(figure_text(f"share of the variance of {question.metric}"))
    plain(axis, grid="x")
    axis.tick_params(axis="y", labelcolor=BLACK)
    return figure
