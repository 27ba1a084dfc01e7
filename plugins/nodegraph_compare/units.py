"""The independent units behind a claim: actors, or parts of one recording."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from nodegraph import Value
from nodegraph_compare.inference import FEWEST, FEWEST_JUDGED, FEWEST_SETTLED
from nodegraph_compare.ties import ROUNDING, tied

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_compare.blocks import Group

Kind = Literal["clusters", "segments", "runs", "draws", "nothing"]
Speech = Literal["nothing", "described", "provisional", "settled"]

MOST_RECORDINGS = 2
"""Number of clusters up to which a claim is about them alone."""

_SEGMENTS = ((10, 100), (6, 36))
"""Numbers of segments, each with how many correlation lengths the recording must have."""


@dataclass(frozen=True)
class Shortage(Value):
    """A shortage for every unit: so much there is, where so much is needed.

    Attributes
    ----------
    of : str
        ``repetitions``; ``frames`` or ``blocks`` that follow one another; ``segments``, blocks so
        few that some of the `needed` segments have none; ``numbers``, where no block has a number
        for every method.
    there, needed : float
    """

    of: Literal["repetitions", "frames", "blocks", "segments", "numbers"]
    there: float = 0.0
    needed: float = 0.0


@dataclass(frozen=True)
class Units:
    """Means of K methods in N independent units, from blocks that have a number for all of them.

    Attributes
    ----------
    kind : str
        ``clusters``, three or more; of fewer recordings, ``segments`` in time, ``draws``,
        repetitions on the same data, or ``runs`` of blocks in their order where they have no
        place in time; ``nothing`` where there is no such unit.
    clusters : int
        Number of clusters; for other kinds, of recordings; 1 without any.
    means : (N, K) array of float64
        Over the blocks of each unit; of the kind ``nothing``, of each cluster.
    place : (B,) array of int
        The unit of each block; -1 for a block that does not count.
    strata : (N,) array of int or None
        The recording of each segment or draw, where there are several.
    fewest : int
        Blocks in the unit with fewest.
    shortage : Shortage or None
        Why there are no units.
    """

    kind: Kind
    clusters: int
    means: NDArray[np.float64]
    place: NDArray[np.intp]
    strata: NDArray[np.intp] | None = None
    fewest: int = 0
    shortage: Shortage | None = None

    @property
    def count(self) -> int:
        """Number of units, less those that are spent on further recordings."""
        if self.kind == "nothing":
            return 0
        spent = 0 if self.strata is None else len(np.unique(self.strata)) - 1
        return len(self.means) - spent

    @property
    def speech(self) -> Speech:
        """The kind of claim that so many units allow."""
        return speech_of(self.count)

    @property
    def judged(self) -> bool:
        """Whether there are units enough for p and a verdict."""
        return self.speech in ("provisional", "settled")

    def numbers(self, ratio: bool) -> NDArray[np.float64]:
        """Return y, (N, K), whose differences are judged: of logarithms, or of the means.

        Of clusters, the logarithms of their means M. Of parts of a recording, whose mean M over
        all of them is what counts, ``ln M + x / M - 1`` with x the mean of a part: the mean of y
        is ``ln M``, and a single part may be 0.
        """
        if not ratio:
            return self.means
        if self.kind == "clusters":
            return np.log(self.means)
        mean = self.means.mean(axis=0)
        return np.asarray(np.log(mean) + self.means / mean - 1)


def speech_of(count: int) -> Speech:
    """Return what may be said: three or four units are described, five to seven provisional."""
    if count < FEWEST:
        return "nothing"
    if count < FEWEST_JUDGED:
        return "described"
    return "provisional" if count < FEWEST_SETTLED else "settled"


def units_of(group: Group, values: NDArray[np.float64], kept: NDArray[np.bool_]) -> Units:
    """Return the units of a group.

    Parameters
    ----------
    group
        Its blocks.
    values
        (B, K), the value of each block and method.
    kept
        (B,), the blocks that count; their values are not missing.
    """
    units = _of_kept(group, values[kept], kept)
    place = np.full(len(kept), -1, dtype=np.intp)
    place[kept] = units.place
    return replace(units, place=place)


def _of_kept(group: Group, values: NDArray[np.float64], kept: NDArray[np.bool_]) -> Units:
    """Return the units of the blocks that count, with the place of each of these."""
    names, cluster = np.unique(group.cluster[kept], return_inverse=True)
    count = len(names)
    if count > MOST_RECORDINGS:
        means, blocks = _means(values, cluster, count)
        return Units("clusters", count, means, cluster, fewest=int(blocks.min()))
    # of one or two actors: their recordings, as nothing can be said of further actors
    if group.recording is not None:
        names, cluster = np.unique(group.recording[kept], return_inverse=True)
        count = len(names)
    overall, _ = _means(values, cluster, count)
    start, frames, draw = group.start[kept], group.frames[kept], group.draw[kept]
    if np.isfinite(start).all() and len(start):
        return _segments(values, cluster, start, frames, overall, "frames")
    if group.draws > 1:
        return _draws(values, cluster, draw, overall)
    order = np.arange(len(values), dtype=np.float64)
    units = _segments(values, cluster, order, np.ones(len(values)), overall, "blocks")
    return replace(units, kind="runs") if units.kind == "segments" else units


def _draws(
    values: NDArray[np.float64],
    cluster: NDArray[np.intp],
    draw: NDArray[np.intp],
    overall: NDArray[np.float64],
) -> Units:
    """Return each repetition as a unit."""
    count = len(overall)
    numbers, place = np.unique(cluster + count * draw, return_inverse=True)
    strata = numbers % count
    fewest = int(np.bincount(strata, minlength=count).min(initial=len(numbers)))
    if fewest < FEWEST:
        shortage = Shortage("repetitions", fewest, FEWEST)
        return Units("nothing", count, overall, cluster, shortage=shortage)
    # equally many of each recording, so that recordings weigh equally
    kept = np.concatenate([np.flatnonzero(strata == at)[:fewest] for at in range(count)])
    means, blocks = _means(values, place, len(numbers))
    several = strata[kept] if count > 1 else None
    unit = np.full(len(numbers), -1, dtype=np.intp)
    unit[kept] = np.arange(len(kept))
    return Units("draws", count, means[kept], unit[place], several, int(blocks.min()))


def _segments(
    values: NDArray[np.float64],
    cluster: NDArray[np.intp],
    start: NDArray[np.float64],
    frames: NDArray[np.float64],
    overall: NDArray[np.float64],
    unit: Literal["frames", "blocks"],
) -> Units:
    """Return equal parts of each recording, long against the time over which errors correlate."""
    count = len(overall)
    members = [cluster == at for at in range(count)]
    spans = [
        (float(start[member].min()), float((start + frames)[member].max())) for member in members
    ]
    lengths = [
        correlation_length(values[member], start[member], frames[member]) for member in members
    ]
    relative = [
        (last - first) / length for (first, last), length in zip(spans, lengths, strict=True)
    ]
    shortest = int(np.argmin(relative)) if relative else 0
    for parts, needed in _SEGMENTS:
        if not relative or relative[shortest] < needed:
            continue
        place = np.empty(len(values), dtype=np.intp)
        for at, (member, (first, last)) in enumerate(zip(members, spans, strict=True)):
            middle = (start[member] + frames[member] / 2 - first) / (last - first)
            place[member] = parts * at + np.minimum((parts * middle).astype(np.intp), parts - 1)
        if len(np.unique(place)) == parts * count:
            means, blocks = _means(values, place, parts * count)
            strata = np.repeat(np.arange(count), parts) if count > 1 else None
            return Units("segments", count, means, place, strata, int(blocks.min()))
    parts, needed = _SEGMENTS[-1]
    if not relative:
        shortage = Shortage("numbers")
    elif relative[shortest] < needed:
        first, last = spans[shortest]
        shortage = Shortage(unit, last - first, needed * lengths[shortest])
    else:
        shortage = Shortage("segments", len(values), parts * count)
    return Units("nothing", count, overall, cluster, shortage=shortage)


def correlation_length(
    values: NDArray[np.float64], start: NDArray[np.float64], frames: NDArray[np.float64]
) -> float:
    """Return the number of frames over which the scores of one recording are correlated.

    Twice the integral of the autocorrelation over time: of gaps of length g in a process with
    correlation time tau, about g + 2 tau. What all methods share in a block is removed first. The
    correlation is that of pairs of blocks in bins of g frames, from those in one bin up to the
    first lag without any.

    Parameters
    ----------
    values
        (B, K), the value of each block and method.
    start, frames
        (B,), when each block begins, and how long it is.
    """
    length = float(np.median(frames))
    typical = np.abs(values).mean(axis=0)
    apart = values / np.where(typical > 0.0, typical, 1.0)
    if values.shape[1] > 1:
        apart = apart - apart.mean(axis=1, keepdims=True)
    apart = apart - apart.mean(axis=0)
    bins = ((start - start.min()) // length).astype(np.intp)
    size = int(bins.max()) + 1
    count = np.bincount(bins, minlength=size).astype(np.float64)
    sums = np.zeros((size, values.shape[1]))
    np.add.at(sums, bins, apart)
    squares = float(np.square(apart).sum())
    pairs = float((np.square(count) - count).sum())
    together = (float(np.square(sums).sum()) - squares) / pairs if pairs else squares / len(values)
    if together <= ROUNDING * squares / len(values):
        return length
    total = 0.0
    for lag in range(1, size // 2):
        both = float((count[:-lag] * count[lag:]).sum())
        product = float((sums[:-lag] * sums[lag:]).sum())
        if both == 0.0:
            continue
        if product <= 0.0:
            break
        total += min(product / both / together, 1.0)
    return length * (1 + 2 * total)


def _means(
    values: NDArray[np.float64], place: NDArray[np.intp], count: int
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return the (N, K) means of the blocks of each unit, and (N,) how many blocks it has."""
    blocks = np.bincount(place, minlength=count)
    sums = np.zeros((count, values.shape[1]))
    np.add.at(sums, place, values)
    return tied(sums / blocks[:, np.newaxis]), blocks
