"""What other markers predict, and a Gaussian process over time of what they leave."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.kept import kept_of
from nodegraph_fill.matern import Courses, Matern
from nodegraph_fill.ridge import nearest_first
from nodegraph_fill.tuning import Tune
from nodegraph_fill.whole_take import Estimate, whole_take
from nodegraph_mocap import Trajectories
from nodegraph_mocap.suspect import FACTOR, OPPOSITE, impulses, usual

if TYPE_CHECKING:
    from numpy.typing import NDArray

_PENALTY = 10.0
"""Ridge penalty, relative to the variance of the marker's errors of prediction."""
_SHORTER, _NOISIER, _LEAST_NOISE = 0.3, 1000.0, 1e-3
"""Length and noise of the process whose errors of prediction are learnt from, relative to the
medians of the markers' own, and the least relative noise."""
_AFTER = 3
"""Frames after a gap whose errors of prediction it touches."""
_FOLDS = 5
_REST_LENGTH, _REST_NOISE = 20.0, 1e-2
_REACH = 3.0
"""Lengths of the rest beyond a gap that count."""
_ROUNDING = 1e-8


@whole_take(
    "fill.kriging",
    cite=("cressie1993", "hoerl_kennard1970", "hartikainen_sarkka2010", "lei2018"),
    adapted=(
        "from universal kriging (Cressie 1993): the nearest markers, by ridge regression, are "
        "the trend, which itself has noise and a course in time"
    ),
)
def kriging(
    recording: Trajectories,
    gaps: Gaps,
    *,
    neighbours: Annotated[int, Field(ge=1), Tune(20, 40)] = 20,
) -> Estimate:
    """Fill gaps from other markers and from the marker's own course in time (kriging).

    Each coordinate of a marker, without its mean, is ``c[t] + r[t]``, seen with noise where the
    marker is present. c is what other markers tell of it, r the rest. They are independent
    Gaussian processes over time, with the Matern 5/2 covariance of `fill.gaussian_process`. All
    the time ``W x[t] = c[t] + noise`` is seen too, x being the coordinates of the nearest markers
    that are present all through the gap and at its ends, without their means over the frames in
    which the marker itself is present. The mean of ``c + r``, by a Kalman
    filter and smoother over three lengths of r around the gap, fills it: in the middle of long
    gaps what the others predict counts, near the ends, and in short gaps, the marker's own course.

    Ridge regression learns W (Hoerl & Kennard, 1970): the least
    ``sum |W e_x[t] - e[t]|^2 + penalty |W|^2``, over the frames in which the marker is present.
    e are the errors of predicting each marker from the frames before, by one Matern process for
    all of them: what drifts for long would otherwise count once per frame. That process has .3
    of the median length and 1,000 times the median relative noise (.001 at least) of the markers'
    own; the penalty is ten times the mean square of e. Gaps of the predictors are completed by
    the markers' own processes.

    c has length and variance of the marker's own process, of greatest likelihood; what is seen of
    it has the predictors' noise, weighted by W squared. r has length and variance of greatest
    likelihood for ``P - W x`` in each fifth of the take, W being learnt from the other four. A
    sample's noise is the lesser of the two. Constants were chosen on four real takes of a person
    and four made faces.

    Samples that look like an impulse, far off the midpoint of their two neighbours where both of
    these are off the other way (the rule by which `score.gaps` calls a truth suspect), or at the
    end of a gap with the one neighbour off, come out as they went in, but nothing is learnt
    from them.

    Written samples have a `sigma`, calibrated by held-out gaps as that of `fill.subspace_kalman`
    is, but of the error to the place itself: calibrated is the variance with a sample's noise,
    which is then taken off again. Intervals of 95 % held 92 to 97 % of the errors on made faces and
    two real takes, in gaps of 5, 15 and 45 frames, alone and of four neighbours at once; 90 to 97 %
    for `ends` met and white noise. Noise that a low-pass has left is movement to this method, and
    not part of sigma: of the errors to the movement without it, intervals held 32 to 94 %, the
    fewest in short gaps. Where fewer than ten gaps can be held out, sigma is NaN. For `ends` met,
    the estimate beside a gap is the mean of ``c + r`` there.

    Does not depend on where the origin lies, how the axes are turned, or the unit. The head's
    motion is learnt along with the face's: remove it first, where it is large.

    Looks at the whole take.

    Parameters
    ----------
    neighbours
        How many markers predict, fewer where there are fewer; without any, the marker's own
        course remains.
    """
    return _Processes.of(recording, neighbours).estimate(recording, gaps)


