"""From gathered tables to curves: the points of each compared label, by their place along x."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from nodegraph_compare.actors import label_at
from nodegraph_compare.blocks import label_order
from nodegraph_compare.inference import mean_interval
from nodegraph_compare.ties import tied
from nodegraph_compare.units import MOST_RECORDINGS, units_from

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from nodegraph import Across, Label
    from nodegraph_mocap import Table

    Numbers = NDArray[np.float64]


T = TypeVar("T", bound="Hashable")


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
        Repeats, and the independent units that they are in.
    others : tuple of str
        Gathered axes that are none of these.
    lowest : bool
        Whether the points of the `others` at one x stay apart, and the curve takes the lowest.
    labels : tuple of labels
        Every label that the graph has on the compared axis.
    """

    x: str
    metric: str
    compare: str | None
    blocks: tuple[str, ...]
    clusters: tuple[str, ...]
    others: tuple[str, ...]
    lowest: bool
    labels: tuple[Label, ...] = ()


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


@dataclass(frozen=True)
class _Rows:
    """The rows of all tables: what they belong to, and their numbers."""

    labels: Sequence[Label]
    others: Sequence[tuple[Label, ...]]
    blocks: Sequence[Hashable]
    clusters: NDArray[np.intp]
    draws: NDArray[np.intp]
    x: NDArray[np.float64]
    value: NDArray[np.float64]

    @property
    def ratio(self) -> bool:
        """Whether every number is above 0, so that means over clusters are geometric."""
        return bool((self.value[np.isfinite(self.value)] > 0.0).all())


def points(scores: Across[Table], axes: Axes, fallback: Label | None = None) -> tuple[Points, ...]:
    """Return the points of every compared label, in the order of the labels.

    Parameters
    ----------
    scores
        The gathered tables.
    axes
        Which axis or column is what.
    fallback
        The label whose value stands where another one with a curve has none in a block.
    """
    rows = _rows(scores, axes)
    taken: dict[Label, int] = {}
    if fallback is not None:
        rows, taken = _filled(rows, fallback)
    labels = compared_in(scores, axes)
    of = _places(rows.labels)
    return tuple(
        replace(_points(rows, of.get(label, []), label, axes), taken=taken.get(label, 0))
        for label in labels
    )


def compared_in(scores: Across[Table], axes: Axes) -> tuple[Label, ...]:
    """Return the compared labels in order; an empty one where nothing is compared."""
    if axes.compare is not None and axes.compare in scores.axes:
        return label_order(scores, axes.compare)
    return tuple(dict.fromkeys(_gathered(scores, axes.compare)))


def floors(floor: Across[Table], axes: Axes) -> dict[Label, float]:
    """Return the mean of the metric over each label's rows; of all, if nothing distinguishes them.

    The one number of rows that have no compared label stands under an empty label.
    """
    known = axes.compare in floor.axes or any(axes.compare in table for table in floor.values())
    labels = _gathered(floor, axes.compare if known else None)
    value = _numbers(floor, axes.metric)
    means: dict[Label, float] = {}
    for label, places in _places(labels).items():
        finite = value[places][np.isfinite(value[places])]
        means |= {label: float(finite.mean())} if len(finite) else {}
    return means


def _rows(scores: Across[Table], axes: Axes) -> _Rows:
    count = sum(len(table) for table in scores.values())
    identity = tuple(dict.fromkeys((*axes.blocks, *axes.clusters)))
    blocks = _together(scores, identity) if axes.blocks else range(count)
    others = _together(scores, axes.others) if axes.lowest else [()] * count
    units = unit_names(scores, axes)
    drawn = () if units == axes.clusters else units
    return _Rows(
        labels=_gathered(scores, axes.compare),
        others=others,
        blocks=blocks,
        clusters=_numbered(_together(scores, axes.clusters)),
        draws=_numbered(_together(scores, drawn)),
        x=_numbers(scores, axes.x),
        value=_numbers(scores, axes.metric),
    )


