"""From gathered tables to curves: the points of each compared label, by their place along x."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.blocks import block_means, columns_of, rows_by, values_of
from nodegraph_compare.comparison import fallback_label
from nodegraph_compare.inference import mean_interval
from nodegraph_compare.ties import tied
from nodegraph_compare.units import units_from

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nodegraph import Across, Label
    from nodegraph_mocap import Table

    Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Axes:
    """The parts of a curve's figure; each is a gathered axis or a column of the tables.

    Attributes
    ----------
    x : str
        Holds numbers.
    metric : str
        A column of numbers.
    compare : str or None
        A curve per label.
    blocks, clusters : tuple of str
        Repeats, and what they are in.
    units : tuple of str
        What distinguishes independent units: `clusters`, or the repetitions of few of them.
    others : tuple of str
        Gathered axes that are none of these.
    lowest : bool
        Whether the points of the `others` at one x stay apart, and the curve takes the lowest.
    """

    x: str
    metric: str
    compare: str | None
    blocks: tuple[str, ...]
    clusters: tuple[str, ...]
    units: tuple[str, ...]
    others: tuple[str, ...]
    lowest: bool


@dataclass(frozen=True)
class Points:
    """The P points of one compared label, in the order of their x, the lowest first.

    Attributes
    ----------
    label : str, int, float or bool
        Empty where nothing is compared.
    others : tuple of P mappings of axis to label
        Of the axes that distinguish points with one x.
    x, value, low, high : (P,) arrays of float64
        Value: the geometric mean over the clusters of the means of their blocks, arithmetic where
        some number is 0 or below, or the mean of rows where no blocks are named; NaN where there is
        none; those that differ by rounding alone are equal. Ends of its interval: NaN with fewer
        than three units, or where no blocks are named.
    count : (P,) array of int
        Blocks, or rows, with a number.
    without_x, without_value : int
        Rows left out because x is not a finite number, and blocks (or rows) because the metric is
        none.
    taken : int
        Blocks whose value is the fallback's.
    """

    label: Label
    others: tuple[Mapping[str, Label], ...]
    x: NDArray[np.float64]
    value: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    count: NDArray[np.intp]
    without_x: int
    without_value: int
    taken: int = 0

    @property
    def curve(self) -> NDArray[np.intp]:
        """Places of the points that the curve takes: at each x the lowest, the first of equals."""
        known = np.flatnonzero(np.isfinite(self.value))
        return known[np.unique(self.x[known], return_index=True)[1]]


def points(scores: Across[Table], axes: Axes, fallback: str | None = None) -> tuple[Points, ...]:
    """Return the points of every compared label, in the order of the labels.

    Parameters
    ----------
    scores
        The gathered tables.
    axes
        Which axis or column is what.
    fallback
        The label whose value stands where another one with a curve has none in a block.

    Raises
    ------
    ValueError
        If there is a fallback, and nothing is compared or there are no blocks.
    """
    labels, kind = _compared(scores, axes.compare)
    x, value = _along(scores, axes.x), values_of(scores, axes.metric)
    placed, known, row = np.isfinite(x), np.isfinite(value), np.arange(len(x))
    others = columns_of(scores, axes.others if axes.lowest else ())
    other = others.combined()
    # where no blocks are named each row is one, and a point of its own if points stay apart
    block = columns_of(scores, axes.blocks + axes.clusters).combined() if axes.blocks else row
    apart = other if axes.blocks or not axes.lowest else row
    keys = np.stack([x, apart, block])[:, placed]
    keys, first, of = np.unique(keys, axis=1, return_index=True, return_inverse=True)
    first, shape = row[placed][first], (len(first), len(labels))
    values, _ = block_means(of, kind[placed], value[placed], *shape)
    there, taken = np.zeros(shape, dtype=np.bool_), np.zeros(shape, dtype=np.bool_)
    there[of, kind[placed]] = True
    if fallback is not None and (axes.compare is None or not axes.blocks):
        lacking = "blocks" if axes.compare else "an axis or column to compare"
        raise ValueError(f"a fallback needs {lacking}, and there is none")
    stands = fallback_label(labels, fallback)
    if stands is not None:
        instead = values[:, [labels.index(stands)]]
        taken = np.isnan(values) & np.isfinite(instead) & np.isin(range(len(labels)), kind[known])
        values, there = np.where(taken, instead, values), there | taken
    cluster = columns_of(scores, axes.clusters).combined()[first]
    draw = columns_of(scores, () if axes.units == axes.clusters else axes.units).combined()[first]
    ratio = bool((value[known] > 0.0).all())
    _, point = np.unique(keys[:2], axis=1, return_inverse=True)
    of_points = rows_by(point).values()
    result = []
    for at, label in enumerate(labels):
        own = [mine for blocks in of_points if len(mine := blocks[there[blocks, at]])]
        numbers = np.array(
            [_statistics(values[mine, at], cluster[mine], draw[mine], axes, ratio) for mine in own]
        ).reshape(-1, 4)
        numbers[:, 0] = tied(numbers[:, 0])
        rows = first[[mine[0] for mine in own]]
        order = np.lexsort((numbers[:, 0], x[rows]))
        rows, (mean, low, high, count) = rows[order], numbers[order].T
        result.append(
            Points(
                label,
                tuple(
                    dict(zip(others.names, others.decoded(code), strict=True))
                    for code in other[rows].tolist()
                ),
                x[rows],
                mean,
                low,
                high,
                count.astype(np.intp),
                without_x=int(np.count_nonzero(kind[~placed] == at)),
                without_value=int(np.count_nonzero(there[:, at] & np.isnan(values[:, at]))),
                taken=int(np.count_nonzero(taken[:, at])),
            )
        )
    return tuple(result)


def floors(floor: Across[Table], axes: Axes) -> dict[Label, float]:
    """Return the mean of the metric over each label's rows; of all, if nothing distinguishes them.

    The one number of rows that have no compared label stands under an empty label.
    """
    known = axes.compare in floor.axes or any(axes.compare in table for table in floor.values())
    labels, kind = _compared(floor, axes.compare if known else None)
    value = values_of(floor, axes.metric)
    kind, value = kind[np.isfinite(value)], value[np.isfinite(value)]
    means, _ = block_means(np.zeros_like(kind), kind, value, 1, len(labels))
    return {labels[at]: float(means[0, at]) for at in np.unique(kind)}


def _compared(
    scores: Across[Table], name: str | None
) -> tuple[tuple[Label, ...], NDArray[np.intp]]:
    """Return the compared labels, an empty one where nothing is compared, and each row's place."""
    from pandas import isna

    if name is None:
        return ("",), columns_of(scores, ()).combined()
    columns = columns_of(scores, (name,))
    labels = ("missing" if isna(label) else label for label in columns.labels[0])
    return tuple(labels), columns.codes[0]


def _along(scores: Across[Table], name: str) -> Numbers:
    """Return the numbers of all rows in an axis, or in a column."""
    if name not in scores.axes:
        return values_of(scores, name)
    labels = np.array([labels[name] for labels, _ in scores], dtype=np.float64)
    return np.repeat(labels, [len(table) for table in scores.values()])


def _statistics(
    values: Numbers, clusters: NDArray[np.intp], draws: NDArray[np.intp], axes: Axes, ratio: bool
) -> tuple[float, float, float, int]:
    """Return the mean, the ends of its interval over units, and how many blocks have a number."""
    known = np.isfinite(values)
    count = int(known.sum())
    if not axes.blocks or not count:
        return float(values[known].mean()) if count else np.nan, np.nan, np.nan, count
    units = units_from(values[known][:, np.newaxis], clusters[known], draws[known])
    mean = float(units.typical(ratio)[0])
    if not units.count:
        return mean, np.nan, np.nan, count
    ends = [float(end[0]) for end in mean_interval(units.numbers(ratio), units.parts)]
    low, high = np.exp(ends) if ratio else ends
    return mean, float(low), float(high), count
