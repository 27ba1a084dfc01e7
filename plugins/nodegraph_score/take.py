"""The length of a recording, and the time over which its motion is correlated."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_tables import Take

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories


def take_of(recording: Trajectories) -> Take:
    """Return the length of a recording, and over how many frames its motion is correlated.

    The second is the sum of the autocorrelation of the speed ``v[t]``, the mean over markers of
    ``|x[t + 1] - x[t]|``, over lags from 1 up to the first at which it is not positive. Errors of
    methods that predict motion vary with how much there is. Missing samples are left out.
    """
    steps = np.diff(recording.positions, axis=0)
    speed = np.sqrt(np.einsum("tmc,tmc->tm", steps, steps))
    known = np.isfinite(speed)
    counts = known.sum(axis=1)
    speed = np.where(known, speed, 0.0).sum(axis=1)[counts > 0] / counts[counts > 0]
    return Take(recording.frames, _correlation(speed))


def _correlation(values: NDArray[np.float64]) -> float:
    """Return the sum of the autocorrelation of a series over the lags at which it is positive."""
    count = len(values)
    if count < 4:
        return 0.0
    size = 1 << (2 * count - 1).bit_length()  # a power of two, for which a transform is fast
    spectrum = np.fft.rfft(values - values.mean(), size)
    products = np.fft.irfft(np.square(np.abs(spectrum)), size)[: count // 2]
    products /= np.arange(count, count - len(products), -1)
    if products[0] <= 1e-12 * np.square(values).mean():
        return 0.0
    ends = np.flatnonzero(products <= 0.0)
    last = int(ends[0]) if len(ends) else len(products)
    return float(products[1:last].sum() / products[0])
