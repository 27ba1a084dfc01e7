"""Expressions that are held: a smile, a frown, a surprise, one after the other.

Each has an onset, an apex of seconds and an offset. The muscles that take part are those of its
action units in the Facial Action Coding System (Ekman and Friesen 1978): a smile is 6 + 12,
sadness 1 + 4 + 15 + 17, surprise 1 + 2 + 26, and so on. Strength and onset of every
muscle differ each time, and one side is a little stronger.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_synthesize.muscles import CHANNELS, JAW, KINDS, PUFF, SPHINCTER, kind_of
from nodegraph_synthesize.smooth_noise import rest_of, rising, smooth_noise

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

EXPRESSIONS: Mapping[str, Mapping[str, float]] = {
    "smile": {"zygomaticMajor": 1.0, "cheekSquint": 0.8},
    "laugh": {"zygomaticMajor": 0.9, "cheekSquint": 1.0, "levatorLabii": 0.3, JAW: 0.7},
    "surprise": {"frontalisInner": 1.0, "frontalisOuter": 1.0, JAW: 1.0},
    "fear": {
        "frontalisInner": 0.9,
        "frontalisOuter": 0.5,
        "corrugator": 0.7,
        "platysma": 1.0,
        JAW: 0.6,
    },
    "sadness": {
        "frontalisInner": 0.8,
        "corrugator": 0.5,
        "depressorAnguliOris": 1.0,
        "mentalis": 0.8,
    },
    "anger": {
        "corrugator": 1.0,
        "levatorNasi": 0.4,
        "levatorLabii": 0.7,
        "depressorLabii": 1.0,
        "platysma": 0.5,
        JAW: 0.4,
    },
    "disgust": {
        "levatorNasi": 1.0,
        "levatorLabii": 1.0,
        "corrugator": 0.6,
        "cheekSquint": 0.8,
        "depressorAnguliOris": 0.5,
        "mentalis": 0.6,
        JAW: 0.3,
    },
    "pucker": {SPHINCTER: 1.0, "mentalis": 0.4},
    "puff": {PUFF: 1.0, SPHINCTER: 0.3, "mentalis": 0.3},
    "smirkLeft": {"zygomaticMajorLeft": 1.0, "levatorLabiiLeft": 0.5, "cheekSquintLeft": 0.8},
    "smirkRight": {"zygomaticMajorRight": 1.0, "levatorLabiiRight": 0.5, "cheekSquintRight": 0.8},
}
"""Largest activation of each muscle, or that of one side, in each expression."""

_SHORTEST, _LONGEST = (0.35, 0.5, 0.5, 0.3), (0.7, 1.5, 0.9, 1.6)
"""Seconds of onset, apex, offset and the pause after them."""
_FAINTEST = 0.6
"""Strength of the faintest expression, of the strongest."""
_SLACK = 0.05
"""Share by which a held expression gives way."""
_LATEST = 0.25
"""Seconds by which one muscle sets in later than another; shorter than any pause."""
_KIND = np.array([KINDS.index(kind_of(name)) for name in CHANNELS])
_SPOKEN_THROUGH = 0.35
"""Share of expressions that do not hush the actor."""
_HUSH = 0.92
"""Share that the other expressions take from speech."""


@dataclass(frozen=True)
class Held:
    """The expressions of a take.

    Attributes
    ----------
    levels : (T, K) array
        Activation of each channel by expressions, in [0, 1].
    hush : (T,) array
        Reduction of speech, in [0, 1].
    """

    levels: NDArray[np.float64]
    hush: NDArray[np.float64]


def held_expressions(
    random: np.random.Generator, lopsided: float, frames: int, rate: float
) -> Held:
    """Return expressions, one after the other from the end of the rest to that of the take.

    Parameters
    ----------
    random
    lopsided
        How much the sides differ, 0 to 1.
    frames, rate
        Number of frames, frames per second.
    """
    script = _script(random, lopsided, frames / rate, rest_of(frames, rate))
    # Nothing is held quite still.
    loose = rising(smooth_noise(random, frames, [0.6] * len(KINDS), rate), -1.0, 1.5)
    seconds = np.arange(frames) / rate
    latest = np.searchsorted(script.starts, seconds, side="right") - 1
    since = np.where(latest >= 0, seconds - script.starts[latest], -np.inf)
    times = script.times[latest].T
    acting = _course(since[:, None] - script.delays[latest], times[..., None])
    return Held(
        levels=script.levels[latest] * acting * (1.0 - _SLACK * loose[:, _KIND]),
        hush=script.hush[latest] * _course(since, times),
    )


@dataclass(frozen=True)
class _Script:
    """The times of n expressions, which are more than fit into the take."""

    starts: NDArray[np.float64]
    times: NDArray[np.float64]
    """(n, 3) seconds of onset, apex and offset."""
    levels: NDArray[np.float64]
    """(n, K) at the apex."""
    delays: NDArray[np.float64]
    """(n, K) seconds by which each channel sets in later."""
    hush: NDArray[np.float64]


def _script(random: np.random.Generator, lopsided: float, seconds: float, rest: float) -> _Script:
    count = 2 + int(seconds / sum(_SHORTEST))
    times = random.uniform(_SHORTEST, _LONGEST, (count, 4))
    lengths = times.sum(axis=1)
    levels = _levels(random, lopsided, count)
    return _Script(
        starts=rest + random.uniform(0.1, 0.6) + np.cumsum(lengths) - lengths,
        times=times[:, :3],
        levels=levels,
        delays=random.uniform(0.0, _LATEST, (count, len(KINDS)))[:, _KIND],
        hush=np.where(random.random(count) < _SPOKEN_THROUGH, 0.0, _HUSH),
    )


def _course(since: NDArray[np.float64], times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return 0, 1 and 0 again over the seconds since an expression has begun."""
    onset, apex, offset = times
    return rising(since / onset, 0.0, 1.0) * (
        1.0 - rising((since - onset - apex) / offset, 0.0, 1.0)
    )


def _levels(random: np.random.Generator, lopsided: float, count: int) -> NDArray[np.float64]:
    """Return (n, K) levels of the channels at the apex of n expressions."""
    full = np.array(
        [[_level(muscles, name) for name in CHANNELS] for muscles in EXPRESSIONS.values()]
    )
    order = _order(random, np.array([JAW in muscles for muscles in EXPRESSIONS.values()]), count)
    strength = random.uniform(_FAINTEST, 1.0, (count, 1))
    mixed = random.uniform(0.7, 1.0, (count, len(KINDS)))[:, _KIND]
    left, right = 1.0 - lopsided * random.random((2, count, 1))
    sided = np.where(_on("Left"), left, 1.0) * np.where(_on("Right"), right, 1.0)
    return np.asarray(full[order] * strength * mixed * sided)


def _order(random: np.random.Generator, opened: NDArray[np.bool_], count: int) -> NDArray[np.intp]:
    """Return which n expressions come one after the other: with open mouth, with closed, ...

    Those of either kind come in a new order each time round, so that none comes back before all
    have been.
    """
    decks = []
    for kind in (np.flatnonzero(opened), np.flatnonzero(~opened)):
        rounds = np.tile(kind, (1 + count // len(kind), 1))
        decks.append(random.permuted(rounds, axis=1).ravel()[:count])
    first = random.integers(2)
    return np.stack(decks, axis=1).ravel()[first : first + count]


def _level(muscles: Mapping[str, float], channel: str) -> float:
    return muscles.get(channel, muscles.get(kind_of(channel), 0.0))


def _on(side: str) -> NDArray[np.bool_]:
    return np.array([name.endswith(side) for name in CHANNELS])
