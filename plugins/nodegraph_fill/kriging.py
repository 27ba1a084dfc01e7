"""What other markers predict, and a Gaussian process over time of what they leave."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.matern import Courses, Matern
from nodegraph_fill.ridge import nearest_first
from nodegraph_fill.whole_take import Estimate, whole_take
from nodegraph_mocap import Trajectories
from nodegraph_mocap.suspect import FACTOR, OPPOSITE, impulses

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_fill.matern_kernel import System

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
_CHANNELS = np.array([[1.0, 0.0, 0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 1.0, 0.0, 0.0]])
"""What others predict shows the common part, a sample the common part and the rest."""


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
    neighbours: Annotated[int, Field(ge=1)] = 20,
) -> Estimate:
    """Fill gaps from other markers and from the course in time of what they leave (kriging).

    Each coordinate of a marker, without its mean, is ``c[t] + r[t]``, seen with noise where the
    marker is present. c is what other markers tell of it, r the rest. They are independent
    Gaussian processes over time, with the Matern 5/2 covariance of `fill.gaussian_process`. All
    the time ``W x[t] = c[t] + noise`` is seen too, x being the coordinates of the nearest markers
    that are present all through the gap and at its ends. The mean of ``c + r``, by a Kalman
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
    which is then taken off again. Where fewer than ten gaps can be held out, sigma is NaN. For
    `ends` met, the estimate beside a gap is the mean of ``c + r`` there.

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
        Of each marker.
    near : (M, M - 1) array of int
        The others of each marker, the nearest first.
    neighbours : int
    rest : dict of int to Matern
        What the nearest others leave of a marker, where it was asked for.
    """

    own: list[Matern]
    near: NDArray[np.intp]
    neighbours: int
    rest: dict[int, Matern] = field(default_factory=dict)

    @staticmethod
    def of(recording: Trajectories, neighbours: int) -> _Processes:
        courses = _courses(recording)
        own = [courses.fitted(marker) for marker in range(len(recording.markers))]
        return _Processes(own, nearest_first(recording), neighbours)

    def estimate(self, recording: Trajectories, gaps: Gaps) -> Estimate:
        """Return the estimate of some gaps of the take, or of the take with more gaps."""
        take = _Take.of(_courses(recording), self)
        positions, sigma = np.full((*gaps.shape, 3), np.nan), np.full(gaps.shape, np.nan)
        starts, stops = np.maximum(gaps.start - 1, 0), np.minimum(gaps.stop + 1, gaps.shape[0])
        for marker in np.unique(gaps.marker).tolist():
            near = self.near[marker]
            windows = [
                slice(*window)
                for window in np.stack([starts, stops], axis=1)[gaps.marker == marker].tolist()
            ]
            whole = [np.asarray(recording.present[each].all(axis=0)) for each in windows]
            predictors = [near[there[near]][: self.neighbours] for there in whole]
            lesson = _Lesson.of(take, marker, [near[: self.neighbours], *predictors])
            if marker not in self.rest:
                self.rest[marker] = lesson.rest(near[: self.neighbours])
            for window, some in zip(windows, predictors, strict=True):
                mean, variance = lesson.smoothed(some, window)
                positions[window, marker] = mean + take.courses.middle[marker]
                sigma[window, marker] = np.sqrt(variance)
        noise = np.array([own.noise for own in self.own])
        return Estimate(positions, sigma, noise=noise, again=self.estimate)


def _courses(recording: Trajectories) -> Courses:
    positions = recording.positions
    off = (impulses(positions) > 0.0) | _off_at_ends(positions)
    off |= _off_at_ends(positions[::-1])[::-1]
    return Courses.of(positions, recording.present & ~off)


def _off_at_ends(positions: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which samples before a gap or the take's end, (T, M), look like an impulse.

    It takes the sample before off the midpoint of its two neighbours, and not the one before that.
    """
    middle = np.linalg.norm(positions[1:-1] - (positions[:-2] + positions[2:]) / 2.0, axis=2)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of a marker that has none
        usual = np.nanmedian(middle, axis=0) if len(middle) else np.full(positions.shape[1], np.nan)
    off = np.zeros(positions.shape[:2], dtype=np.bool_)
    last = np.pad(np.isnan(positions[4:, :, 0]), ((0, 1), (0, 0)), constant_values=True)
    off[3:] = last[: len(off[3:])]
    off[3:] &= (middle[1:] > FACTOR * usual) & (middle[:-1] < OPPOSITE * middle[1:])
    return off


