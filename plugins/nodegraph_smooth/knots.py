"""Least-squares splines on knots that are evenly spread over a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def spans_of(length: int, spacing: float, degree: int, repeated: int) -> int:
    """Return into how many spans a run is divided.

    As near to `spacing` as a whole number of spans comes, but never so many that the spline has
    as many coefficients as the run has samples.

    Parameters
    ----------
    length
        Frames of the run, at least ``degree + 2``.
    spacing
        Frames between knots.
    degree
        Degree of the spline.
    repeated
        How often each inner knot counts.
    """
    wanted = max(1, round((length - 1) / spacing))
    return min(wanted, 1 + (length - degree - 2) // repeated)


def fit(
    block: NDArray[np.float64], spacing: float, *, degree: int, repeated: int = 1
) -> NDArray[np.float64]:
    """Return the least-squares spline of runs, (L, G, 3), at their frames."""
    from scipy.interpolate import make_lsq_spline

    frame = np.arange(len(block), dtype=np.float64)
    spans = spans_of(len(block), spacing, degree, repeated)
    places = np.linspace(0.0, frame[-1], spans + 1)
    ends = np.full(degree + 1, places[0]), np.full(degree + 1, places[-1])
    knots = np.concatenate([ends[0], np.repeat(places[1:-1], repeated), ends[1]])
    return np.asarray(make_lsq_spline(frame, block, knots, k=degree)(frame))
