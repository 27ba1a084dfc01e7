"""A Gaussian process over time of each marker by itself."""

from __future__ import annotations

import numpy as np

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.matern import Courses, Matern
from nodegraph_fill.whole_take import Estimate, whole_take
from nodegraph_mocap import Trajectories


@whole_take(
    "fill.gaussian_process",
    cite=("rasmussen_williams2006", "hartikainen_sarkka2010", "lei2018"),
)
def gaussian_process(recording: Trajectories, gaps: Gaps) -> Estimate:
    """Fill gaps by a Gaussian process over time, a marker by itself (Rasmussen & Williams, 2006).

    Each coordinate of a marker without its mean is ``x[t] + v[t]``: x a Gaussian process of the
    covariance ``s^2 (1 + d + d^2 / 3) exp(-d)`` with ``d = sqrt(5) |t - u| / l`` (Matern 5/2: a
    curve of two continuous derivatives), v noise of the variance n. Length l, variance s^2 and
    noise n are those of the greatest likelihood, the same for the three coordinates: s^2 is known
    from the other two, and the logarithms of l and of n / s^2 are sought in steps down to 0.15 and
    0.4, on 2,000 frames in a row at most. The mean of x, all present samples being known, fills
    the gaps. The process is the state of a linear system of three dimensions (Hartikainen &
    Sarkka, 2010), so that a Kalman filter and smoother give all this in a time that grows with
    the frames.

    Short gaps are its strength: it is as smooth as the marker is. In long ones it returns to the
    marker's mean. For `ends` met, the estimate beside a gap is the mean of x there.

    Written samples have a `sigma` that is calibrated by held-out gaps, as that of
    `fill.subspace_kalman` is: to what is measured there, noise and impulses included. Where fewer
    than ten gaps can be held out, sigma is NaN.

    Does not depend on where the origin lies, how the axes are turned, or the unit.

    Looks at the whole take.
    """
    return _estimate(recording, gaps, {})


def _estimate(recording: Trajectories, gaps: Gaps, processes: dict[int, Matern]) -> Estimate:
    courses = Courses.of(recording.positions, recording.present)
    positions, sigma = np.full((*gaps.shape, 3), np.nan), np.full(gaps.shape, np.nan)
    for marker in np.unique(gaps.marker).tolist():
        if marker not in processes:
            processes[marker] = courses.fitted(marker)
        process = processes[marker]
        mean, variance = courses.smoothed(marker, process)
        positions[:, marker] = mean + courses.middle[marker]
        sigma[:, marker] = np.sqrt(variance + process.noise)
    return Estimate(
        positions,
        sigma,
        again=lambda recording, gaps: _estimate(recording, gaps, processes),
    )
