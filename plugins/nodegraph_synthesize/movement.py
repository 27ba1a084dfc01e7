"""Movement other than by muscles: of the head as a whole, and of the skin a little by itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap import HeadMotion
from nodegraph_synthesize.smooth_noise import awake, red_noise, smooth_noise

if TYPE_CHECKING:
    from numpy.typing import NDArray

LARGEST_TURN = 4.9
"""Degrees; the head turns by less."""
LARGEST_SHIFT = 0.049
"""Largest shift of the head, as a share of its length."""
_TURN = np.array([2.0, 2.5, 1.2])
"""Typical nod, turn and tilt, degrees."""
_SHIFT = np.array([0.012, 0.012, 0.015])
"""Typical shift to the side, up and forward, of the head's length."""
_DRIFT = 0.1
"""Pace at which skin settles or drifts while no muscle moves, of the mean pace."""
_SETTLING = 0.25
"""Seconds that skin takes to follow."""
_SKIN, _SKIN_PACE = 0.25, 0.8
"""Standard deviation of the skin's own movement in each direction, mm, and its cut-off, Hz."""
_PATTERNS = 40
_PATTERN_LENGTH = 60.0
"""Typical wavelength of the skin's patterns, mm."""


def head_motion(
    random: np.random.Generator, frames: int, rate: float, head_length: float
) -> HeadMotion:
    """Return a smooth motion from rest, in which the head stays for a moment.

    Parameters
    ----------
    random
    frames, rate
        Number of frames, frames per second.
    head_length
        Millimetres.
    """
    curves = smooth_noise(random, frames, [0.35] * 3 + [0.25] * 3, rate)
    curves = (curves - curves[0]) * awake(frames, rate)[:, None]
    turns = _limited(curves[:, :3] * _TURN, LARGEST_TURN)
    shifts = _limited(curves[:, 3:] * _SHIFT, LARGEST_SHIFT) * head_length
    return HeadMotion(
        rotations=rotations_of(np.radians(turns)), translations=shifts, scales=np.ones(frames)
    )


def moved(aligned: NDArray[np.float64], motion: HeadMotion) -> NDArray[np.float64]:
    """Return (T, M, 3) ``s R aligned + t``."""
    turned = aligned @ motion.rotations.transpose(0, 2, 1)
    return np.asarray(motion.scales[:, None, None] * turned + motion.translations[:, None])


def rotations_of(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (T, 3, 3) rotations about (T, 3) axes by their lengths in radians (Rodrigues)."""
    angles = np.linalg.norm(vectors, axis=1)
    x, y, z = (vectors / np.maximum(angles, 1e-300)[:, None]).T
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    sine, versine = np.sin(angles)[:, None, None], (1.0 - np.cos(angles))[:, None, None]
    return np.asarray(np.eye(3) + sine * cross + versine * (cross @ cross))


def tempo(activations: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Return (T,) seconds of a clock by which skin moves: fast while muscles do, slow at rest.

    Soft tissue follows what it is attached to; by itself it only drifts: where no activation
    changes, the clock runs at a tenth of its mean pace.
    """
    change = np.linalg.norm(np.diff(activations, axis=0, prepend=activations[:1]), axis=1)
    width = max(1, round(_SETTLING * rate))
    change = np.convolve(change, np.ones(width) / width)[: len(change)]
    pace = _DRIFT + (1.0 - _DRIFT) * change / max(change.mean(), 1e-300)
    return np.asarray(np.cumsum(pace) / rate)


def skin_movement(
    random: np.random.Generator,
    points: NDArray[np.float64],
    clock: NDArray[np.float64],
    rate: float,
) -> NDArray[np.float64]:
    """Return (T, N, 3) mm of small smooth movement that no muscle explains, from rest.

    Many waves of random direction over the face, each with a course of its own, so that no few
    components describe the recording exactly.
    """
    directions = random.standard_normal((3, _PATTERNS)) * (2 * np.pi / _PATTERN_LENGTH / 1.7)
    phases = random.uniform(0.0, 2 * np.pi, (3, 1, _PATTERNS))
    waves = np.cos(points @ directions + phases)
    curves = smooth_noise(random, _length(clock, rate), [_SKIN_PACE] * _PATTERNS, rate)
    size = _SKIN * np.sqrt(2.0 / _PATTERNS)
    courses = size * _at(curves, clock, rate) * awake(len(clock), rate)[:, None]
    return np.asarray(np.einsum("tp,cnp->tnc", courses, waves))


def own_movement(
    random: np.random.Generator,
    extent: float,
    clock: NDArray[np.float64],
    rate: float,
) -> NDArray[np.float64]:
    """Return (T, 3) mm that one marker moves by itself, from rest, by a standard deviation.

    Red: its power falls as ``f^-3`` by the clock.
    """
    course = _at(red_noise(random, _length(clock, rate), 3, -3.0, rate), clock, rate)
    return np.asarray(extent / np.sqrt(3.0) * course * awake(len(clock), rate)[:, None])


def _length(clock: NDArray[np.float64], rate: float) -> int:
    return 2 + int(clock[-1] * rate)


def _at(
    curves: NDArray[np.float64], clock: NDArray[np.float64], rate: float
) -> NDArray[np.float64]:
    """Return the values of curves, sampled at a rate, at the times of a clock."""
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(np.arange(len(curves)) / rate, curves)(clock))


def _limited(vectors: NDArray[np.float64], largest: float) -> NDArray[np.float64]:
    """Return the vectors shortened smoothly, none as long as `largest`."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.sqrt(1.0 + (lengths / largest) ** 2))