@dataclass(frozen=True)
class _Processes:
    """The processes of a take, learnt once.

    Attributes
    ----------
    own : list of Matern
        The process of each marker.
    near : (M, M - 1) array of int
        The others of each marker, the nearest first.
    neighbours : int
    rest : dict of int to Matern
        The process of what the nearest others leave of a marker, where it was asked for.
    """

    own: list[Matern]
    near: NDArray[np.intp]
    neighbours: int
    rest: dict[int, Matern] = field(default_factory=dict)

    @staticmethod
    def of(recording: Trajectories, neighbours: int) -> _Processes:
        kept = kept_of(recording)
        if _Processes not in kept:
            courses = _courses(recording)
            own = [courses.fitted(marker) for marker in range(len(recording.markers))]
            kept[_Processes] = own, nearest_first(recording)
        own, near = kept[_Processes]
        return _Processes(own, near, neighbours)

    def estimate(self, recording: Trajectories, gaps: Gaps) -> Estimate:
        """Return the estimate of some gaps of the take, or of the take with more gaps."""
        take = _Take.of(_courses(recording), self)
        positions, sigma = np.full((*gaps.shape, 3), np.nan), np.full(gaps.shape, np.nan)
        starts, stops = np.maximum(gaps.start - 1, 0), np.minimum(gaps.stop + 1, gaps.shape[0])
        gone = np.pad(np.cumsum(~recording.present, axis=0), ((1, 0), (0, 0)))
        whole = gone[stops] == gone[starts]
        for marker in np.unique(gaps.marker).tolist():
            near, some = self.near[marker], np.flatnonzero(gaps.marker == marker)
            predictors = [near[there[near]][: self.neighbours] for there in whole[some]]
            lesson = _Lesson.of(take, marker, [near[: self.neighbours], *predictors])
            if marker not in self.rest:
                self.rest[marker] = lesson.rest(near[: self.neighbours])
            for gap, others in zip(some, predictors, strict=True):
                window = slice(starts[gap], stops[gap])
                mean, variance = lesson.smoothed(others, window)
                positions[window, marker] = mean + take.courses.middle[marker]
                sigma[window, marker] = np.sqrt(variance)
        noise = np.array([own.noise for own in self.own])
        return Estimate(positions, sigma, noise=noise, again=self.estimate)


def _courses(recording: Trajectories) -> Courses:
    positions, present = recording.positions, recording.present
    middle = np.full(present.shape, np.nan)
    between = positions[1:-1] - (positions[:-2] + positions[2:]) / 2.0
    middle[1:-1] = np.linalg.norm(between, axis=2)
    off, limit = impulses(positions) > 0.0, FACTOR * usual(middle)
    for way in (slice(None), slice(None, None, -1)):
        off[way] |= _off_at_ends(present[way], middle[way], limit)
    return Courses.of(positions, present & ~off)


