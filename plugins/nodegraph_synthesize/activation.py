"""Activation of each muscle over time, in [0, 1]: speech, expressions and blinks.

Speech comes in phrases with pauses. Within a phrase the jaw opens once a syllable and the
muscles of the lips follow each sound; brows and smiles change more slowly; the eyes blink
briefly and mostly together. Whole expressions are held for seconds, some of them during speech.
Everything begins at rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_synthesize.expressions import held_expressions
from nodegraph_synthesize.eyelids import EYELIDS
from nodegraph_synthesize.muscles import CHANNELS, JAW, KINDS, kind_of
from nodegraph_synthesize.smooth_noise import awake, rest_of, rising, smooth_noise

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SPEECH = {
    "orbicularisOris": 0.8,
    "mentalis": 0.6,
    "levatorLabii": 0.5,
    "depressorLabii": 0.7,
    "platysma": 0.6,
}
"""Muscles that follow the sounds, and how strongly they act at most."""
_SOUNDS = 2.5
"""Rate of the sounds, Hz."""
_PLAY = {
    "frontalisInner": 0.8,
    "frontalisOuter": 0.8,
    "corrugator": 0.7,
    "cheekSquint": 0.5,
    "zygomaticMajor": 0.5,
    "depressorAnguliOris": 0.5,
}
"""Muscles that come and go, whatever is held or spoken, and how strongly they act at most."""
_CALM = 0.5
"""Level of these, in standard deviations, below which a smooth course leaves a muscle at rest."""
_BLINK = (0.11, 0.12, 0.31)
"""Seconds from the beginning of a blink at which the eye is shut, opens, and is open."""
_GAPS = (0.3, 1.7)
"""Between two blinks at the shortest and the longest, of what it is on average."""


@dataclass(frozen=True)
class Habits:
    """Habits of one actor.

    Attributes
    ----------
    syllables : float
        Per second, within a phrase.
    silence : float
        Approximate share of time in pauses.
    jaw : float
        How far the jaw opens on a strong syllable, 0 to 1.
    pace : float
        How often brows and smiles come and go, Hz.
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
    muscles = [name for name in KINDS if name != EYELIDS]
    used = 1.0 - 0.12 * random.random(len(muscles))
    return Habits(
        syllables=random.uniform(2.8, 4.2),
        silence=random.uniform(0.4, 0.8),
        jaw=random.uniform(0.15, 0.3),
        pace=random.uniform(0.3, 0.55),
        blinks=random.uniform(0.2, 0.3),
        lopsided=random.uniform(0.05, 0.25),
        gains=dict(zip(muscles, used.tolist(), strict=True)),
    )


def activations(
    random: np.random.Generator, habits: Habits, frames: int, rate: float
) -> NDArray[np.float64]:
    """Return (T, K) activations of the channels, in [0, 1]."""
    held = held_expressions(random, habits.lopsided, frames, rate)
    moving = awake(frames, rate)
    speaking = moving * _phrases(random, habits, frames, rate) * (1.0 - held.hush)
    levels = {
        JAW: _jaw(random, habits, speaking, rate),
        **_driven(random, habits, _SPEECH, _SOUNDS, speaking, rate),
        **_driven(random, habits, _PLAY, habits.pace, moving, rate),
        **_blinks(random, habits, frames, rate),
    }
    played = np.stack([levels.get(name, np.zeros(frames)) for name in CHANNELS], axis=1)
    gains = np.array([habits.gains.get(kind_of(name), 1.0) for name in CHANNELS])
    # Either alone acts as it is, both together never more than fully.
    return np.asarray(1.0 - (1.0 - played) * (1.0 - gains * held.levels))


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


def _driven(
    random: np.random.Generator,
    habits: Habits,
    most: dict[str, float],
    cutoff: float,
    active: NDArray[np.float64],
    rate: float,
) -> dict[str, NDArray[np.float64]]:
    """Return a smooth random level per channel, of each muscle up to its most."""
    curves = _sided(random, habits, most, cutoff, len(active), rate)
    used = {name: most[kind_of(name)] * habits.gains[kind_of(name)] for name in curves}
    return {name: used[name] * active * rising(curve, _CALM, 2.6) for name, curve in curves.items()}


def _blinks(
    random: np.random.Generator, habits: Habits, frames: int, rate: float
) -> dict[str, NDArray[np.float64]]:
    seconds = np.arange(frames) / rate
    # More than fit; the shortest gap is longer than a blink.
    count = 2 + int(frames / rate * habits.blinks / _GAPS[0])
    gaps = random.uniform(*_GAPS, count) / habits.blinks
    starts = rest_of(frames, rate) - 0.5 * gaps[0] + np.cumsum(gaps)
    depth = random.uniform(0.94, 1.0, (count, 2))
    # One in twelve is a wink of either eye.
    winking = random.random(count) < 1.0 / 12.0
    depth[winking, random.integers(0, 2, count)[winking]] = 0.0
    latest = np.searchsorted(starts, seconds, side="right") - 1
    since = np.where(latest >= 0, seconds - starts[latest], np.inf)
    shut, held, opened = _BLINK
    closed = rising(since, 0.0, shut) * (1.0 - rising(since, held, opened))
    left, right = (closed[:, None] * depth[latest]).T
    return {f"{EYELIDS}Left": left, f"{EYELIDS}Right": right}


def _sided(
    random: np.random.Generator,
    habits: Habits,
    muscles: dict[str, float],
    cutoff: float,
    frames: int,
    rate: float,
) -> dict[str, NDArray[np.float64]]:
    """Return a curve per channel; those of a pair are mostly the same."""
    cutoffs = [cutoff] * len(muscles)
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
