"""The slow part of the discrete cosine transform."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import node
from nodegraph_mocap import Trajectories
from nodegraph_smooth.cutoff import Cutoff, angle
from nodegraph_smooth.present_runs import Smoothing, smooth_runs

if TYPE_CHECKING:
    from numpy.typing import NDArray


@node(
    "smooth.dct",
    cite="edge_fragments",
    adapted="from Edge et al., known from Zhang et al. alone: it reduces noise and fills nothing",
    lookahead=None,
    shares=Smoothing,
)
def dct(smoothing: Smoothing, *, cutoff: Cutoff = 10.0) -> Trajectories:
    """Smooth by keeping the slow coefficients of the discrete cosine transform.

    A run of L samples is a sum of L cosines ``cos(pi k (t + 1/2) / L)`` of frequencies
    ``k rate / (2 L)`` (DCT-II, by `scipy.fft`). Those up to the cut-off are kept as they are,
    those above it dropped. Edge et al., as Zhang et al. describe it, used the transform to
    reconstruct missing segments after a Kalman filter had reduced the noise; here it reduces
    the noise and nothing is filled. The cosines are level at both ends of a run: there a
    trajectory that is not is bent, over about ``rate / cutoff`` frames.

    A gap splits a trajectory into runs, each smoothed by itself. One that is so short that only
    its mean would be kept, of fewer than ``rate / (2 cutoff)`` frames, stays as it is, counted
    in a warning.

    Looks ahead to the end of the run.

    Parameters
    ----------
    cutoff
        The highest frequency that is kept.

    Raises
    ------
    Refusal
        If the cut-off is not below half the frame rate, or every run is too short.
    """
    recording = smoothing.recording
    width = angle(cutoff, recording.rate)

    def truncated(block: NDArray[np.float64]) -> NDArray[np.float64]:
        from scipy.fft import dct, idct

        transformed = dct(block, axis=0, norm="ortho")
        transformed[_highest(width, len(block)) + 1 :] = 0.0
        return np.asarray(idct(transformed, axis=0, norm="ortho"))

    return smooth_runs(recording, truncated, shortest=math.ceil(math.pi / width - _SLIGHT))


_SLIGHT = 1e-9
"""Relative margin by which a cosine exactly at the cut-off is kept, however that was rounded."""


def _highest(width: float, length: int) -> int:
    """Return the number k of the last cosine that is kept."""
    return math.floor(width * length / math.pi + _SLIGHT)
