"""Gaps whose content is known, and standard deviations scaled by the errors in them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_fill.gaps import Gaps
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_LEVEL, _REACH = 0.95, 1.959963984540054
"""An interval that holds this share of errors reaches this many standard deviations."""
_ALIKE = 20
"""Smallest number of held-out gaps, those of the nearest lengths, by which a gap is judged."""
_LEAST = 10


def calibrated(
    filled: Trajectories,
    fill: Callable[[Trajectories, Gaps], Trajectories],
    recording: Trajectories,
    gaps: Gaps,
    noise: NDArray[np.float64] | None,
) -> Trajectories:
    """Return the recording filled, with a `sigma` that 95 % of errors lie within 1.96 times.

    The gaps are laid over the recording again, later by half its length and from its end on to
    its beginning, wherever the marker is present there and on both sides. The samples that they
    hide are filled, too, all others being known but for the gaps. The sigma of a gap is
    multiplied by ``q / 1.96``, with q the 95 % quantile of ``|error| / sigma`` over the
    coordinates in the held-out gaps of the lengths nearest to its own, by the logarithm: as many
    lengths as it takes for 20 gaps, and all gaps of these, for some of them would be those of the
    first markers. No distribution of the errors is assumed, but that gaps err as those held out
    do. It is the normalized score of split conformal prediction (Lei et al., 2018), per length of
    gap.

    Parameters
    ----------
    filled
        The recording filled, with a sigma in the gaps.
    fill
        Takes the recording with other gaps and these, and fills them likewise.
    recording
        Trajectories with gaps.
    gaps
        The gaps that were filled.
    noise
        Variance of the noise of each marker's samples, (M,), mm^2; None: 0. The errors have it,
        and ``sqrt(sigma^2 + noise)`` is what is multiplied. From the square, the noise is taken
        off again, with the factor where that is below 1.

    Returns
    -------
    Trajectories
        The recording filled; sigma is NaN in the gaps if fewer than 10 could be held out.
    """
    assert filled.sigma is not None
    held, sigma = moved(recording, gaps, recording.frames // 2), filled.sigma.copy()
    gap, frame, marker, _ = gaps.samples
    if len(held.start) < _LEAST:
        sigma[frame, marker] = np.nan
    else:
        noise = np.zeros(gaps.shape[1]) if noise is None else noise
        scale = _scale(recording, held, fill(without(recording, held), held), noise)
        square = scale(gaps.length)[gap] ** 2
        extra = np.maximum(square - 1.0, 0.0) * noise[marker]
        sigma[frame, marker] = np.sqrt(square * sigma[frame, marker] ** 2 + extra)
    return replace(filled, sigma=sigma)


def moved(recording: Trajectories, gaps: Gaps, later: int) -> Gaps:
    """Return the gaps so many frames later, from the take's end on to its beginning.

    Those are left out that hide other samples than present ones with a present one on each side.
    """
    frames = recording.frames
    start = (gaps.start + later) % frames
    stop = start + gaps.length
    before = np.pad(np.cumsum(~recording.present, axis=0), ((1, 0), (0, 0)))
    inner = (start > 0) & (stop < frames)
    first, last = np.where(inner, start - 1, 0), np.where(inner, stop + 1, 0)
    free = before[last, gaps.marker] == before[first, gaps.marker]
    return Gaps(gaps.marker, start, stop, gaps.shape).subset(inner & free)


def without(recording: Trajectories, gaps: Gaps) -> Trajectories:
    """Return the recording without the samples in gaps."""
    positions = np.where(gaps.mask[..., None], np.nan, recording.positions)
    return recording.with_samples(positions, changed=gaps.mask, origin=Origin.MISSING)


def _scale(
    recording: Trajectories, held: Gaps, filled: Trajectories, noise: NDArray[np.float64]
) -> Callable[[NDArray[np.intp]], NDArray[np.float64]]:
    """Return what the sigma of gaps of some lengths is to be multiplied by."""
    gap, frame, marker, _ = held.samples
    assert filled.sigma is not None
    error = np.abs(filled.positions[frame, marker] - recording.positions[frame, marker])
    sigma = np.sqrt(filled.sigma[frame, marker] ** 2 + noise[marker])[:, None]
    errors = np.divide(error, sigma, out=np.where(error > 0.0, np.inf, 0.0), where=sigma > 0.0)

    def of(length: int) -> float:
        apart = np.abs(np.log(held.length / length))
        alike = apart <= np.sort(apart)[:_ALIKE][-1]
        return float(np.quantile(errors[alike[gap]], _LEVEL)) / _REACH

    def scale(lengths: NDArray[np.intp]) -> NDArray[np.float64]:
        known, which = np.unique(lengths, return_inverse=True)
        return np.array([of(length) for length in known])[which]

    return scale
