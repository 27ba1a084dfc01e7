"""The loop of the step-wise fills, compiled: import this module only when a fill runs.

All that is compiled stays in this one file, because numba's cache does not notice an edited
helper in another one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from collections.abc import Callable

    compiled: Callable[[Any], Any]

compiled = njit(cache=True, nogil=True)

MEAN, COSINE, MUSCLE, MUSCLE_NORMALIZED, WATERS = range(5)
"""The rule by which the neighbours' displacements are weighted."""

MISSING, MEASURED, FILLED = range(3)
"""The state of a sample. Filled ones serve as neighbours after all measured ones."""


@compiled
def run(
    positions: Any,
    state: Any,
    wanted: Any,
    backward: bool,
    rule: int,
    neighbours: int,
    reach: Any,
    allowed: Any,
    use_filled: bool,
    ring: int,
) -> None:
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
    rule
        One of the rules above.
    neighbours
        How many neighbours at most.
    reach : (2,) array of float64
        Radii of the rule WATERS, millimetres.
    allowed : (M, M) array of bool
        Which marker may be a neighbour of which; False on the diagonal.
    use_filled
        Whether filled samples serve as neighbours.
    ring
        0 to fill in the order of the markers, else the size of the ring by which the one with
        the most usable neighbours goes first.
    """
    frames, markers = state.shape
    tier = np.empty(markers, np.uint8)
    targets = np.empty(markers, np.int64)
    rank = np.empty(neighbours, np.int64)
    weight = np.empty(neighbours)
    members = np.empty((markers, ring), np.int64)
    order = np.empty((markers, 2))
    step = -1 if backward else 1
    for elapsed in range(1, frames):
        now = frames - 1 - elapsed if backward else elapsed
        before = now - step
        count = 0
        for marker in range(markers):
            if wanted[now, marker] and state[before, marker] != MISSING:
                targets[count] = marker
                count += 1
        if count == 0:
            continue
        _set_tiers(tier, state[before], state[now], use_filled)
        greedy = ring > 0 and count > 1
        if greedy:
            _set_rings(members, order, targets[:count], tier, positions[before], state[before])
        for turn in range(count):
            if greedy:
                _bring_first(order, members, targets, turn, count)
            marker = targets[turn]
            if not _predict(
                positions[before], positions[now], tier, marker, rule, reach, allowed, rank, weight,
                positions[now, marker],
            ):
                continue
            state[now, marker] = FILLED
            if use_filled:
                tier[marker] = FILLED
                if greedy:
                    _count_usable(order, members, targets, turn, count, marker)


@compiled
def predict_returns(
    positions: Any,
    state: Any,
    frame: Any,
    marker: Any,
    rule: int,
    neighbours: int,
    reach: Any,
    allowed: Any,
    use_filled: bool,
) -> Any:
    """Return where the rule would put samples that are measured, NaN where it cannot.

    Parameters
    ----------
    frame, marker : (G,) arrays of int
        The samples; each is predicted from the frame before it.

    Returns
    -------
    (G, 3) array of float64
    """
    predicted = np.full((len(frame), 3), np.nan)
    tier = np.empty(state.shape[1], np.uint8)
    rank = np.empty(neighbours, np.int64)
    weight = np.empty(neighbours)
    for gap in range(len(frame)):
        now = frame[gap]
        before = now - 1
        if state[before, marker[gap]] != MISSING:
            _set_tiers(tier, state[before], state[now], use_filled)
            _predict(
                positions[before], positions[now], tier, marker[gap], rule, reach, allowed, rank,
                weight, predicted[gap],
            )
    return predicted


@compiled
def _set_tiers(tier: Any, before: Any, now: Any, use_filled: bool) -> None:
    """Tell which markers are usable: present at both frames, MEASURED only if at both."""
    for marker in range(len(tier)):
        worse = max(before[marker], now[marker])
        either_missing = before[marker] == MISSING or now[marker] == MISSING
        unusable = either_missing or (worse == FILLED and not use_filled)
        tier[marker] = MISSING if unusable else worse


@compiled
def _predict(
    before: Any,
    now: Any,
    tier: Any,
    marker: int,
    rule: int,
    reach: Any,
    allowed: Any,
    rank: Any,
    weight: Any,
    predicted: Any,
) -> bool:
    """Write the marker's last position plus its neighbours' weighted displacement."""
    found = _nearest(before, tier, MEASURED, marker, allowed[marker], rank, weight, 0)
    if found < len(rank):
        found = _nearest(before, tier, FILLED, marker, allowed[marker], rank, weight, found)
    if found == 0:
        return False
    for index in range(found):
        weight[index] = math.sqrt(weight[index])
    _weigh(weight[:found], rule, reach)
    x, y, z = before[marker, 0], before[marker, 1], before[marker, 2]
    for index in range(found):
        other, share = rank[index], weight[index]
        x += share * (now[other, 0] - before[other, 0])
        y += share * (now[other, 1] - before[other, 1])
        z += share * (now[other, 2] - before[other, 2])
    predicted[0], predicted[1], predicted[2] = x, y, z
    return True


@compiled
def _nearest(
    places: Any,
    tier: Any,
    wanted: int,
    marker: int,
    allowed: Any,
    rank: Any,
    squared: Any,
    found: int,
) -> int:
    """Append the nearest markers of one tier to `rank`; equally near ones in marker order."""
    room = len(rank)
    first = found
    x, y, z = places[marker, 0], places[marker, 1], places[marker, 2]
    for other in range(len(tier)):
        if tier[other] != wanted or not allowed[other]:
            continue
        dx, dy, dz = places[other, 0] - x, places[other, 1] - y, places[other, 2] - z
        distance = dx * dx + dy * dy + dz * dz
        if found == room and distance >= squared[room - 1]:
            continue
        slot = found if found < room else room - 1
        while slot > first and squared[slot - 1] > distance:
            squared[slot] = squared[slot - 1]
            rank[slot] = rank[slot - 1]
            slot -= 1
        squared[slot] = distance
        rank[slot] = other
        found = min(found + 1, room)
    return found


@compiled
def _weigh(distance: Any, rule: int, reach: Any) -> None:
    """Replace the neighbours' distances by their weights."""
    if rule == MEAN:
        distance[:] = 1.0 / len(distance)
    elif rule == COSINE:
        _weigh_cosine(distance)
    elif rule == WATERS:
        distance[0] = _fall_off(distance[0], reach[0], reach[1])
    elif len(distance) < 3:
        _weigh_inverse(distance)
    else:
        _weigh_muscle(distance, rule == MUSCLE_NORMALIZED)


