"""Damage of a recording: noise, impulses, occlusions, and points without names."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap import Detections

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories

SMALLEST_IMPULSE, LARGEST_IMPULSE = 4.0, 10.0
"""Millimetres."""
LONGEST_GAP = 40
"""Frames of one occlusion."""
_TOGETHER = 0.3
"""Share of occlusions that hide a few neighbours as well."""
_MOST_TOGETHER = 5


def occlusions(
    random: np.random.Generator, share: float, frames: int, points: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Return (T, M), True where a marker is not seen.

    Each occlusion hides a marker, or a few neighbours about together, for 1 to 40 frames, short
    ones more often than long ones. Two of them may run together.

    Parameters
    ----------
    random
    share
        Share of all samples that is hidden, below 1; exact to one sample.
    frames
    points
        (M, 3) mm, the neutral face, which decides the neighbours.
    """
    wanted = round(share * frames * len(points))
    marker, start, length = _occlusion_events(random, share, frames, points)
    event = np.repeat(np.arange(len(length)), length)
    within = np.arange(len(event)) - np.repeat(np.cumsum(length) - length, length)
    frame = start[event] + within
    inside = (frame >= 0) & (frame < frames)
    samples = (frame * len(points) + marker[event])[inside]
    # In the order of the events, so that the last one is cut short where the share is reached.
    _, first = np.unique(samples, return_index=True)
    hidden = np.zeros(frames * len(points), dtype=np.bool_)
    hidden[samples[np.sort(first)[:wanted]]] = True
    return hidden.reshape(frames, len(points))


def impulses(
    random: np.random.Generator, share: float, present: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Return which samples an impulse hits, (T, M), and by how much, (T, M, 3) mm.

    Single frames: no marker is hit in two frames in a row, nor in the first or last frame. Each
    is off by 4 to 10 mm in a direction of its own.
    """
    keys = random.random(present.shape)
    sizes = random.uniform(SMALLEST_IMPULSE, LARGEST_IMPULSE, present.shape)
    jumps = offsets(random, sizes)
    wanted = round(share * np.count_nonzero(present))
    hit = lone_samples(keys, present, wanted)
    if np.count_nonzero(hit) < wanted:
        warnings.warn(
            f"{np.count_nonzero(hit)} impulses instead of {wanted}: single frames leave room for "
            "no more",
            stacklevel=3,
        )
    return hit, np.where(hit[..., None], jumps, 0.0)


def lone_samples(
    keys: NDArray[np.float64], allowed: NDArray[np.bool_], wanted: int
) -> NDArray[np.bool_]:
    """Return which samples are chosen, (T, M): no marker's in two frames in a row.

    Samples whose key is lower than those of the frames before and after are candidates, about a
    third of all; the allowed ones of lowest key are chosen, so that a larger number contains a
    smaller one's choice.

    Parameters
    ----------
    keys
        (T, M) random numbers.
    allowed
        (T, M), True where a sample may be chosen; the first and last frame never are.
    wanted
        How many; fewer where there are fewer candidates.
    """
    single = np.zeros_like(allowed)
    single[1:-1] = (keys[1:-1] < keys[:-2]) & (keys[1:-1] < keys[2:]) & allowed[1:-1]
    possible = np.flatnonzero(single)
    # in C order whatever the order of `allowed`, as `flatnonzero` counts
    selected = np.zeros(allowed.size, dtype=np.bool_)
    selected[possible[np.argsort(keys.ravel()[possible])[:wanted]]] = True
    return selected.reshape(allowed.shape)


def offsets(random: np.random.Generator, lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vectors, (..., 3), of these lengths, each in a random direction."""
    directions = random.standard_normal((*lengths.shape, 3))
    directions *= (lengths / np.linalg.norm(directions, axis=-1))[..., None]
    return directions


def unlabelled(random: np.random.Generator, captured: Trajectories) -> Detections:
    """Return the present samples of a recording without names, in random order per frame."""
    frame, marker = np.nonzero(captured.present)
    order = np.lexsort((random.random(len(frame)), frame))
    counts = np.count_nonzero(captured.present, axis=1)
    return Detections(
        points=captured.positions[frame[order], marker[order]],
        offsets=np.concatenate([[0], np.cumsum(counts)]),
        rate=captured.rate,
    )


def _occlusion_events(
    random: np.random.Generator,
    share: float,
    frames: int,
    points: NDArray[np.float64],
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Return marker, first frame and length of more than enough occlusions."""
    # An event hides 18 samples on average; twice as many as needed, for those that coincide, and
    # more where occlusions are longer than the recording.
    visible = -np.log1p(-share) * frames * len(points)
    count = 20 + round(visible / 9.0 * (1.0 + LONGEST_GAP / frames))
    lengths = np.exp(random.uniform(0.0, np.log(LONGEST_GAP + 1.0), count)).astype(np.intp)
    starts = random.integers(-lengths + 1, frames)
    together = np.where(
        random.random(count) < _TOGETHER, random.integers(2, _MOST_TOGETHER + 1, count), 1
    )
    near = np.linalg.norm(points[:, None] - points[None], axis=2).argsort(axis=1, kind="stable")
    which = np.repeat(np.arange(count), together)
    rank = np.arange(len(which)) - np.repeat(np.cumsum(together) - together, together)
    markers = near[random.integers(0, len(points), count)[which], rank]
    delays = np.where(rank > 0, random.integers(-3, 4, len(which)), 0)
    return markers, starts[which] + delays, lengths[which]
