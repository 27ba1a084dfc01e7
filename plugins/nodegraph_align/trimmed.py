"""Procrustes alignment by the landmarks that fit best (least trimmed squares)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import node
from nodegraph_align.faces import Faces
from nodegraph_align.fitting import Fitting
from nodegraph_align.landmarks import FEWEST
from nodegraph_align.poses import Aligned, Transforms, warn
from nodegraph_align.reference import reference_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

_STARTS = 60
_FIRST, _ROUNDS = 2, 50
"""Fits from each start, and from the best of them at most."""


@node(
    "align.trimmed",
    cite=("rousseeuw_vandriessen2006", "verboon_heiser1992"),
    lookahead=0,
    shares=Faces,
)
def trimmed(
    faces: Faces,
    *,
    share: Annotated[float, Field(gt=0, le=1)] = 0.75,
) -> Aligned:
    """Align each frame to a reference by those landmarks that fit best, without the others.

    Landmarks that are called stable do move, and a wrong label puts one anywhere. Of a frame's n
    landmarks the ``h = ceil(share n)`` (three at least) with the smallest distances from their
    places count, such that the sum of their squares is as small as possible (least trimmed
    squares). The search is that of Rousseeuw & Van Driessen: fit, keep the h that are nearest,
    fitted again, which never increases the sum; from all landmarks and from 60 triples of them
    spread evenly over all triples, twice each, and on from the best until nothing changes. Each
    frame by itself: where the choice changes from one frame to the next, the pose can jump by as
    much as the landmarks disagree; align.huber changes smoothly.

    Missing landmarks, the reference and what is refused are as in align.procrustes. Looks ahead
    no frame.

    Parameters
    ----------
    share
        The share of the landmarks that counts; 1 is align.procrustes.
    """
    if not 0 < share <= 1:
        raise ValueError(f"share must be above 0 and at most 1, got {share}")
    recording = faces.recording
    target, notes = reference_of(recording, faces.reference, faces.landmarks)
    fitting = Fitting.of(recording, target, faces.scale)
    poses = _nearest(fitting, share)
    warn(poses, recording, target, notes, stacklevel=4)
    return Aligned(*poses.move(recording), target.frame)


def _nearest(fitting: Fitting, share: float) -> Transforms:
    """Return the poses by the landmarks that fit best."""
    count = np.maximum(np.ceil(share * fitting.there.sum(axis=1) - 1e-9), FEWEST)
    best = _concentrated(fitting, fitting.fit(), count, _FIRST)
    least = _sums(fitting, best, count)
    for weights in _triples(fitting):
        poses = _concentrated(fitting, fitting.fit(weights), count, _FIRST)
        sums = _sums(fitting, poses, count)
        better = np.flatnonzero(sums < least)
        best.put(better, poses.some(better))
        least[better] = sums[better]
    return _concentrated(fitting, best, count, _ROUNDS)


def _concentrated(
    fitting: Fitting, poses: Transforms, count: NDArray[np.float64], rounds: int
) -> Transforms:
    """Return poses fitted again and again to the landmarks that are nearest in the last."""
    weights = np.zeros_like(fitting.there, dtype=np.float64)
    active = np.flatnonzero(poses.known)
    for _ in range(rounds):
        apart = fitting.some(active).distances(poses.some(active))
        nearest = np.arange(apart.shape[1]) < count[active, None]
        wanted = np.empty_like(apart)
        np.put_along_axis(wanted, apart.argsort(axis=1, kind="stable"), nearest, axis=1)
        wanted[~np.isfinite(apart)] = 0.0
        changed = np.any(wanted != weights[active], axis=1)
        active = active[changed]
        if not len(active):
            break
        weights[active] = wanted[changed]
        again = fitting.some(active).fit(weights[active])
        # landmarks that are nearest may lie on a line: the pose before stands
        active, again = active[again.known], again.some(again.known)
        poses.put(active, again)
    return poses


def _sums(fitting: Fitting, poses: Transforms, count: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the sum of the smallest squared distances, (T,) mm^2; infinite without a pose."""
    squared = np.sort(fitting.distances(poses), axis=1) ** 2
    nearest = np.arange(squared.shape[1]) < count[:, None]
    sums = np.where(nearest, squared, 0.0).sum(axis=1)
    return np.asarray(np.where(poses.known, sums, np.inf))


def _triples(fitting: Fitting) -> Iterator[NDArray[np.float64]]:
    """Yield weights, (T, L), of three landmarks at a time."""
    there = fitting.there
    last = math.comb(there.shape[1], FEWEST) - 1
    for rank in np.unique(np.linspace(0, last, _STARTS).round().astype(np.int64)):
        weights = np.zeros(there.shape)
        weights[:, _triple(int(rank))] = 1.0
        yield weights


def _triple(rank: int) -> list[int]:
    """Return the triple of that rank, the first being 0, 1, 2 (combinatorial number system)."""
    members = []
    for size in range(FEWEST, 0, -1):
        member = size - 1
        while math.comb(member + 1, size) <= rank:
            member += 1
        rank -= math.comb(member, size)
        members.append(member)
    return members
