"""Shared by the fills along time: each gap is bridged from the marker's own samples alone.

Only gaps between two samples of the marker are bridged. Nothing is extrapolated: a gap at the
start or the end of the take stays missing, as does a marker that is never present.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_fill.gaps import LONG, NEVER, Gaps, warn_left
from nodegraph_fill.meet_ends import Ends, check_ends
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Between = Callable[[NDArray[np.float64], Gaps], NDArray[np.float64]]
    """Takes positions (T, M, 3) mm, NaN where missing, and gaps; returns the positions of their
    samples, (S, 3), in the order of `Gaps.samples`, NaN where it has none."""
    Curve = Callable[[NDArray[np.intp], NDArray[np.float64]], Callable[..., NDArray[np.float64]]]
    """Takes frames, (n,), and positions there, (n, 3); returns what gives positions at frames."""


def bridge(
    recording: Trajectories,
    ends: Ends,
    max_gap: int | None,
    between: Between,
    *,
    otherwise: str = "",
) -> Trajectories:
    """Fill the gaps that have two ends, and warn of those that are left; called by a node.

    Parameters
    ----------
    recording
        Trajectories with gaps.
    ends
        The setting: a curve through both ends meets them whatever it is.
    max_gap
        Longer gaps stay missing.
    between
        What fills them.
    otherwise
        Why it has none.
    """
    check_ends(ends)
    gaps = Gaps.of(recording)
    long = gaps.longer_than(max_gap) & ~gaps.never
    bridged = gaps.subset(gaps.inner & ~long)
    positions = recording.positions.copy()
    _, frame, marker, _ = bridged.samples
    positions[frame, marker] = between(recording.positions, bridged)
    filled = recording.with_samples(positions, changed=bridged.mask, origin=Origin.FILLED)
    reasons = [
        (gaps.subset(gaps.never), NEVER),
        (gaps.subset(long), LONG),
        (gaps.subset(gaps.at_start & ~long), "at the take's start"),
        (gaps.subset(gaps.at_end & ~long), "at the take's end"),
    ]
    warn_left(filled, reasons, otherwise, stacklevel=3)
    return filled


def on_curves(positions: NDArray[np.float64], gaps: Gaps, curve: Curve) -> NDArray[np.float64]:
    """Return the positions of the gaps' samples on a curve through each marker's own samples.

    Parameters
    ----------
    positions
        (T, M, 3) mm; NaN where missing.
    gaps
        Each between two samples of its marker.
    curve
        Makes the curve of one marker from all its present samples.

    Returns
    -------
    (S, 3) array of float64
        Millimetres, in the order of `Gaps.samples`.
    """
    _, frame, marker, _ = gaps.samples
    values = np.empty((len(frame), 3))
    ends = np.flatnonzero(np.diff(marker)) + 1
    for samples in np.split(np.arange(len(frame)), ends) if len(frame) else ():
        column = marker[samples[0]]
        known = np.flatnonzero(~np.isnan(positions[:, column, 0]))
        values[samples] = curve(known, positions[known, column])(frame[samples])
    return values
