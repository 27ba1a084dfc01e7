"""The independent units behind a claim: actors, or parts of one recording."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from nodegraph import Value
from nodegraph_compare.inference import FEWEST, FEWEST_JUDGED, FEWEST_SETTLED
from nodegraph_compare.ties import tied

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_compare.blocks import Group

Kind = Literal["clusters", "draws", "segments", "nothing"]
Lacking = Literal["repetitions", "frames", "segments", "numbers"]
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
        ``repetitions``, where nothing tells when in the recording blocks are; ``frames`` of a
        recording; ``segments``, blocks so few that some of the `needed` segments have none;
        ``numbers``, where no block has a number for every method.
    there, needed : float
    """

    of: Lacking
    there: float = 0.0
    needed: float = 0.0


@dataclass(frozen=True)
class Units:
    """Means of K methods in N independent units, from blocks that have a number for all of them.

    Attributes
    ----------
    kind : str
        ``clusters``, three or more; of fewer recordings, ``draws``, repetitions on the same data,
        or ``segments`` in time; ``nothing`` where there is no such unit.
    recordings : (C, K) array of float64
        Means over the blocks of each cluster; for other kinds, of each recording.
    means : (N, K) array of float64
        Means over the blocks of each unit.
    without : (N, K) array of float64
        Means over all other blocks of its recording, where a unit is a part of one.
    place : (B,) array of int
        The unit of each block; -1 for a block that does not count.
    strata : (N,) array of int
        The recording of each unit.
    fewest : int
        Blocks in the unit with fewest.
    shortage : Shortage or None
        Why there are no units.
    """

    kind: Kind
    recordings: NDArray[np.float64]
    means: NDArray[np.float64]
    without: NDArray[np.float64]
    place: NDArray[np.intp]
    strata: NDArray[np.intp]
    fewest: int = 0
    shortage: Shortage | None = None

    @property
    def clusters(self) -> int:
        """Number of clusters; for other kinds, of recordings; 1 without any."""
        return len(self.recordings)

    @property
    def parts(self) -> NDArray[np.intp] | None:
        """The recording of each unit, where units are parts of several."""
        return self.strata if self.kind != "clusters" and self.clusters > 1 else None

    @property
    def count(self) -> int:
        """Number of units, less those that are spent on further recordings."""
        if self.kind == "nothing":
            return 0
        return len(self.means) - (0 if self.parts is None else self.clusters - 1)

    @property
    def placed(self) -> bool:
        """Whether it is known when in the recordings their blocks are."""
        return self.shortage is None or self.shortage.of in ("frames", "segments")

    @property
    def speech(self) -> Speech:
        """The kind of claim that so many units allow."""
        return speech_of(self.kind, self.count)

    @property
    def judged(self) -> bool:
        """Whether there are units enough for p and a verdict."""
        return self.speech in ("provisional", "settled")

    @property
    def positive(self) -> bool:
        """Whether every mean that a logarithm is taken of is above 0."""
        every = np.concatenate([self.recordings, self.without])
        return bool((every > 1e-9 * every.max(initial=0.0)).all())

    def typical(self, ratio: bool) -> NDArray[np.float64]:
        """Return (K,), the numbers of the methods, in which every cluster weighs the same.

        The geometric mean over clusters, which is the error of a typical one, or the arithmetic
        mean. They depend neither on the kind of unit nor on other methods.
        """
        # of a row each, so that its sum is the same to the last bit whatever else there is
        of_methods = np.ascontiguousarray(self.recordings.T)
        if self.clusters == 1 or not ratio:
            return np.asarray(of_methods.mean(axis=1))
        return np.asarray(np.exp(np.log(of_methods).mean(axis=1)))

    def numbers(self, ratio: bool) -> NDArray[np.float64]:
        """Return y, (N, K), whose differences are judged; its mean is that of `typical`.

        Of clusters, the logarithms of their means M, or M. Of B parts of a recording with mean M,
        which is M' without one of them, the jackknife's ``B ln M - (B - 1) ln M'``, moved so that
        its mean is ``ln M``.
        """
        scale = np.log if ratio else np.asarray
        if self.kind in ("clusters", "nothing"):
            return np.asarray(scale(self.means))
        whole, count = scale(self.recordings)[self.strata], len(self.means) // self.clusters
        y = count * whole - (count - 1) * scale(self.without)
        means = np.stack([y[self.strata == at].mean(axis=0) for at in range(self.clusters)])
        return np.asarray(y - means[self.strata] + whole)


def speech_of(kind: Kind, count: int) -> Speech:
    """Return what may be said: three or four units are described, five to seven provisional.

    Repetitions are drawn alike, and each is a mean over blocks: three have a verdict.
    """
    if count < FEWEST:
        return "nothing"
    if count < FEWEST_JUDGED and kind != "draws":
        return "described"
    return "provisional" if count < FEWEST_SETTLED else "settled"


def units_of(group: Group, values: NDArray[np.float64], kept: NDArray[np.bool_]) -> Units:
    """Return the units that a verdict rests on.

    Three clusters or more; of fewer, the repetitions on the same data if there are three, which
    stand for further ones; else the recordings' segments.

    Parameters
    ----------
    group
        Its blocks.
    values
        (B, K), the value of each block and method.
    kept
        (B,), the blocks that count; their values are not missing.
    """
    draw = group.draw[kept] if group.draws > 1 else np.zeros(np.count_nonzero(kept), dtype=np.intp)
    units = units_from(values[kept], group.cluster[kept], draw, _recordings(group)[kept])
    if units.kind == "nothing":
        return segments_of(group, values, kept)
    return _with_others(units, kept)


