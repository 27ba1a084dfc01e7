"""High wavelet coefficients: impulses found by a B-spline wavelet."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, get_args

import numpy as np
from pydantic import Field

from nodegraph import node
from nodegraph_despike.repair import Repairing, repaired
from nodegraph_mocap import Trajectories
from nodegraph_mocap.frame_ranges import runs_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

Name = Literal["rbio2.2", "rbio2.4", "rbio2.6"]

_NORMAL = 0.6745
"""The median of the absolute value of a normal variable over its standard deviation."""
_PEAK = 0.7
"""Beside a lone impulse the coefficients are less than half of its own."""
_ROUNDING = 1e-9
"""Share of a run's size below which a number is rounding."""


@node(
    "despike.wavelet",
    cite=("hsieh_kuo2007", "cohen1992", "donoho1994", "zhang_scattered"),
    adapted=(
        "from Hsieh and Kuo 2007, known from Zhang et al. alone: threshold, test for peaks and "
        "repair are chosen here"
    ),
    lookahead=None,
    shares=Repairing,
)
def wavelet(
    repairing: Repairing,
    *,
    wavelet: Name = "rbio2.4",
    threshold: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] = 6.0,
) -> Trajectories:
    """Repair samples with high coefficients of a B-spline wavelet (after Hsieh and Kuo).

    Zhang et al. cite Hsieh and Kuo for impulses found as wavelet coefficients of high magnitude
    and replaced from their neighbours. The original could not be checked; what is done here:

    1. Each run of present samples of a marker, extended at both ends by its point reflection, is
       filtered by the high-pass filter h of the wavelet (the detail coefficients of level 1 of
       the undecimated transform), scaled so that its middle tap is 1:
       ``d_t = sum_j h_j P_{t+j}``, a vector of three coordinates in mm. The filter is symmetric
       about a sample, and blind to motion that is a polynomial of less than 2nd, 4th or 6th
       degree (the number after the point); its low-pass counterpart is the B-spline 1 2 1 / 4.
       ``|d_t|`` is how far a lone impulse is off.
    2. The sample is bad when ``|d_t| > threshold S``, with S the median of the marker's ``|d|``
       over 0.6745 (Donoho and Johnstone, with lengths for absolute values), when ``|d_t|`` is at
       least 0.7 of that of each neighbour (next to a lone impulse it is less than half), and
       when d turns from it to one of them, ``d_t . d_{t+1} < 0`` or ``d_t . d_{t-1} < 0``: an
       impulse's coefficients change sign, those of fast motion do not.
    3. The bad samples of a run are put, all at once, where their coefficients are 0: where the
       wavelet finds nothing, given the good samples.

    Impulses of one frame are found, most of two frames also, longer ones not. Where S = 0, more
    than half of the marker's coefficients being 0 as it stands still, nothing is bad. The first
    and the last sample of a run are never bad. How many samples were repaired, and by how much,
    is in a warning; what an earlier method has filled or repaired counts as present.

    Looks ahead 2, 4 or 6 frames (the number after the point) for a coefficient, farther by that
    where bad samples are close to one another, and to the take's end for S.

    Parameters
    ----------
    wavelet
        A reverse biorthogonal spline wavelet of Cohen, Daubechies and Feauveau, by PyWavelets'
        name. With more vanishing moments faster motion passes, and impulses are less set off
        from their neighbours.
    threshold
        How many times S is high.

    Raises
    ------
    ValueError
        If the wavelet is not one of its choices.
    """
    recording = repairing.recording
    if wavelet not in get_args(Name):
        raise ValueError(f"wavelet must be one of {', '.join(get_args(Name))}; got {wavelet!r}")
    half = _half_filter(wavelet)
    positions = recording.positions.copy()
    for marker in range(positions.shape[1]):
        _clean(positions[:, marker], recording.present[:, marker], half, threshold)
    return repaired(recording, positions)


def _half_filter(name: Name) -> NDArray[np.float64]:
    """Return the taps from the middle one, which is 1, outward; the other half is the same."""
    import pywt  # type: ignore[import-untyped]

    taps = np.array(pywt.Wavelet(name).dec_hi)
    middle = int(np.argmax(np.abs(taps)))
    return np.asarray(taps[middle : 2 * middle + 1] / taps[middle])


def _clean(
    track: NDArray[np.float64], present: NDArray[np.bool_], half: NDArray[np.float64], bar: float
) -> None:
    """Repair one marker, (T, 3), in place."""
    _, starts, stops = runs_of(present)
    every = map(slice, starts.tolist(), stops.tolist())
    runs = [(run, _details(track[run], half)) for run in every]
    if not runs:
        return
    lengths = [np.linalg.norm(details, axis=1) for _, details in runs]
    high = bar * float(np.median(np.concatenate(lengths))) / _NORMAL
    if high == 0.0:
        return
    for (run, details), length in zip(runs, lengths, strict=True):
        size = np.abs(track[run] - track[run][0]).max()
        bad = np.flatnonzero(_peaks(details, length) & (length > max(high, _ROUNDING * size)))
        if len(bad):
            track[run.start + bad] -= _excess(bad, details[bad], half)


def _details(run: NDArray[np.float64], half: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the coefficients of a run, (L, 3)."""
    reach, length = len(half) - 1, len(run)
    # From the run's own first sample: a marker that stands still has coefficients of exactly 0.
    around = np.pad(run - run[0], ((reach, reach), (0, 0)), mode="reflect", reflect_type="odd")
    details = around[reach : reach + length].copy()
    for off, tap in enumerate(half[1:], start=1):
        before, after = reach - off, reach + off
        details += tap * (around[before : before + length] + around[after : after + length])
    # About its own place a reflection is all alike: what is left there is rounding.
    details[[0, -1]] = 0.0
    return details


def _peaks(details: NDArray[np.float64], length: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return where a coefficient is not much less than those beside it, and turns from one."""
    beside = np.pad(length, 1)
    tall = length >= _PEAK * np.maximum(beside[:-2], beside[2:])
    turns = np.pad(np.sum(details[1:] * details[:-1], axis=1) < 0.0, 1)
    return np.asarray(tall & (turns[:-1] | turns[1:]))


def _excess(
    bad: NDArray[np.intp], details: NDArray[np.float64], half: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the amounts to subtract from the bad samples so that their coefficients are 0.

    The equations are ``sum_j h(t_i - t_j) x_j = d_i`` over the bad frames t; the filter's
    frequency response being positive but at 0, their matrix is positive definite.
    """
    from scipy.linalg import solveh_banded

    band = np.zeros((len(half), len(bad)))
    for below in range(min(len(half), len(bad))):
        apart = bad[below:] - bad[: len(bad) - below]
        taps = np.where(apart < len(half), half[np.minimum(apart, len(half) - 1)], 0.0)
        band[below, : len(taps)] = taps
    return np.asarray(solveh_banded(band, details, lower=True))
