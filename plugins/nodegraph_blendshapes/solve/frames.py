"""Weights of each frame by itself: frames that have the same markers are solved together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph_blendshapes.solve.bounded import least_squares
from nodegraph_blendshapes.solve.problem import Problem, moves

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]
    Flags = NDArray[np.bool_]


class Solved(NamedTuple):
    """Weights of the shapes, and what to warn of.

    Attributes
    ----------
    values : (T, K) array of float64
        NaN in frames without any marker; 0 where a shape is not seen.
    unseen : (T, K) array of bool
        Shapes that the recording sees, but none of the markers present in that frame.
    unsolved : (T,) array of bool
        Frames whose answer could not be found; their weights are NaN too.
    """

    values: Matrix
    unseen: Flags
    unsolved: Flags

    @classmethod
    def empty(cls, problem: Problem) -> Solved:
        """Return weights of 0, missing where no marker is."""
        values = np.zeros((len(problem.offsets), len(problem.shapes)))
        values[~problem.present.any(axis=1)] = np.nan
        unsolved = np.zeros(len(values), dtype=np.bool_)
        return cls(values, np.zeros(values.shape, dtype=np.bool_), unsolved)


@dataclass(frozen=True)
class Pattern:
    """Frames in which the same markers are present.

    Attributes
    ----------
    frames : (N,) array of int
    columns : (K, R) array of float64
        Change of the markers' coordinates by each of the shapes that are seen there.
    targets : (N, R) array of float64
    shapes : (K,) array of int
        Their places among all of the model's.
    """

    frames: NDArray[np.intp]
    columns: Matrix
    targets: Matrix
    shapes: NDArray[np.intp]


def patterns(problem: Problem, ridge: float) -> Iterator[Pattern]:
    """Yield the frames by which markers they have, the earliest first; none of empty frames."""
    packed = np.packbits(problem.present, axis=1)
    _, first, which = np.unique(packed, axis=0, return_index=True, return_inverse=True)
    by_pattern = np.split(
        np.argsort(which.ravel(), kind="stable"), np.cumsum(np.bincount(which.ravel()))[:-1]
    )
    for number in np.argsort(first):
        frames = by_pattern[number]
        there = problem.present[frames[0]]
        if not there.any():
            continue
        shapes, columns = columns_of(problem, there, ridge)
        targets = problem.offsets[np.ix_(frames, there)].reshape(len(frames), -1)
        targets = np.pad(targets, ((0, 0), (0, columns.shape[1] - targets.shape[1])))
        yield Pattern(frames, columns, targets, shapes)


def columns_of(problem: Problem, there: Flags, ridge: float) -> tuple[NDArray[np.intp], Matrix]:
    """Return which shapes (M,) markers show, and what each does to their coordinates, (K, R).

    A ridge is one more coordinate for each shape, which its weight moves away from 0.
    """
    shapes = np.flatnonzero(moves(problem.shapes[:, there]))
    columns = problem.shapes[np.ix_(shapes, there)].reshape(len(shapes), 3 * there.sum())
    if ridge:
        columns = np.hstack([columns, np.sqrt(ridge) * np.eye(len(shapes))])
    return shapes, columns


def solve_frames(problem: Problem, low: float, high: float, ridge: float) -> Solved:
    """Return the weights of least squares within the bounds, frame by frame.

    Parameters
    ----------
    problem
    low, high
        The bounds: both infinite, or `low` finite.
    ridge
        Factor of the weights' squares, mm^2.
    """
    solved = Solved.empty(problem)
    for pattern in patterns(problem, ridge):
        solution = least_squares(pattern.columns, pattern.targets, low, high)
        solved.values[np.ix_(pattern.frames, pattern.shapes)] = solution.weights
        solved.values[pattern.frames[solution.unsolved]] = np.nan
        solved.unsolved[pattern.frames] = solution.unsolved
        solved.unseen[np.ix_(pattern.frames, problem.seen)] = True
        solved.unseen[np.ix_(pattern.frames, pattern.shapes)] = False
    return solved