def _recordings(group: Group) -> NDArray[np.intp]:
    return group.cluster if group.recording is None else group.recording


def units_from(
    values: NDArray[np.float64],
    cluster: NDArray[np.intp],
    draw: NDArray[np.intp],
    recording: NDArray[np.intp] | None = None,
) -> Units:
    """Return the units of blocks that all count: their clusters, or the repetitions on these.

    Parameters
    ----------
    values
        (B, K), the value of each block and method.
    cluster, draw
        (B,), the cluster and the repetition of each block.
    recording
        (B,), the recording of each block, of which there may be several in a cluster.
    """
    names, cluster = np.unique(cluster, return_inverse=True)
    if len(names) > MOST_RECORDINGS:
        return _placed(values, cluster, cluster, "clusters")
    # of one or two actors: their recordings, as nothing can be said of further actors
    if recording is not None:
        names, cluster = np.unique(recording, return_inverse=True)
    numbers = np.unique(cluster + len(names) * draw)
    # as many of each recording, so that recordings weigh equally
    count = int(np.bincount(numbers % max(len(names), 1)).min(initial=len(numbers)))
    if count < FEWEST:
        return _nothing(values, cluster, Shortage("repetitions", count, FEWEST))
    ranks = np.zeros(len(draw), dtype=np.intp)
    for at in range(len(names)):
        member = cluster == at
        ranks[member] = np.unique(draw[member], return_inverse=True)[1]
    return _placed(values, cluster, cluster * count + ranks % count, "draws")


def segments_of(group: Group, values: NDArray[np.float64], kept: NDArray[np.bool_]) -> Units:
    """Return equal parts of each recording, long against the time over which it is correlated.

    How many parts a recording can bear is a matter of its length T, the time tau over which it is
    correlated, and the length g of the blocks, not of where these are: with ``Lc = g + 2 tau`` ten
    where ``T >= 100 Lc``, six where ``T >= 36 Lc``, else none.

    Parameters
    ----------
    group, values, kept
        As of `units_of`.
    """
    names, cluster = np.unique(_recordings(group)[kept], return_inverse=True)
    start, frames = group.start[kept], group.frames[kept]
    span, time = group.span[kept], group.correlation[kept]
    values, count = values[kept], len(names)

    def nothing(of: Lacking, there: float = 0.0, needed: float = 0.0) -> Units:
        return _with_others(_nothing(values, cluster, Shortage(of, there, needed)), kept)

    if not len(values):
        return nothing("numbers")
    if not np.isfinite(start + frames + span + time).all():
        draws = len(np.unique(group.draw[kept])) if group.draws > 1 else 1
        return nothing("repetitions", draws, FEWEST)
    length = float(np.median(frames)) + 2 * time
    shortest = int(np.argmin(span / length))
    there = float(span[shortest] / length[shortest])
    for parts, least in _SEGMENTS:
        place = np.minimum(parts * (start + frames / 2) / span, parts - 1).astype(np.intp)
        place += parts * cluster
        if there >= least and len(np.unique(place)) == parts * count:
            return _with_others(_placed(values, cluster, place, "segments"), kept)
    parts, least = _SEGMENTS[-1]
    if there < least:
        return nothing("frames", float(span[shortest]), least * float(length[shortest]))
    return nothing("segments", len(values), parts * count)


def _nothing(values: NDArray[np.float64], cluster: NDArray[np.intp], shortage: Shortage) -> Units:
    """Return no units, with the means of the recordings."""
    return replace(_placed(values, cluster, cluster, "nothing"), shortage=shortage)


def _with_others(units: Units, kept: NDArray[np.bool_]) -> Units:
    """Return units with a place for the blocks that do not count."""
    place = np.full(len(kept), -1, dtype=np.intp)
    place[kept] = units.place
    return replace(units, place=place)


def _placed(
    values: NDArray[np.float64], cluster: NDArray[np.intp], place: NDArray[np.intp], kind: Kind
) -> Units:
    """Return units from the cluster and the unit of each block."""
    sums, blocks = _sums(values, cluster)
    count = len(blocks)
    recordings = sums / blocks[:, np.newaxis]
    if kind in ("clusters", "nothing"):
        recordings = tied(recordings)
        fewest = int(blocks.min()) if count else 0
        none = recordings[:0]
        return Units(kind, recordings, recordings, none, place, np.arange(count), fewest)
    of_units, counts = _sums(values, place)
    strata = np.zeros(len(counts), dtype=np.intp)
    strata[place] = cluster
    rest = (blocks[strata] - counts)[:, np.newaxis]
    means, without = of_units / counts[:, np.newaxis], (sums[strata] - of_units) / rest
    every = tied(np.concatenate([recordings, means, without]))
    recordings, means, without = np.split(every, [count, count + len(counts)])
    return Units(kind, recordings, means, without, place, strata, int(counts.min()))


def _sums(
    values: NDArray[np.float64], place: NDArray[np.intp]
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return the (N, K) sums of the blocks at each place, and (N,) how many there are."""
    blocks = np.bincount(place)
    sums = np.zeros((len(blocks), values.shape[1]))
    np.add.at(sums, place, values)
    return sums, blocks