@compiled
def _weigh_cosine(distance: Any) -> None:
    nearest, farthest = distance.min(), distance.max()
    if farthest == nearest:
        distance[:] = 1.0 / len(distance)
        return
    scale = math.pi / 2.5 / (farthest - nearest)
    total = 0.0
    for index in range(len(distance)):
        distance[index] = math.cos((distance[index] - nearest) * scale)
        total += distance[index]
    for index in range(len(distance)):
        distance[index] /= total


@compiled
def _weigh_muscle(distance: Any, normalize: bool) -> None:
    every = distance[0] + distance[1] + distance[2]
    if every == 0.0:
        distance[:] = 1.0 / 3.0
        return
    for index in range(3):
        half = 0.5 * (1.0 + math.cos(distance[index] / every * math.pi))
        distance[index] = (half * half) * (half * half)
    if normalize:
        total = distance[0] + distance[1] + distance[2]
        for index in range(3):
            distance[index] /= total


@compiled
def _weigh_inverse(distance: Any) -> None:
    """Weight one or two neighbours by the inverse of their distance, the sum being 1."""
    if len(distance) == 1:
        distance[0] = 1.0
        return
    every = distance[0] + distance[1]
    first = 0.5 if every == 0.0 else distance[1] / every
    distance[0], distance[1] = first, 1.0 - first


@compiled
def _fall_off(distance: float, full: float, end: float) -> float:
    if distance <= full:
        return math.cos((1.0 - distance / full) * math.pi / 2.0)
    if distance < end:
        return math.cos((distance - full) / (end - full) * math.pi / 2.0)
    return 0.0


@compiled
def _set_rings(
    members: Any, order: Any, targets: Any, tier: Any, places: Any, state: Any
) -> None:
    """Find each target's nearest markers, whatever their state, and count the usable ones."""
    ring = members.shape[1]
    squared = np.empty(ring)
    present = np.empty(len(tier), np.uint8)
    for marker in range(len(tier)):
        present[marker] = state[marker] != MISSING
    for index in range(len(targets)):
        present[targets[index]] = 0
        found = _nearest(
            places, present, 1, targets[index], present, members[index], squared, 0
        )
        present[targets[index]] = 1
        members[index, found:] = -1
        order[index, 0] = 0.0
        order[index, 1] = 0.0 if found else np.inf
        for slot in range(found):
            order[index, 0] += tier[members[index, slot]] != MISSING
            order[index, 1] += math.sqrt(squared[slot]) / found


@compiled
def _bring_first(order: Any, members: Any, targets: Any, turn: int, count: int) -> None:
    """Move the target whose turn it is to place `turn`; the others keep their order."""
    best = turn
    for index in range(turn + 1, count):
        more = order[index, 0] > order[best, 0]
        equal = order[index, 0] == order[best, 0]
        if more or (equal and order[index, 1] < order[best, 1]):
            best = index
    marker = targets[best]
    usable, mean = order[best, 0], order[best, 1]
    ring = members[best].copy()
    for index in range(best, turn, -1):
        targets[index] = targets[index - 1]
        order[index] = order[index - 1]
        members[index] = members[index - 1]
    targets[turn] = marker
    order[turn, 0], order[turn, 1] = usable, mean
    members[turn] = ring


@compiled
def _count_usable(
    order: Any, members: Any, targets: Any, turn: int, count: int, filled: int
) -> None:
    """Count a sample just filled for those whose ring it is in."""
    for index in range(turn + 1, count):
        for slot in range(members.shape[1]):
            if members[index, slot] == filled:
                order[index, 0] += 1.0