def _filled(rows: _Rows, fallback: Label) -> tuple[_Rows, dict[Label, int]]:
    """Return rows in which blocks without a number have the fallback's, and their counts."""
    keys = list(zip(rows.x.tolist(), rows.others, rows.blocks, strict=True))
    of, value = _places(zip(rows.labels, keys, strict=True)), rows.value.copy()
    known = {
        key: (places[0], float(rows.value[places].mean()))
        for (label, key), places in of.items()
        if label == fallback and np.isfinite(rows.value[places]).all()
    }
    added: list[tuple[Label, int, float]] = []
    taken: dict[Label, int] = {}
    finite = np.isfinite(rows.value)
    for label in dict.fromkeys(each for each, has in zip(rows.labels, finite, strict=True) if has):
        for key, (place, instead) in known.items():
            own = of.get((label, key), [])
            if finite[own].all() and own:
                continue
            taken[label] = taken.get(label, 0) + 1
            value[own] = instead
            if not own:
                added.append((label, place, instead))
    places = [*range(len(keys)), *(place for _, place, _ in added)]
    filled = _Rows(
        labels=[*rows.labels, *(label for label, _, _ in added)],
        others=[rows.others[place] for place in places],
        blocks=[rows.blocks[place] for place in places],
        clusters=rows.clusters[places],
        draws=rows.draws[places],
        x=rows.x[places],
        value=np.concatenate([value, [instead for _, _, instead in added]]),
    )
    return filled, taken


def unit_names(scores: Across[Table], axes: Axes) -> tuple[str, ...]:
    """Return what distinguishes independent units: clusters, or repetitions of few of them.

    Blocks of one recording that are not repetitions are not independent; they are one unit.
    """
    if len(set(_together(scores, axes.clusters))) > MOST_RECORDINGS:
        return axes.clusters
    return tuple(name for name in axes.blocks if name in scores.axes and name not in axes.clusters)


def _together(scores: Across[Table], names: tuple[str, ...]) -> list[tuple[Label, ...]]:
    """Return the labels of all rows in several axes or columns."""
    parts = [_gathered(scores, name) for name in names]
    return list(zip(*parts, strict=True)) if parts else [()] * len(_gathered(scores, None))


def _gathered(scores: Across[Table], name: str | None) -> list[Label]:
    """Return the label of all rows in an axis, or column; nothing where there is no name."""
    gathered: list[Label] = []
    for labels, table in scores:
        if name is None or name in scores.axes or name in scores.fields:
            gathered += [label_at(scores, name, labels) if name else ""] * len(table)
        else:
            column = table[name]
            gathered += column.where(column.notna(), "missing").tolist()
    return gathered


def _numbers(scores: Across[Table], name: str) -> NDArray[np.float64]:
    """Return finite numbers of all rows, else NaN."""
    parts = [
        np.full(len(table), labels.get(name, np.nan), dtype=np.float64)
        if name in scores.axes
        else table[name].to_numpy(dtype=np.float64)
        for labels, table in scores
    ]
    numbers = np.concatenate([*parts, np.empty(0)])
    return np.where(np.isfinite(numbers), numbers, np.nan)


def _places(keys: Iterable[T]) -> dict[T, list[int]]:
    """Return the places of each key, in the order in which the keys first come."""
    places: dict[T, list[int]] = {}
    for place, key in enumerate(keys):
        places.setdefault(key, []).append(place)
    return places


def _numbered(keys: Sequence[Hashable]) -> NDArray[np.intp]:
    """Return the place of each key among those that differ."""
    place = {key: at for at, key in enumerate(dict.fromkeys(keys))}
    return np.array([place[key] for key in keys], dtype=np.intp)


def _points(rows: _Rows, places: Sequence[int], label: Label, axes: Axes) -> Points:
    placed = [place for place in places if np.isfinite(rows.x[place])]
    apart = axes.lowest and not axes.blocks
    cells = _places(
        (rows.x[place], rows.others[place], place if apart else None) for place in placed
    )
    blocks = [_blocks(rows, [placed[row] for row in cell]) for cell in cells.values()]
    statistics = [_statistics(*block, axes, rows.ratio) for block in blocks]
    numbers = np.array([(x, *row) for (x, _, _), row in zip(cells, statistics, strict=True)])
    numbers = numbers.reshape(-1, 5)
    numbers[:, 1] = tied(numbers[:, 1])
    order = np.lexsort((numbers[:, 1], numbers[:, 0]))
    keys = list(cells)
    x, value, low, high, count = numbers[order].T
    return Points(
        label,
        tuple(dict(zip(axes.others, keys[place][1], strict=False)) for place in order),
        x,
        value,
        low,
        high,
        count.astype(np.intp),
        without_x=len(places) - len(placed),
        without_value=sum(int(np.isnan(values).sum()) for values, _, _ in blocks),
    )


def _blocks(rows: _Rows, places: list[int]) -> tuple[Numbers, NDArray[np.intp], NDArray[np.intp]]:
    """Return the mean of the rows of each block, NaN where one has none, its cluster and draw."""
    value = rows.value[places]
    blocks = list(_places(rows.blocks[place] for place in places).values())
    first = [places[block[0]] for block in blocks]
    means = np.array([value[block].mean() for block in blocks])
    return means, rows.clusters[first], rows.draws[first]


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
