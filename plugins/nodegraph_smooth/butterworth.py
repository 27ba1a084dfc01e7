"""A Butterworth low-pass filter, run forward and backward."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import node
from nodegraph_mocap import Trajectories
from nodegraph_smooth.cutoff import Cutoff, angle
from nodegraph_smooth.present_runs import Smoothing, smooth_runs

if TYPE_CHECKING:
    from numpy.typing import NDArray


@node(
    "smooth.butterworth",
    cite="butterworth1930",
    adapted=(
        "from Butterworth 1930: digital, run forward and backward, ends continued by reflection"
    ),
    lookahead=None,
    shares=Smoothing,
)
def butterworth(
    smoothing: Smoothing,
    *,
    cutoff: Cutoff = 10.0,
    order: Annotated[int, Field(ge=1, le=10)] = 2,
) -> Trajectories:
    """Smooth by a Butterworth low-pass filter, forward and then backward in time.

    A filter of order n keeps ``1 / sqrt(1 + u^(2 n))`` of the amplitude of frequency f, with
    ``u = tan(pi f / rate) / tan(pi fc / rate)`` (the bilinear transform of Butterworth's
    ``f / fc``), and shifts it in time. The second pass undoes the shift and leaves
    ``1 / (1 + u^(2 n))``: half of the amplitude at the cut-off fc. What the field calls a
    fourth-order zero-lag filter is order 2 here, as it runs twice; some correct fc such that it
    is the -3 dB point of both passes.

    A run is continued at both ends by turning it about its end samples, again and again. What
    both passes make of that without end is written down at once: the straight line from the
    first to the last sample stays, and each sine of what is left (DST-I, by `scipy.fft`) keeps
    its share. `scipy.signal.sosfiltfilt` comes near it with odd padding that is long enough,
    which its own is not where fc is low. So the end samples stay as they were, however short a
    run is. A gap splits a trajectory into runs, each smoothed by itself. Nothing is filled.

    Looks ahead to the end of the run; what lies ``rate / fc`` frames ahead counts for little:
    6 frames with the defaults at 60 Hz.

    Parameters
    ----------
    cutoff
        fc, the frequency of which half the amplitude is kept.
    order
        n, of each of the two passes.

    Raises
    ------
    Refusal
        If the cut-off is not below half the frame rate.
    """
    recording = smoothing.recording
    width = angle(cutoff, recording.rate)

    def filtered(block: NDArray[np.float64]) -> NDArray[np.float64]:
        return _filtered(block, width, order) if len(block) > 2 else block

    return smooth_runs(recording, filtered)


def _filtered(block: NDArray[np.float64], width: float, order: int) -> NDArray[np.float64]:
    from scipy.fft import dst, idst

    inner, last = len(block) - 2, len(block) - 1
    way = np.arange(1, last)[:, None, None] / last
    line = block[0] + way * (block[-1] - block[0])
    faster = np.tan(0.5 * math.pi * np.arange(1, inner + 1) / last) / math.tan(width / 2.0)
    gain = 1.0 / (1.0 + faster ** (2 * order))
    sines = dst(block[1:-1] - line, type=1, axis=0, norm="ortho")
    filtered = block.copy()
    filtered[1:-1] = line + idst(gain[:, None, None] * sines, type=1, axis=0, norm="ortho")
    return filtered
