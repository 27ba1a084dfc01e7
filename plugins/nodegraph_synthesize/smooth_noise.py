"""Smooth random curves, of which everything that moves by chance is made."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

LONGEST_REST = 0.3
"""Seconds."""
_REDDEST, _FASTEST = 0.2, 8.0
"""Hz, between which red noise falls."""
_SHARE = 0.1
"""Share of a take too short for that, which still has to show something."""


def smooth_noise(
    random: np.random.Generator, frames: int, cutoffs: ArrayLike, rate: float
) -> NDArray[np.float64]:
    """Return (T, n) smooth random curves of mean 0 and standard deviation 1.

    White noise through a Gaussian low-pass, ``exp(-(f / cutoff)^2)``.

    Parameters
    ----------
    random
    frames
        T.
    cutoffs
        (n,) Hz, one per curve.
    rate
        Frames per second.
    """
    lowest = np.asarray(cutoffs, dtype=np.float64)
    frequencies = _frequencies(frames, rate, lowest.min())
    gain = np.exp(-((frequencies[:, None] / lowest) ** 2))
    return _shaped(random, frames, gain)


def low_passed_noise(
    random: np.random.Generator, frames: int, count: int, cutoff: float, rate: float
) -> NDArray[np.float64]:
    """Return (T, n) noise of standard deviation 1 as a publisher's filter leaves it.

    White noise through a Butterworth low-pass of second order, forwards and backwards, whose gain
    is ``1 / (1 + (f / cutoff)^4)``: half at the cut-off.
    """
    frequencies = _frequencies(frames, rate, cutoff)
    return _shaped(random, frames, np.tile(_butterworth_gain(frequencies, cutoff), (count, 1)).T)


def red_noise(
    random: np.random.Generator, frames: int, count: int, slope: float, rate: float
) -> NDArray[np.float64]:
    """Return (T, n) noise of standard deviation 1 whose power falls as ``f^slope``.

    From 0.2 Hz, below which it is constant, to 8 Hz, above which there is none.
    """
    frequencies = _frequencies(frames, rate, _REDDEST)
    gain = np.maximum(frequencies, _REDDEST) ** (0.5 * slope) * (frequencies <= _FASTEST)
    return _shaped(random, frames, np.tile(gain, (count, 1)).T)


def _butterworth_gain(frequencies: NDArray[np.float64], cutoff: float) -> NDArray[np.float64]:
    """Return the gain of a Butterworth low-pass of second order that is applied both ways."""
    return np.asarray(1.0 / (1.0 + (frequencies / cutoff) ** 4))


def _frequencies(frames: int, rate: float, lowest: float) -> NDArray[np.float64]:
    """Return the frequencies of a span longer than the recording: its end knows no start."""
    span = _power_of_two(frames + 2.0 * rate / lowest)
    return np.asarray(np.fft.rfftfreq(span, 1.0 / rate), dtype=np.float64)


def _shaped(
    random: np.random.Generator, frames: int, gain: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return (T, n) random curves of deviation 1 with the (F, n) gain at each frequency."""
    span = 2 * (len(gain) - 1)
    spectrum = random.standard_normal((2, *gain.shape))
    curves = np.fft.irfft((spectrum[0] + 1j * spectrum[1]) * gain, n=span, axis=0)
    # The expected deviation, not this curve's own: a short piece of a slow curve is nearly flat.
    power = 4.0 * np.sum(gain[1:-1] ** 2, axis=0) + gain[0] ** 2 + gain[-1] ** 2
    return np.asarray(curves[:frames] * (span / np.sqrt(power)))


def rising(curve: NDArray[np.float64], start: float, end: float) -> NDArray[np.float64]:
    """Return 0 up to `start`, 1 from `end` on, and a smooth step between."""
    share = np.clip((curve - start) / (end - start), 0.0, 1.0)
    return np.asarray(share**2 * (3.0 - 2.0 * share))


def _power_of_two(length: float) -> int:
    return 1 << int(np.ceil(np.log2(length)))


def rest_of(frames: int, rate: float) -> float:
    """Return for how many seconds from its first frame a take is at rest."""
    return min(LONGEST_REST, _SHARE * frames / rate)


def awake(frames: int, rate: float) -> NDArray[np.float64]:
    """Return (T,) 0 at rest and 1 from three times as long on, with a smooth step between."""
    rest = rest_of(frames, rate)
    return rising(np.arange(frames) / rate, rest, 3.0 * rest)