@dataclass(frozen=True)
class _Take:
    """A take completed over time.

    Attributes
    ----------
    courses : Courses
    processes : _Processes
    completed : (T, M, 3) array of float64
        The rows, where not seen as the marker's own process has them.
    errors : (T, M, 3) array of float64
        Those of predicting each row from the rows before, by one process for all markers.
    """

    courses: Courses
    processes: _Processes
    completed: NDArray[np.float64]
    errors: NDArray[np.float64]

    @cached_property
    def folds(self) -> list[slice]:
        """Parts of the take, of the same length."""
        edges = np.linspace(0, len(self.errors), _FOLDS + 1).astype(np.intp).tolist()
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
        errors = completed.reshape(len(completed), -1).copy()
        whole = np.ones(len(errors), dtype=np.bool_)
        matern_kernel.whiten(errors, whole, length, max(noise, _LEAST_NOISE))
        return _Take(courses, processes, completed, errors.reshape(completed.shape))


@dataclass(frozen=True)
class _Lesson:
    """What other markers tell about one.

    Attributes
    ----------
    take : _Take
    marker : int
    place : (M,) array of int
        Where the coordinates of each marker are in `squares`, those of the marker are last.
    squares : (folds, 3 N, 3 N) array of float64
        The products of the errors of prediction, summed over the frames of each fold.
    """

    take: _Take
    marker: int
    place: NDArray[np.intp]
    squares: NDArray[np.float64]

    @staticmethod
    def of(take: _Take, marker: int, predictors: list[NDArray[np.intp]]) -> _Lesson:
        """Return what some sets of markers tell about a marker."""
        gone = ~take.courses.seen[:, marker]
        for _ in range(_AFTER):
            gone[1:] |= gone[:-1]
        used = np.append(np.unique(np.concatenate(predictors)), marker)
        place = np.zeros(len(take.processes.own), dtype=np.intp)
        place[used] = 3 * np.arange(len(used))
        errors = take.errors[:, used].reshape(len(gone), -1)
        errors[gone] = 0.0
        squares = np.stack([errors[frames].T @ errors[frames] for frames in take.folds])
        return _Lesson(take, marker, place, squares)

    def rest(self, predictors: NDArray[np.intp]) -> Matern:
        """Return the process of what predictors leave of frames that were not learnt from."""
        rows, left = self.take.completed, []
        for frames, square in zip(self.take.folds, self.squares, strict=True):
            weights = self._weights(self._total - square, predictors)
            left.append(rows[frames, self.marker] - self._predicted(frames, predictors, weights))
        seen = self.take.courses.seen[:, self.marker]
        return Matern.fitted(np.concatenate(left), seen, _REST_LENGTH, _REST_NOISE)

    def smoothed(
        self, predictors: NDArray[np.intp], frames: slice
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return mean, (F, 3), and variance, (F,), of the marker in some frames."""
        from nodegraph_fill import matern_kernel

        take, marker = self.take, self.marker
        own, rest = take.processes.own[marker], take.processes.rest[marker]
        reach = math.ceil(_REACH * rest.length)
        first = max(frames.start - reach, 0)
        window = slice(first, frames.stop + reach)
        weights = self._weights(self._total, predictors)
        predicted = self._predicted(window, predictors, weights)
        values = np.stack([predicted, take.courses.rows[window, marker]], axis=1)
        seen = np.stack([np.ones(len(values), np.bool_), take.courses.seen[window, marker]], axis=1)
        seen[:, 0] = len(predictors) > 0
        noise = np.repeat([take.processes.own[each].noise for each in predictors], 3)
        noises = [float(noise @ (weights**2).mean(axis=1)), min(own.noise, rest.noise)]
        return matern_kernel.smooth(
            _sum(own, rest),
            _CHANNELS,
            np.maximum(noises, _ROUNDING * (own.variance + rest.variance)),
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
        """Return the weights of the predictors' coordinates, (3 N, 3)."""
        from scipy.linalg.lapack import dposv

        columns = (self.place[predictors, None] + np.arange(3)).ravel()
        penalty = _PENALTY * np.trace(squares[-3:, -3:]) / (3.0 * len(self.take.errors))
        if not (len(columns) and penalty > 0.0):
            return np.zeros((len(columns), 3))
        products = squares[np.ix_(columns, columns)]
        products.flat[:: len(columns) + 1] += penalty
        return np.asarray(dposv(products, squares[columns, -3:])[1])

    def _predicted(
        self, frames: slice, predictors: NDArray[np.intp], weights: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        rows = self.take.completed[frames, predictors]
        return np.asarray(rows.reshape(len(rows), len(weights)) @ weights)


def _sum(first: Matern, second: Matern) -> System:
    """Return the linear system of two independent processes, as `matern_kernel.smooth` takes it."""
    from nodegraph_fill import matern_kernel

    system = np.zeros((3, 6, 6))
    for each, half in ((first, slice(0, 3)), (second, slice(3, 6))):
        one, other, third = matern_kernel.transition(each.length)
        system[:, half, half] = one, each.variance * other, each.variance * third
    moves, drift, still = system
    return moves, drift, still
