"""A marker set proposed from where markers are and how they move."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
from pydantic import Field

from nodegraph import Refusal, Unit, listed, node
from nodegraph_markers.mirror import (
    ALONE,
    FaceAxes,
    Mirror,
    face_axes,
    find_mirror,
    partners,
    side_by_name,
)
from nodegraph_markers.rigid import spacing
from nodegraph_markers.stillness import head_frame
from nodegraph_mocap import MarkerSet, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FEWEST = 4
_FLAT = 0.02
"""Extent of a shape in its thinnest direction, to that in its longest, to tell a left side."""
_LINE = 0.1
"""Extent across a line, to that along it, below which points count as on the line."""
_WIDEST = 2.5
"""Times the median circumradius: larger triangles only span the hollows of the outline."""
_STABLE_SHARE, _FEWEST_STABLE = 6, 3
_NEAR = 0.75
_POOR = 2 / 3
_SIDES, _STABLE, _EDGES = "pairs and midline", "stable landmarks", "edges"


class Inferred(NamedTuple):
    """A recording with a marker set, and the set by itself.

    Attributes
    ----------
    recording : Trajectories
        The samples unchanged, with the marker set.
    marker_set : MarkerSet
        The proposal.
    """

    recording: Trajectories
    marker_set: MarkerSet


class _Proposal(NamedTuple):
    """Numbers of markers, and messages to the user."""

    pairs: list[tuple[int, int]]
    midline: list[int]
    stable: list[int]
    edges: list[tuple[int, int]]
    messages: list[str]


@node("markers.infer", cite=("combes2008", "kabsch1976"))
def infer(
    recording: Trajectories,
    *,
    tolerance: Annotated[float, Field(gt=0), Unit("mm")] | None = None,
    keep: bool = False,
) -> Inferred:
    """Propose a marker set: pairs, midline, stable landmarks and edges, to be corrected by hand.

    The head's motion is taken out by the markers that move least, and each marker stands where
    its median is. The plane in which this shape mirrors itself best is found from many starts,
    in turns of partners by optimal assignment and the plane that suits them (as Combes et al.
    do for point clouds). Then:

    - pairs: markers that are each other's mirror image within the tolerance, by a matching that
      minimizes the distances as a whole; midline: those that are their own;
    - left and right: by the pair's names (``L_``, ``left``, ``Leyebrow``, ``Chin_L1``), else by
      most other pairs' names. If no name has a side, it is guessed, with a warning: the front
      is where the middle of the face stands out, up is where the face moves less (in a single
      frame, where it is wider);
    - stable: the sixth of the markers that moves least in the head's frame, three at least and
      not on a line; a pair as a whole; none from a single frame;
    - edges: a Delaunay triangulation as seen from the front, without its long thin triangles.

    A warning names the markers without a partner, and how well the face mirrors itself. The
    recording's own marker set is replaced unless `keep` is set. Save the proposal, correct it,
    and read it with the recording from then on.

    Looks at the whole take (600 frames of it, evenly spread, if there are more).

    Parameters
    ----------
    recording
        Trajectories, with or without gaps.
    tolerance
        How far a marker may be from the mirror image of its partner. None: three quarters of the
        median distance between neighbouring markers.
    keep
        Whether the parts of the recording's own marker set stay: pairs with the midline, stable
        landmarks, edges. Only empty parts are then proposed, with a warning that names them; a
        set without empty parts is returned as it is.

    Raises
    ------
    Refusal
        If fewer than four markers are ever present, or they lie on a line or a plane.
    """
    own = recording.marker_set if keep else None
    lacking = _lacking(own)
    if own and not lacking:
        return Inferred(recording, own)
    known = np.flatnonzero(recording.present.any(axis=0))
    if len(known) < _FEWEST:
        raise Refusal(f"needs {_FEWEST} markers that are ever present; there are {len(known)}")
    shape, motion = head_frame(recording)
    _check_solid(shape[known])
    names = [recording.markers[column] for column in known]
    proposal = _propose(shape[known], None if motion is None else motion[known], names, tolerance)
    unseen = len(recording.markers) - len(known)
    messages = [f"{unseen} markers are never present and in no part of the set"] if unseen else []
    messages += proposal.messages
    messages += [f"proposed, as the marker set lacks them: {', '.join(lacking)}"] if keep else []
    if messages:
        warnings.warn("; ".join(messages), stacklevel=2)
    marker_set = MarkerSet(
        markers=recording.markers,
        pairs=tuple((names[first], names[second]) for first, second in proposal.pairs),
        midline=tuple(names[marker] for marker in proposal.midline),
        stable=tuple(names[marker] for marker in proposal.stable),
        edges=tuple((names[first], names[second]) for first, second in proposal.edges),
    )
    if own:
        marker_set = _joined(own, marker_set, lacking)
    return Inferred(replace(recording, marker_set=marker_set), marker_set)


def _lacking(own: MarkerSet | None) -> list[str]:
    """Return the empty parts of a marker set."""
    parts = {
        _SIDES: own and (own.pairs or own.midline),
        _STABLE: own and own.stable,
        _EDGES: own and own.edges,
    }
    return [part for part, names in parts.items() if not names]


def _joined(own: MarkerSet, proposed: MarkerSet, lacking: list[str]) -> MarkerSet:
    sides = proposed if _SIDES in lacking else own
    return MarkerSet(
        markers=proposed.markers,
        pairs=sides.pairs,
        midline=sides.midline,
        stable=(proposed if _STABLE in lacking else own).stable,
        edges=(proposed if _EDGES in lacking else own).edges,
    )


def _check_solid(shape: NDArray[np.float64]) -> None:
    extents = np.linalg.svd(shape - shape.mean(axis=0), compute_uv=False)
    for number, what in ((1, "line"), (2, "plane")):
        if extents[number] <= _FLAT * extents[0]:
            raise Refusal(
                f"the {len(shape)} markers lie on a {what}, which has no left and right side; "
                "needs a face with depth"
            )


def _propose(
    shape: NDArray[np.float64],
    motion: NDArray[np.float64] | None,
    names: list[str],
    tolerance: float | None,
) -> _Proposal:
    width = _NEAR * spacing(shape) if tolerance is None else tolerance
    mirror = find_mirror(shape, width)
    partner = partners(shape, mirror, width)
    axes = face_axes(shape, mirror.normal, motion)
    numbers = np.arange(len(shape))
    couples = [
        (marker, int(partner[marker])) for marker in numbers.tolist() if marker < partner[marker]
    ]
    pairs, messages = _sided(couples, mirror, shape, axes, names)
    front = shape @ np.stack([mirror.normal, axes.up], axis=1)
    return _Proposal(
        pairs=pairs,
        midline=np.flatnonzero(partner == numbers).tolist(),
        stable=[] if motion is None else still_landmarks(shape, motion, partner),
        edges=edges_of(front),
        messages=[*_symmetry(shape, mirror, partner, names, width), *messages],
    )


def _sided(
    couples: list[tuple[int, int]],
    mirror: Mirror,
    shape: NDArray[np.float64],
    axes: FaceAxes,
    names: list[str],
) -> tuple[list[tuple[int, int]], list[str]]:
    """Return the couples with the left marker first, and messages to the user."""
    by_name = np.array(
        [side_by_name(names[first], names[second]) for first, second in couples], dtype=int
    )
    side = np.array(
        [mirror.signed(shape[first]) - mirror.signed(shape[second]) for first, second in couples]
    )
    vote = float(by_name @ np.sign(side))
    left = vote if vote else float(mirror.normal @ axes.left)
    by_place = np.where(side * left > 0, 1, -1)
    sign = np.where(by_name == 0, by_place, by_name)
    pairs = [
        pair if direction > 0 else pair[::-1] for pair, direction in zip(couples, sign, strict=True)
    ]
    messages = []
    if couples and not vote:
        messages.append(
            "the names do not distinguish left and right: they are guessed from shape and movement"
        )
    crossed = [names[left] for (left, _), bad in zip(pairs, sign != by_place, strict=True) if bad]
    if crossed:
        messages.append(
            f"{len(crossed)} pairs lie the other way round than named: {listed(crossed)}"
        )
    return pairs, messages


def _symmetry(
    shape: NDArray[np.float64],
    mirror: Mirror,
    partner: NDArray[np.intp],
    names: list[str],
    width: float,
) -> list[str]:
    alone = [names[marker] for marker in np.flatnonzero(partner == ALONE)]
    if not alone:
        return []
    residual = float(np.median(mirror.distances(shape).min(axis=1)))
    matched = len(names) - len(alone)
    poor = "symmetry is poor: " if matched < _POOR * len(names) else ""
    return [
        f"{poor}{len(alone)} of {len(names)} markers have no mirrored partner within {width:.1f} "
        f"mm: {listed(alone)}; in the best plane, half of the markers are within "
        f"{residual:.1f} mm of a mirror image"
    ]


def still_landmarks(
    shape: NDArray[np.float64], motion: NDArray[np.float64], partner: NDArray[np.intp]
) -> list[int]:
    """Return which markers move least: a sixth of them, three at least, not all on a line.

    A pair counts with the motion of the marker that moves more, and comes as a whole. While the
    landmarks lie on a line, the next one is added.

    Parameters
    ----------
    shape
        (N, 3) mm.
    motion
        (N,) mm.
    partner
        (N,), the number of each marker's partner, or -1.

    Returns
    -------
    list of int
        In rising order.
    """
    paired = np.where(partner < 0, np.arange(len(shape)), partner)
    together = np.maximum(motion, motion[paired])
    order = np.argsort(together, kind="stable")
    count = max(_FEWEST_STABLE, len(shape) // _STABLE_SHARE)
    while count < len(order) and (
        together[order[count]] == together[order[count - 1]] or _on_a_line(shape[order[:count]])
    ):
        count += 1
    return sorted(order[:count].tolist())


def _on_a_line(points: NDArray[np.float64]) -> bool:
    extents = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(extents[1] < _LINE * extents[0])


def edges_of(plane: NDArray[np.float64]) -> list[tuple[int, int]]:
    """Return which points the triangles of a Delaunay triangulation join.

    Triangles whose circumcircle is more than 2.5 times as wide as the median one are left out:
    long ones across the hollows of the outline, and thin ones along it.

    Parameters
    ----------
    plane
        (N, 2) mm, the markers as seen from the front, not all on a line.

    Returns
    -------
    list of (int, int)
        The lower number first, in rising order.
    """
    from scipy.spatial import Delaunay

    triangles = Delaunay(plane).simplices
    radius = _circumradius(plane[triangles])
    compact = triangles[radius <= _WIDEST * np.median(radius)]
    sides = np.sort(np.concatenate([compact[:, [0, 1]], compact[:, [1, 2]], compact[:, [0, 2]]]))
    return [(first, second) for first, second in np.unique(sides, axis=0).tolist()]


def _circumradius(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``a b c / (4 area)`` of triangles, (F, 3, 2)."""
    sides = corners - np.roll(corners, 1, axis=1)
    lengths = np.linalg.norm(sides, axis=2).prod(axis=1)
    twice = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
    return np.asarray(lengths / np.maximum(2.0 * twice, np.finfo(float).tiny))
