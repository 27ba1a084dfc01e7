"""Places of markers: a facial layout of 60, thinned or made denser to any number."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap import MarkerSet
from nodegraph_synthesize.spots import MIDLINE, PAIRS, Spot
from nodegraph_synthesize.surface import HALF_COLUMNS

if TYPE_CHECKING:
    from numpy.typing import NDArray

FEWEST, MOST = 10, 150


_USUAL = len(MIDLINE) + 2 * len(PAIRS)


@dataclass(frozen=True)
class Layout:
    """Markers and the vertex that each sits on.

    Attributes
    ----------
    marker_set : MarkerSet
        Without edges.
    vertices : (M,) array
    """

    marker_set: MarkerSet
    vertices: NDArray[np.int64]


def make_layout(count: int, places: NDArray[np.float64]) -> Layout:
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
    spread = _spread(places, taken, (count - on_midline) // 2 - 2)
    numbers = sorted({0, 1, *spread})
    return list(MIDLINE[:on_midline]), [PAIRS[index] for index in numbers]


def _denser(count: int, places: NDArray[np.float64]) -> tuple[list[Spot], list[Spot]]:
    usual = np.array([spot.place for spot in (*MIDLINE, *PAIRS)])
    on_midline, on_left = _free(places)
    more = on_midline[_spread(on_midline, usual, count % 2)]
    taken = np.concatenate([usual, more, usual[len(MIDLINE) :] * [-1.0, 1.0]])
    left = on_left[_spread(on_left, taken, (count - _USUAL) // 2)]
    return [*MIDLINE, *_like_nearest(more)], [*PAIRS, *_like_nearest(left)]


def _free(places: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return places on the midline and on the left half, away from the rim and each other."""
    columns = 2 * HALF_COLUMNS + 1
    grid = places.reshape(-1, columns, 2)[2:-2]
    left = grid[:, HALF_COLUMNS + 2 : -2].reshape(-1, 2)
    return grid[:, HALF_COLUMNS], left[left[:, 0] > 4.0]


def _spread(candidates: NDArray[np.float64], taken: NDArray[np.float64], count: int) -> list[int]:
    """Return `count` candidates, each the farthest from all that were taken before it."""
    nearest = np.linalg.norm(candidates[:, None] - taken[None], axis=2).min(axis=1)
    selected = []
    for _ in range(count):
        index = int(np.argmax(nearest))
        selected.append(index)
        nearest = np.minimum(nearest, np.linalg.norm(candidates - candidates[index], axis=1))
    return selected


def _like_nearest(places: NDArray[np.float64]) -> list[Spot]:
    usual = (*MIDLINE, *PAIRS)
    known = np.array([spot.place for spot in usual])
    nearest = np.linalg.norm(places[:, None] - known[None], axis=2).argmin(axis=1)
    return [
        Spot(usual[index].region, (float(u), float(v)))
        for index, (u, v) in zip(nearest, places, strict=True)
    ]


def _named(midline: list[Spot], pairs: list[Spot], places: NDArray[np.float64]) -> Layout:
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
    return Layout(marker_set, _vertices(midline, pairs, places))


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
