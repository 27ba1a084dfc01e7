"""Places of markers, a facial layout of 60 thinned or made denser, and the edges between them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap import MarkerSet
from nodegraph_mocap.spread import far_from
from nodegraph_synthesize.surface import HALF_COLUMNS

if TYPE_CHECKING:
    from numpy.typing import NDArray

_LONGEST_EDGE = 2.5
"""Times the median length: longer lines only span the hollows of the outline."""

FEWEST, MOST = 10, 150


@dataclass(frozen=True)
class Spot:
    """A place for one marker on the midline, or for a pair of markers.

    Attributes
    ----------
    region : str
    place : (u, v)
        On the average face, mm; for a pair that of the left one, u > 0.
    stable : bool
        Whether the muscles hardly move it.
    """

    region: str
    place: tuple[float, float]
    stable: bool = False


MIDLINE = (
    # The first are kept the longest when markers are few.
    Spot("nose", (0.0, 30.0), stable=True),
    Spot("jaw", (0.0, -74.0)),
    Spot("forehead", (0.0, 88.0), stable=True),
    Spot("mouth", (0.0, -44.0)),
    Spot("mouth", (0.0, -29.0)),
    Spot("nose", (0.0, -2.0), stable=True),
    Spot("forehead", (0.0, 64.0)),
    Spot("nose", (0.0, 13.0), stable=True),
)
PAIRS = (
    # The first two are always kept, the others by how well they spread.
    Spot("mouth", (27.0, -36.0)),
    Spot("temple", (66.0, 40.0), stable=True),
    Spot("brow", (10.0, 45.0)),
    Spot("brow", (22.0, 48.0)),
    Spot("brow", (35.0, 50.0)),
    Spot("brow", (48.0, 47.0)),
    Spot("eyelid", (26.0, 34.0)),
    Spot("eyelid", (37.0, 34.0)),
    Spot("eyelid", (31.0, 17.0)),
    Spot("eyelid", (49.0, 26.0)),
    Spot("nose", (10.0, 13.0)),
    Spot("nose", (14.0, -5.0)),
    Spot("cheek", (24.0, 3.0)),
    Spot("cheek", (45.0, 5.0)),
    Spot("cheek", (27.0, -16.0)),
    Spot("cheek", (42.0, -15.0)),
    Spot("cheek", (60.0, -18.0)),
    Spot("mouth", (10.0, -28.5)),
    Spot("mouth", (19.0, -31.5)),
    Spot("mouth", (13.0, -43.5)),
    Spot("jaw", (14.0, -59.0)),
    Spot("jaw", (32.0, -58.0)),
    Spot("jaw", (50.0, -47.0)),
    Spot("jaw", (21.0, -80.0)),
    Spot("forehead", (28.0, 84.0), stable=True),
    Spot("forehead", (52.0, 68.0), stable=True),
)

_USUAL = len(MIDLINE) + 2 * len(PAIRS)


@dataclass(frozen=True)
class MarkerLayout:
    """Markers and the vertex that each sits on.

    Attributes
    ----------
    marker_set : MarkerSet
        Without edges.
    vertices : (M,) array
    """

    marker_set: MarkerSet
    vertices: NDArray[np.int64]


def make_layout(count: int, places: NDArray[np.float64]) -> MarkerLayout:
    """Return `count` markers on vertices of a surface: pairs, and some on the midline.

    Fewer than 60 are a part of the usual 60, under the same names; more are those 60 and others
    in the widest spaces between them.

    Parameters
    ----------
    count
        From 10 to 150.
    places
        (V, 2) places of the surface's vertices on the average face.

    Raises
    ------
    ValueError
        If `count` is out of these bounds.
    """
    if not FEWEST <= count <= MOST:
        raise ValueError(f"markers: a face has {FEWEST} to {MOST} of them here, got {count}")
    midline, pairs = _thinned(count) if count <= _USUAL else _denser(count, places)
    return _named(midline, pairs, places)


def _thinned(count: int) -> tuple[list[Spot], list[Spot]]:
    odd = count % 2
    on_midline = odd + 2 * round((len(MIDLINE) * count / _USUAL - odd) / 2)
    places = np.array([spot.place for spot in PAIRS])
    taken = np.array([spot.place for spot in MIDLINE[:on_midline]] + [*places[:2].tolist()])
    spread = far_from(places, taken, (count - on_midline) // 2 - 2)
    numbers = sorted({0, 1, *spread})
    return list(MIDLINE[:on_midline]), [PAIRS[index] for index in numbers]


def _denser(count: int, places: NDArray[np.float64]) -> tuple[list[Spot], list[Spot]]:
    usual = np.array([spot.place for spot in (*MIDLINE, *PAIRS)])
    on_midline, on_left = _free(places)
    more = on_midline[far_from(on_midline, usual, count % 2)]
    taken = np.concatenate([usual, more, usual[len(MIDLINE) :] * [-1.0, 1.0]])
    left = on_left[far_from(on_left, taken, (count - _USUAL) // 2)]
    return [*MIDLINE, *_like_nearest(more)], [*PAIRS, *_like_nearest(left)]


def _free(places: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return places on the midline and on the left half, away from the rim and each other."""
    columns = 2 * HALF_COLUMNS + 1
    grid = places.reshape(-1, columns, 2)[2:-2]
    left = grid[:, HALF_COLUMNS + 2 : -2].reshape(-1, 2)
    return grid[:, HALF_COLUMNS], left[left[:, 0] > 4.0]


