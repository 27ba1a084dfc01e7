"""The loop of the step-wise fills, compiled: import this module only when a fill runs.

All that is compiled stays in this one file, because numba's cache does not notice an edited
helper in another one. The helpers take plain arrays, records of arrays being twice as slow:
``then`` and ``here`` are the positions (M, 3) at the frame that a prediction starts from and at
the frame that it is for.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Flags = NDArray[np.bool_]
    Codes = NDArray[np.uint8]
    Floats = NDArray[np.float64]
    Integers = NDArray[np.integer]

inner = partial(kernel, no_cpython_wrapper=True)  # for kernels only

MEAN, COSINE, MUSCLE, MUSCLE_NORMALIZED, WATERS = range(5)
WEIGHTS = {
    "mean": MEAN,
    "cosine": COSINE,
    "muscle": MUSCLE,
    "muscle_normalized": MUSCLE_NORMALIZED,
    "waters": WATERS,
}
"""The rules by which the neighbours' displacements are weighted."""

MISSING, MEASURED, FILLED = range(3)
"""The state of a sample. Filled ones serve as neighbours after all measured ones."""


@kernel("positions", "state")
def run(
    positions: Floats,
    state: Codes,
    wanted: Flags,
    backward: bool,
    kind: int,
    neighbours: int,
    full: float,
    end: float,
    allowed: Flags,
    use_filled: bool,
    ring: int,
) -> int:
    """Fill the wanted samples in place, frame by frame in one direction.

    Parameters
    ----------
    positions : (T, M, 3) array of float64
        Written where `wanted`.
    state : (T, M) array of uint8
        Becomes FILLED where a sample was written.
    wanted : (T, M) array of bool
        Samples to fill.
    backward
        Whether each frame is predicted from the one after it.
    kind
        One of `WEIGHTS`.
    neighbours
        How many neighbours at most.
    full, end
        Radii in millimetres, for `WATERS`.
    allowed : (M, M) array of bool
        Whether the second marker may be a neighbour of the first; False on the diagonal.
    use_filled
        Whether filled samples serve as neighbours.
    ring
        0 to fill in the order of the markers, else the size of the ring by which the marker
        with the most usable neighbours goes first.

    Returns
    -------
    int
        How many predictions left a marker where it was, no neighbour having any weight.
    """
    frames, markers = state.shape
    targets, tier = np.empty(markers, np.int64), np.empty(markers, np.uint8)
    places, who = np.empty((3, markers)), np.empty(markers, np.int64)
    spare, spared = np.empty((3, markers)), np.empty(markers, np.int64)
    ranks, rings = np.full((markers, neighbours), -1), np.full((markers, ring), -1)
    weight, squared, distances = np.empty(neighbours), np.empty(ring), np.empty(markers)
    usable, mean = np.empty(markers, np.int64), np.empty(markers)
    step, still = -1 if backward else 1, 0
    for elapsed in range(1, frames):
        now = frames - 1 - elapsed if backward else elapsed
        count = _find_targets(targets, wanted[now], state[now - step])
        if count == 0:
            continue
        then, here, before = positions[now - step], positions[now], state[now - step]
        _set_tiers(tier, before, state[now], use_filled)
        greedy = ring > 0 and count > 1
        if greedy:
            _set_rings(
                rings, usable, mean, targets[:count], then, before, tier, allowed, spare, spared,
                squared, distances,
            )  # fmt: skip
        size = _gather(places, who, then, tier, MEASURED, MEASURED)
        for turn in range(count):
            if greedy:
                _bring_first(targets, usable, mean, turn, count)
            marker = targets[turn]
            rank = ranks[marker]
            bound = _bound(then, marker, rank, tier, MEASURED, MEASURED)
            nearest = _nearest(
                then, marker, places, who, size, allowed, rank, weight, distances, 0, bound
            )
            if nearest < neighbours:
                others = _gather(spare, spared, then, tier, FILLED, FILLED)
                nearest = _nearest(
                    then, marker, spare, spared, others, allowed, rank, weight, distances, nearest,
                    np.inf,
                )  # fmt: skip
            if nearest == 0:
                continue
            _weigh(weight, nearest, kind, full, end)
            still += kind == WATERS and weight[0] < 1e-12
            _move(here[marker], then, here, marker, rank, weight, nearest)
            state[now, marker] = FILLED
            if use_filled:
                tier[marker] = FILLED
                if greedy:
                    _count_new(usable, rings, targets[turn + 1 : count], marker)
    return still


