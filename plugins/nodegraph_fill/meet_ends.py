"""Bend what a model makes of a gap so that it meets the samples at the gap's ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_fill.gaps import Gaps
    from nodegraph_mocap import Trajectories


def meet_ends(
    recording: Trajectories, gaps: Gaps, estimate: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the estimate of the gaps' samples, moved to meet each gap's ends.

    The mismatches at the two ends, present minus estimated, are spread over the gap along a
    straight line. A gap with one end is moved by that end's mismatch as a whole, and one whose
    ends have no estimate stays as it is.

    Parameters
    ----------
    recording
        Trajectories with gaps.
    gaps
        Those that were filled.
    estimate
        (T, M, 3) mm, NaN where there is none.

    Returns
    -------
    (S, 3) array of float64
        Millimetres, in the order of `Gaps.samples`.
    """
    gap, frame, marker, share = gaps.samples
    first = _mismatch(recording, estimate, gaps.start - 1, gaps.marker)
    last = _mismatch(recording, estimate, gaps.stop, gaps.marker)
    first, last = np.where(np.isnan(first), last, first), np.where(np.isnan(last), first, last)
    bend = np.nan_to_num(first)[gap] * (1.0 - share)[:, None]
    bend += np.nan_to_num(last)[gap] * share[:, None]
    return np.asarray(estimate[frame, marker] + bend)


def _mismatch(
    recording: Trajectories,
    estimate: NDArray[np.float64],
    frame: NDArray[np.intp],
    marker: NDArray[np.intp],
) -> NDArray[np.float64]:
    """Return what is present minus what is estimated, (G, 3); NaN beyond the take."""
    inside = (frame >= 0) & (frame < recording.frames)
    there = np.where(inside, frame, 0)
    apart = recording.positions[there, marker] - estimate[there, marker]
    return np.where(inside[:, None], apart, np.nan)
