"""Each marker's own course, smooth in its cosine transform."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.matern import Courses
from nodegraph_fill.whole_take import Estimate, whole_take
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_LEAST, _MOST = math.log10(0.0017), 12.0
"""Limits of the logarithm of s. At the first, which is Garcia's, nothing is smoothed; at the other,
no bend shorter than 4,000 frames is left."""
_STEP = 0.1
"""How exactly the logarithm of s is sought."""


@whole_take("fill.dct", cite="garcia2010")
def dct(recording: Trajectories, gaps: Gaps) -> Estimate:
    """Fill gaps by the smooth course of least cross-validated error, in cosines (Garcia, 2010).

    A marker's course x over the T frames has the least
    ``sum |P[t] - x[t]|^2 + s sum |x[t - 1] - 2 x[t] + x[t + 1]|^2``, the first sum over its
    present samples, and in the second ``x[-1] = x[0]`` and ``x[T] = x[T - 1]``. In the discrete
    cosine transform (DCT-II), smoothing is to multiply the k-th coefficient by
    ``g_k = 1 / (1 + s (2 - 2 cos(pi k / T))^2)``. Garcia puts x in place of missing samples,
    transforms, multiplies and transforms back, and repeats that; here the linear equations are
    solved at which this ends.

    s is the one of least score of the generalized cross-validation,
    ``sum |P[t] - x[t]|^2 / n / (1 - sum g_k / T)^2`` with n present samples, and .0017 at least,
    the same for the three coordinates of a marker.

    Zhang et al. say of Edge et al. that they reconstruct missing segments by this transform, too,
    but not how.

    Does not depend on where the origin lies, how the axes are turned, or the unit.

    Looks at the whole take.
    """
    courses = Courses.of(recording.positions, recording.present)
    positions = np.full((*gaps.shape, 3), np.nan)
    for marker in np.unique(gaps.marker):
        course = _smooth(courses.rows[:, marker], courses.seen[:, marker])
        positions[:, marker] = course + courses.middle[marker]
    return Estimate(positions)


def _smooth(rows: NDArray[np.float64], seen: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return the course through rows, (T, 3), where seen."""
    from scipy.linalg.lapack import dpbsv
    from scipy.optimize import minimize_scalar

    frames, squares = len(rows), np.asfortranarray(_squared_bends(len(rows)))
    waves = (2.0 - 2.0 * np.cos(np.pi * np.arange(frames) / frames)) ** 2

    def course(logarithm: float) -> NDArray[np.float64]:
        equations = 10.0**logarithm * squares
        equations[-1] += seen
        # as `solveh_banded` does, which takes longer to look at what it is given
        return np.asarray(dpbsv(equations, rows, overwrite_ab=True)[1])

    def score(logarithm: float) -> float:
        left = (rows - course(logarithm))[seen]
        free = np.mean(1.0 - 1.0 / (1.0 + 10.0**logarithm * waves))
        return float(np.log(np.sum(left * left)) - 2.0 * np.log(free))

    if not rows.any():
        return rows
    found = minimize_scalar(score, bounds=(_LEAST, _MOST), options={"xatol": _STEP})
    return course(found.x)


def _squared_bends(frames: int) -> NDArray[np.float64]:
    """Return the matrix of the sum of squared second differences, its upper bands, (3, T)."""
    bands = np.zeros((3, frames))
    bands[0], bands[1], bands[2] = 1.0, -4.0, 6.0
    bands[1, [1, -1]], bands[2, [0, -1]] = -3.0, 2.0
    return bands