@kernel()
def predict_returns(
    positions: Floats,
    state: Integers,
    frame: Integers,
    marker: Integers,
    kind: int,
    neighbours: int,
    full: float,
    end: float,
    allowed: Flags,
    use_filled: bool,
) -> Floats:
    """Return where the rule would put samples that are present, NaN where it cannot.

    Parameters
    ----------
    frame, marker : (G,) arrays of int
        The samples; each is predicted from the frame before it.
    positions, state, kind, neighbours, full, end, allowed, use_filled
        As for `run`.

    Returns
    -------
    (G, 3) array of float64
    """
    markers = state.shape[1]
    predicted = np.full((len(frame), 3), np.nan)
    tier = np.empty(markers, np.uint8)
    places, who = np.empty((3, markers)), np.empty(markers, np.int64)
    rank, weight, distances = np.full(neighbours, -1), np.empty(neighbours), np.empty(markers)
    for gap in range(len(frame)):
        now, target = frame[gap], marker[gap]
        if state[now - 1, target] == MISSING:
            continue
        then, here = positions[now - 1], positions[now]
        _set_tiers(tier, state[now - 1], state[now], use_filled)
        count = 0
        for level in (MEASURED, FILLED):
            if count < neighbours:
                size = _gather(places, who, then, tier, level, level)
                count = _nearest(
                    then, target, places, who, size, allowed, rank, weight, distances, count, np.inf
                )
        if count > 0:
            _weigh(weight, count, kind, full, end)
            _move(predicted[gap], then, here, target, rank, weight, count)
    return predicted


@inner("targets")
def _find_targets(targets: Integers, wanted: Flags, before: Codes) -> int:
    """List the markers to fill that have a last position, in their order."""
    count = 0
    for marker in range(len(wanted)):
        targets[count] = marker
        count += wanted[marker] and before[marker] != MISSING
    return count


@inner("tier")
def _set_tiers(tier: Codes, before: Codes, now: Codes, use_filled: bool) -> None:
    """Write which markers are usable: present at both frames, MEASURED only if at both."""
    for marker in range(len(tier)):
        worse = max(before[marker], now[marker])
        either_missing = (before[marker] == MISSING) | (now[marker] == MISSING)
        unusable = either_missing | ((worse == FILLED) & (not use_filled))
        tier[marker] = MISSING if unusable else worse


@inner("places", "who")
def _gather(
    places: Floats, who: Integers, then: Floats, tier: Codes, lowest: int, highest: int
) -> int:
    """Pack the markers of some tiers, in their order: the search is fast among packed ones."""
    size = 0
    for marker in range(len(tier)):
        places[0, size] = then[marker, 0]
        places[1, size] = then[marker, 1]
        places[2, size] = then[marker, 2]
        who[size] = marker
        size += (tier[marker] >= lowest) & (tier[marker] <= highest)
    return size


@inner("rank", "squared", "distances")
def _nearest(
    then: Floats,
    marker: int,
    places: Floats,
    who: Integers,
    size: int,
    allowed: Flags,
    rank: Integers,
    squared: Floats,
    distances: Floats,
    first: int,
    bound: float,
) -> int:
    """Rank the nearest of a pack behind the `first` ranked; equally near ones in marker order.

    Parameters
    ----------
    then, marker
        Where each marker is, and which one's neighbours are looked for.
    places, who, size
        The pack.
    allowed
        Whether the second marker may be a neighbour of the first.
    rank, squared : (K,) arrays
        The neighbours and their squared distances.
    distances : (M,) array
        Scratch.
    first
        How many are ranked already and stay.
    bound
        A squared distance within which there are enough, or infinity.

    Returns
    -------
    int
        How many are ranked now.
    """
    x, y, z = then[marker, 0], then[marker, 1], then[marker, 2]
    for index in range(size):
        dx, dy, dz = places[0, index] - x, places[1, index] - y, places[2, index] - z
        distances[index] = dx * dx + dy * dy + dz * dz
    last = len(rank) - 1
    squared[first:] = bound
    count = first
    for index in range(size):
        distance = distances[index]
        if distance < squared[last] and allowed[marker, who[index]]:
            slot = last
            while slot > first and squared[slot - 1] > distance:
                squared[slot] = squared[slot - 1]
                rank[slot] = rank[slot - 1]
                slot -= 1
            squared[slot] = distance
            rank[slot] = who[index]
            count += 1
    count = min(count, last + 1)
    rank[count:] = -1
    return count


@inner()
def _bound(
    then: Floats, marker: int, rank: Integers, tier: Codes, lowest: int, highest: int
) -> float:
    """Return a squared distance that the neighbours ranked last time lie within.

    A face changes little from frame to frame, so this bound spares most of the search. Without
    a full rank of markers that still are of these tiers it is infinite.
    """
    farthest = 0.0
    for other in rank:
        if other < 0 or tier[other] < lowest or tier[other] > highest:
            return np.inf
        dx, dy, dz = (
            then[other, 0] - then[marker, 0],
            then[other, 1] - then[marker, 1],
            then[other, 2] - then[marker, 2],
        )
        farthest = max(farthest, dx * dx + dy * dy + dz * dz)
    return farthest * (1.0 + 1e-9) + 1e-300