def _like_nearest(places: NDArray[np.float64]) -> list[Spot]:
    usual = (*MIDLINE, *PAIRS)
    known = np.array([spot.place for spot in usual])
    nearest = np.linalg.norm(places[:, None] - known[None], axis=2).argmin(axis=1)
    return [
        Spot(usual[index].region, (float(u), float(v)))
        for index, (u, v) in zip(nearest, places, strict=True)
    ]


def _named(midline: list[Spot], pairs: list[Spot], places: NDArray[np.float64]) -> MarkerLayout:
    middle = [f"M_{name}" for name in _numbered(midline, MIDLINE)]
    left, right = ([f"{side}_{name}" for name in _numbered(pairs, PAIRS)] for side in "LR")
    stable = [name for name, spot in zip(middle, midline, strict=True) if spot.stable]
    for left_name, right_name, spot in zip(left, right, pairs, strict=True):
        stable += [left_name, right_name] if spot.stable else []
    names = (*middle, *(name for pair in zip(left, right, strict=True) for name in pair))
    marker_set = MarkerSet(
        markers=names,
        pairs=tuple(zip(left, right, strict=True)),
        midline=tuple(middle),
        stable=tuple(stable),
    )
    return MarkerLayout(marker_set, _vertices(midline, pairs, places))


def _numbered(spots: list[Spot], usual: tuple[Spot, ...]) -> list[str]:
    """Return names like ``brow1``; a usual spot has the same number in every layout."""
    names: dict[Spot, str] = {}
    used: Counter[str] = Counter()
    for spot in dict.fromkeys((*usual, *spots)):
        used[spot.region] += 1
        names[spot] = f"{spot.region}{used[spot.region]}"
    return [names[spot] for spot in spots]


def _vertices(
    midline: list[Spot], pairs: list[Spot], places: NDArray[np.float64]
) -> NDArray[np.int64]:
    grid = np.arange(len(places)).reshape(-1, 2 * HALF_COLUMNS + 1)
    mirror = grid[:, ::-1].ravel()
    on_midline = grid[:, HALF_COLUMNS]
    middle = on_midline[_nearest(midline, places[on_midline])]
    left = _nearest(pairs, places)
    sides = np.stack([left, mirror[left]], axis=1)
    return np.concatenate([middle, sides.ravel()]).astype(np.int64)


def _nearest(spots: list[Spot], places: NDArray[np.float64]) -> NDArray[np.intp]:
    wanted = np.array([spot.place for spot in spots])
    return np.asarray(np.linalg.norm(wanted[:, None] - places[None], axis=2).argmin(axis=1))


def edges_between(marker_set: MarkerSet, points: NDArray[np.float64]) -> MarkerSet:
    """Return the marker set with lines to draw: its frontal projection, triangulated.

    Parameters
    ----------
    marker_set
    points
        (M, 3) mm; z is left out.
    """
    from scipy.spatial import Delaunay

    triangles = Delaunay(points[:, :2]).simplices
    lines = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, ::2]]))
    lines = np.unique(lines, axis=0)
    lengths = np.linalg.norm(points[lines[:, 0], :2] - points[lines[:, 1], :2], axis=1)
    lines = lines[lengths <= _LONGEST_EDGE * np.median(lengths)]
    # A line without its mirror is one of two equally good diagonals, taken by rounding.
    mirror = _mirror(marker_set)
    known = {(int(first), int(second)) for first, second in lines}
    symmetric = [line for line in sorted(known) if _mirrored(line, mirror) in known]
    names = marker_set.markers
    return replace(
        marker_set, edges=tuple((names[first], names[second]) for first, second in symmetric)
    )


def _mirror(marker_set: MarkerSet) -> list[int]:
    other = {left: right for left, right in marker_set.pairs}
    other |= {right: left for left, right in marker_set.pairs}
    return [marker_set.markers.index(other.get(name, name)) for name in marker_set.markers]


def _mirrored(line: tuple[int, int], mirror: list[int]) -> tuple[int, int]:
    first, second = sorted(mirror[end] for end in line)
    return first, second