def _off_at_ends(
    present: NDArray[np.bool_], middle: NDArray[np.float64], limit: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Return which samples before a gap or the take's end, (T, M), look like an impulse.

    It takes the sample before off the midpoint of its two neighbours, and not the one before that.
    """
    off = np.zeros_like(present)
    off[3:-1] = ~present[4:]
    off[3:][-1:] = True
    off[3:] &= (middle[2:-1] > limit) & (middle[1:-2] < OPPOSITE * middle[2:-1])
    return off


@dataclass(frozen=True)
class _Take:
    """A take completed over time, its frames as columns, the coordinates of all markers as rows.

    Attributes
    ----------
    courses : Courses
    processes : _Processes
    completed : (3 M, T) array of float64
        The courses, where not seen as the marker's own process has them.
    errors : (3 M, T) array of float64
        Errors of predicting each column from the ones before, by one process for all markers.
    still : (T,) array of float64
        These of what is 1 all the time.
    noise : (3 M,) array of float64
        Variance of the noise of the samples.
    """

    courses: Courses
    processes: _Processes
    completed: NDArray[np.float64]
    errors: NDArray[np.float64]
    still: NDArray[np.float64]
    noise: NDArray[np.float64]

    @cached_property
    def rows(self) -> NDArray[np.intp]:
        """Where the coordinates of each marker are, (M, 3)."""
        return np.arange(len(self.completed)).reshape(-1, 3)

    @cached_property
    def folds(self) -> list[slice]:
        """Parts of the take, of the same length."""
        edges = np.linspace(0, self.completed.shape[1], _FOLDS + 1).astype(np.intp).tolist()
        return [slice(*pair) for pair in pairwise(edges)]

    @staticmethod
    def of(courses: Courses, processes: _Processes) -> _Take:
        from nodegraph_fill import matern_kernel

        completed, own = courses.rows.copy(), processes.own
        seen = np.asarray(courses.seen.any(axis=0))
        for marker in np.flatnonzero(seen & ~courses.seen.all(axis=0)).tolist():
            missing = ~courses.seen[:, marker]
            completed[missing, marker] = courses.smoothed(marker, own[marker])[0][missing]
        known = [each for each, some in zip(own, seen, strict=True) if some]
        length = _SHORTER * float(np.median([each.length for each in known]))
        noise = _NOISIER * float(np.median([each.noise / each.variance for each in known]))
        completed = completed.reshape(len(completed), -1)
        errors, whole = completed.copy(), np.ones(len(completed), dtype=np.bool_)
        errors = np.hstack([errors, np.ones((len(errors), 1))])
        matern_kernel.whiten(errors, whole, length, max(noise, _LEAST_NOISE))
        noises = np.repeat([each.noise for each in own], 3)
        completed, errors = (np.ascontiguousarray(each.T) for each in (completed, errors))
        return _Take(courses, processes, completed, errors[:-1], errors[-1], noises)


@dataclass(frozen=True)
class _Lesson:
    """What other markers tell about one.

    Attributes
    ----------
    take : _Take
    marker : int
    place : (M, 3) array of int
        Where the coordinates of each marker are in `squares`, those of the marker are last.
    squares : (folds, 3 N, 3 N) array of float64
        The products of the errors of prediction, summed over the frames of each fold.
    level : (3 M,) array of float64
        The mean of each coordinate over the frames in which the marker is seen.
    """

    take: _Take
    marker: int
    place: NDArray[np.intp]
    squares: NDArray[np.float64]
    level: NDArray[np.float64]

    @staticmethod
    def of(take: _Take, marker: int, predictors: list[NDArray[np.intp]]) -> _Lesson:
        """Return what some sets of markers tell about a marker."""
        known = take.courses.seen[:, marker].copy()
        for _ in range(_AFTER):
            known[1:] &= known[:-1]
        used = np.append(np.unique(np.concatenate(predictors)), marker)
        place = np.zeros_like(take.rows)
        place[used] = np.arange(3 * len(used)).reshape(-1, 3)
        seen = take.courses.seen[:, marker]
        level = take.completed @ seen / max(int(np.count_nonzero(seen)), 1)
        rows = take.rows[used].ravel()
        errors = (take.errors[rows] - np.outer(level[rows], take.still)) * known
        squares = np.stack([part @ part.T for part in (errors[:, each] for each in take.folds)])
        return _Lesson(take, marker, place, squares, level)

    def rest(self, predictors: NDArray[np.intp]) -> Matern:
        """Return the process of what predictors leave of frames that were not learnt from."""
        completed, left = self.take.completed, []
        for frames, square in zip(self.take.folds, self.squares, strict=True):
            weights = self._weights(self._total - square, predictors)
            others = weights @ completed[:, frames] - (weights @ self.level)[:, None]
            left.append(completed[3 * self.marker :][:3, frames] - others)
        seen = self.take.courses.seen[:, self.marker]
        return Matern.fitted(np.hstack(left).T, seen, _REST_LENGTH, _REST_NOISE)

    def smoothed(
        self, predictors: NDArray[np.intp], frames: slice
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return mean, (F, 3), and variance, (F,), of the marker in some frames."""
        from nodegraph_fill import matern_kernel

        courses, processes = self.take.courses, self.take.processes
        own, rest = processes.own[self.marker], processes.rest[self.marker]
        reach = math.ceil(_REACH * rest.length)
        first = max(frames.start - reach, 0)
        window = slice(first, frames.stop + reach)
        weights = self._weights(self._total, predictors)
        noise = float((weights * weights).sum(axis=0) @ self.take.noise) / 3.0
        rows = courses.rows[window, self.marker]
        values, seen = np.empty((len(rows), 2, 3)), np.empty((len(rows), 2), dtype=np.bool_)
        others = weights @ self.take.completed[:, window] - (weights @ self.level)[:, None]
        values[:, 0], values[:, 1] = others.T, rows
        seen[:, 0], seen[:, 1] = len(predictors) > 0, courses.seen[window, self.marker]
        return matern_kernel.smooth(
            np.array([own.length, rest.length]),
            np.array([own.variance, rest.variance]),
            np.maximum(
                [noise, min(own.noise, rest.noise)], _ROUNDING * (own.variance + rest.variance)
            ),
            values,
            seen,
            frames.start - first,
            frames.stop - first,
        )

    @cached_property
    def _total(self) -> NDArray[np.float64]:
        return np.asarray(self.squares.sum(axis=0))

    def _weights(
        self, squares: NDArray[np.float64], predictors: NDArray[np.intp]
    ) -> NDArray[np.float64]:
        """Return the weights of all coordinates, (3, 3 M), 0 but for those of the predictors."""
        from scipy.linalg.lapack import dposv

        weights = np.zeros((3, len(self.take.completed)))
        columns = self.place[predictors].ravel()
        total = squares[-1, -1] + squares[-2, -2] + squares[-3, -3]
        penalty = _PENALTY * total / (3.0 * self.take.completed.shape[1])
        if len(columns) and penalty > 0.0:
            products = squares.take(columns, axis=0).take(columns, axis=1)
            products.flat[:: len(columns) + 1] += penalty
            # symmetric, so that it need not be copied into Fortran's order
            solution = dposv(products.T, squares[columns, -3:], overwrite_a=True)[1]
            weights[:, self.take.rows[predictors].ravel()] = solution.T
        return weights