@inner("place")
def _move(
    place: Floats,
    then: Floats,
    here: Floats,
    marker: int,
    rank: Integers,
    weight: Floats,
    count: int,
) -> None:
    """Write the marker's last position plus its neighbours' weighted displacements."""
    x, y, z = then[marker, 0], then[marker, 1], then[marker, 2]
    for index in range(count):
        other, share = rank[index], weight[index]
        x += share * (here[other, 0] - then[other, 0])
        y += share * (here[other, 1] - then[other, 1])
        z += share * (here[other, 2] - then[other, 2])
    place[0], place[1], place[2] = x, y, z


@inner("weight")
def _weigh(weight: Floats, count: int, kind: int, full: float, end: float) -> None:
    """Replace the neighbours' squared distances by their weights."""
    for index in range(count):
        weight[index] = math.sqrt(weight[index])
    if kind == MEAN:
        weight[:count] = 1.0 / count
    elif kind == COSINE:
        _weigh_cosine(weight, count)
    elif kind == WATERS:
        weight[0] = _fall_off(weight[0], full, end)
    elif count < 3:
        _weigh_inverse(weight, count)
    else:
        _weigh_muscle(weight, kind == MUSCLE_NORMALIZED)


@inner("weight")
def _weigh_cosine(weight: Floats, count: int) -> None:
    nearest, farthest = np.inf, 0.0
    for index in range(count):
        nearest, farthest = min(nearest, weight[index]), max(farthest, weight[index])
    if farthest == nearest:
        weight[:count] = 1.0 / count
        return
    scale = math.pi / 2.5 / (farthest - nearest)
    total = 0.0
    for index in range(count):
        weight[index] = math.cos((weight[index] - nearest) * scale)
        total += weight[index]
    for index in range(count):
        weight[index] /= total


@inner("weight")
def _weigh_muscle(weight: Floats, normalize: bool) -> None:
    every = weight[0] + weight[1] + weight[2]
    if every == 0.0:
        weight[:3] = 1.0 / 3.0
        return
    for index in range(3):
        half = 0.5 * (1.0 + math.cos(weight[index] / every * math.pi))
        weight[index] = (half * half) * (half * half)
    if normalize:
        total = weight[0] + weight[1] + weight[2]
        for index in range(3):
            weight[index] /= total


@inner("weight")
def _weigh_inverse(weight: Floats, count: int) -> None:
    """Weight one or two neighbours by the inverse of their distance, the sum being 1."""
    if count == 1:
        weight[0] = 1.0
        return
    every = weight[0] + weight[1]
    nearer = 0.5 if every == 0.0 else weight[1] / every
    weight[0], weight[1] = nearer, 1.0 - nearer


@inner()
def _fall_off(distance: float, full: float, end: float) -> float:
    factor = 0.0
    if distance <= full:
        factor = math.cos((1.0 - distance / full) * math.pi / 2.0)
    elif distance <= end:
        factor = math.cos((distance - full) / (end - full) * math.pi / 2.0)
    return factor


@inner("rings", "usable", "mean", "places", "who", "squared", "distances")
def _set_rings(
    rings: Integers,
    usable: Integers,
    mean: Floats,
    targets: Integers,
    then: Floats,
    before: Codes,
    tier: Codes,
    allowed: Flags,
    places: Floats,
    who: Integers,
    squared: Floats,
    distances: Floats,
) -> None:
    """Find the ring of each target, its mean distance and how many in it are usable."""
    size = _gather(places, who, then, before, MEASURED, FILLED)
    for marker in targets:
        ring = rings[marker]
        bound = _bound(then, marker, ring, before, MEASURED, FILLED)
        count = _nearest(
            then, marker, places, who, size, allowed, ring, squared, distances, 0, bound
        )
        mean[marker] = _mean_distance(squared, count)
        usable[marker] = _count_usable(ring, count, tier)


@inner()
def _mean_distance(squared: Floats, count: int) -> float:
    total = 0.0
    for index in range(count):
        total += math.sqrt(squared[index])
    return total / count if count > 0 else np.inf


@inner()
def _count_usable(ring: Integers, size: int, tier: Codes) -> int:
    count = 0
    for slot in range(size):
        count += tier[ring[slot]] != MISSING
    return count


@inner("usable")
def _count_new(usable: Integers, rings: Integers, targets: Integers, filled: int) -> None:
    """Count a sample just filled for those yet to come whose ring it is in."""
    for marker in targets:
        for slot in range(rings.shape[1]):
            usable[marker] += rings[marker, slot] == filled


@inner("targets")
def _bring_first(targets: Integers, usable: Integers, mean: Floats, turn: int, count: int) -> None:
    """Move the target that goes first to place `turn`; the others keep their order."""
    first = turn
    for index in range(turn + 1, count):
        marker, best = targets[index], targets[first]
        equal = usable[marker] == usable[best]
        if usable[marker] > usable[best] or (equal and mean[marker] < mean[best]):
            first = index
    for index in range(first, turn, -1):
        targets[index], targets[index - 1] = targets[index - 1], targets[index]
