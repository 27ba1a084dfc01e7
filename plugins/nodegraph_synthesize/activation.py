"""How strongly each muscle acts over time: speech, expressions and blinks, in [0, 1].

Speech comes in phrases with pauses. Within a phrase the jaw opens once a syllable and the
muscles of the lips follow each sound; brows and smiles come and go more slowly; the eyes blink
briefly and mostly together.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_synthesize.muscles import CHANNELS, JAW
from nodegraph_synthesize.smooth_noise import rising, smooth_noise

if TYPE_CHECKING:
    from numpy.typing import NDArray

_LID = "orbicularisOculi"
_SPEECH = {
    "orbicularisOris": 0.8,
    "mentalis": 0.6,
    "levatorLabii": 0.5,
    "depressorLabii": 0.7,
    "platysma": 0.6,
}
"""Muscles that follow the sounds, and how strongly they act at most."""
_EXPRESSION = {
    "frontalisInner": 0.9,
    "frontalisOuter": 0.9,
    "corrugator": 0.8,
    "zygomaticMajor": 0.9,
    "depressorAnguliOris": 0.7,
}
"""Muscles of slow expressions, and how strongly they act at most."""


@dataclass(frozen=True)
class Habits:
    """How one actor speaks and looks.

    Attributes
    ----------
    syllables : float
        Per second, within a phrase.
    silence : float
        Share of the time in pauses, about.
    jaw : float
        How far the jaw opens on a strong syllable, 0 to 1.
    pace : float
        Of expressions, Hz.
    blinks : float
        Per second.
    lopsided : float
        How much the sides differ, 0 to 1.
    gains : dict of muscle to float
        How much of each muscle's range the actor uses, 0 to 1.
    """

    syllables: float
    silence: float
    jaw: float
    pace: float
    blinks: float
    lopsided: float
    gains: dict[str, float]


def draw_habits(random: np.random.Generator) -> Habits:
    """Return the habits of a random actor."""
    most = {**_SPEECH, **_EXPRESSION, _LID: 1.0}
    used = 1.0 - 0.35 * random.random(len(most))
    return Habits(
        syllables=random.uniform(2.8, 4.2),
        silence=random.uniform(0.15, 0.35),
        jaw=random.uniform(0.5, 0.9),
        pace=random.uniform(0.35, 0.6),
        blinks=random.uniform(0.25, 0.45),
        lopsided=random.uniform(0.05, 0.25),
        gains={name: float(most[name] * share) for name, share in zip(most, used, strict=True)},
    )


def activations(
    random: np.random.Generator, habits: Habits, frames: int, rate: float
) -> NDArray[np.float64]:
    """Return (T, K) activations of the channels, in [0, 1]."""
    speaking = _phrases(random, habits, frames, rate)
    levels = {
        JAW: _jaw(random, habits, speaking, rate),
        **_followers(random, habits, speaking, rate),
        **_expressions(random, habits, frames, rate),
        **_blinks(random, habits, frames, rate),
    }
    return np.clip(np.stack([levels[name] for name in CHANNELS], axis=1), 0.0, 1.0)


def _phrases(
    random: np.random.Generator, habits: Habits, frames: int, rate: float
) -> NDArray[np.float64]:
    """Return 1 while the actor speaks and 0 in pauses, with soft ends."""
    curve = smooth_noise(random, frames, [0.7], rate)[:, 0]
    # The share of a normal curve below -2.6 (1 / 2 - silence) is about `silence`.
    threshold = -2.6 * (0.5 - habits.silence)
    return rising(curve, threshold - 0.25, threshold + 0.25)


def _jaw(
    random: np.random.Generator, habits: Habits, speaking: NDArray[np.float64], rate: float
) -> NDArray[np.float64]:
    tempo, stress = smooth_noise(random, len(speaking), [1.0, 1.5], rate).T
    phase = np.cumsum(habits.syllables * np.clip(1.0 + 0.2 * tempo, 0.6, 1.5)) / rate
    opening = 0.5 - 0.5 * np.cos(2 * np.pi * phase)
    strength = np.clip(0.55 + 0.25 * stress, 0.1, 1.0)
    # Between two syllables of a phrase the jaw does not close altogether.
    return np.asarray(habits.jaw * speaking * strength * (0.15 + 0.85 * opening))


def _followers(
    random: np.random.Generator, habits: Habits, speaking: NDArray[np.float64], rate: float
) -> dict[str, NDArray[np.float64]]:
    curves = _sided(random, habits, _SPEECH, [2.5] * len(_SPEECH), len(speaking), rate)
    return {
        name: habits.gains[_muscle(name)] * speaking * rising(curve, -0.3, 2.8)
        for name, curve in curves.items()
    }


def _expressions(
    random: np.random.Generator, habits: Habits, frames: int, rate: float
) -> dict[str, NDArray[np.float64]]:
    cutoffs = [habits.pace * factor for factor in (1.6, 1.6, 1.2, 1.0, 1.0)]
    curves = _sided(random, habits, _EXPRESSION, cutoffs, frames, rate)
    return {
        name: habits.gains[_muscle(name)] * rising(curve, -0.1, 2.5)
        for name, curve in curves.items()
    }


def _blinks(
    random: np.random.Generator, habits: Habits, frames: int, rate: float
) -> dict[str, NDArray[np.float64]]:
    seconds = np.arange(frames) / rate
    # More than fit: each is at least half a second after the one before, longer than it lasts.
    count = 2 + int(2.0 * frames / rate)
    starts = np.cumsum(0.5 + random.exponential(1.0 / habits.blinks - 0.5, count))
    depth = random.uniform(0.85, 1.0, (count, 2))
    # One in twelve is a wink of either eye.
    winking = random.random(count) < 1.0 / 12.0
    depth[winking, random.integers(0, 2, count)[winking]] = 0.0
    latest = np.searchsorted(starts, seconds, side="right") - 1
    since = np.where(latest >= 0, seconds - starts[latest], np.inf)
    closed = rising(since, 0.0, 0.08) * (1.0 - rising(since, 0.11, 0.24))
    left, right = (habits.gains[_LID] * closed[:, None] * depth[latest]).T
    return {f"{_LID}Left": left, f"{_LID}Right": right}


def _sided(
    random: np.random.Generator,
    habits: Habits,
    muscles: dict[str, float],
    cutoffs: list[float],
    frames: int,
    rate: float,
) -> dict[str, NDArray[np.float64]]:
    """Return a curve per channel; those of a pair are mostly the same."""
    shared = smooth_noise(random, frames, cutoffs, rate)
    own = smooth_noise(random, frames, cutoffs + cutoffs, rate).reshape(frames, 2, -1)
    apart = habits.lopsided
    sides = np.sqrt(1.0 - apart**2) * shared[:, None] + apart * own
    curves = {}
    for index, name in enumerate(muscles):
        if name in CHANNELS:
            curves[name] = shared[:, index]
        else:
            curves[f"{name}Left"], curves[f"{name}Right"] = sides[:, :, index].T
    return curves


def _muscle(channel: str) -> str:
    return channel.removesuffix("Left").removesuffix("Right")
