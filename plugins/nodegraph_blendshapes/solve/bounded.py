"""Least squares within bounds, of many targets at once.

Block pivoting on normal equations finds the weights; where columns depend on each other, with a
ridge that is taken back. What it finds is held against the conditions for a least sum of squares
(Karush, Kuhn & Tucker). Weights that do not meet them are not given.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]
    Flags = NDArray[np.bool_]

RANK = 1e-12
"""Without bounds, a combination of shapes that moves a smaller share than this does not count."""

KKT = 1e-11
"""What the gradient may be that does not push against a bound, as a share of `noise`."""

RIDGE = 1e-9
"""The ridge, as a share of the square of the longest column."""

_PLAIN = 1e-9
"""As long as no column lies closer to the others (squared sine), no ridge is needed."""

_ROUNDS = 100_000


class BoundedSolution(NamedTuple):
    """Weights of N targets.

    Attributes
    ----------
    weights : (N, K) array of float64
        NaN where unsolved.
    unsolved : (N,) array of bool
        Targets whose answer could not be found.
    """

    weights: Matrix
    unsolved: Flags


def least_squares(columns: Matrix, targets: Matrix, low: float, high: float) -> BoundedSolution:
    """Return the weights w of least ``|sum(w[k] columns[k]) - target|^2`` within the bounds.

    Of several, those of the least norm, but for `RIDGE`.

    Parameters
    ----------
    columns : (K, R) array of float64
        None of them 0.
    targets : (N, R) array of float64
    low, high
        Both infinite, or `low` finite, and 0 not outside of them.
    """
    return System(columns, low, high).solve(targets)


class System:
    """Columns and bounds, and what follows from them whatever the targets; see `least_squares`."""

    def __init__(self, columns: Matrix, low: float, high: float) -> None:
        self._columns = np.ascontiguousarray(columns)
        self._low, self._high = low, high
        self._work: Any = None

    def solve_next(self, target: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the (K,) weights of one target, (R,), sooner if those of the last are near them.

        NaN if they could not be found.
        """
        columns = self._columns
        if len(columns) and np.isfinite(self._low):
            from nodegraph_blendshapes.solve import pivoting_kernel

            if self._work is None:
                self._work = pivoting_kernel.new_work(len(columns))
            weights, solved = np.empty((1, len(columns))), np.empty(1, dtype=np.bool_)
            linears = (columns @ target)[None]
            work = self._work
            pivoting_kernel.bounded(
                self._squares, target[None], linears, work, _ROUNDS, KKT, weights, solved
            )
            if solved[0]:
                return np.asarray(weights[0])
            if self._squares.ridge:  # `solve` would search again in the same way
                return np.full(len(columns), np.nan)
        return np.asarray(self.solve(target[None]).weights[0])

    def solve(self, targets: Matrix) -> BoundedSolution:
        """Return the weights of (N, R) targets."""
        columns = self._columns
        none = np.zeros(len(targets), dtype=np.bool_)
        if not len(columns):
            return BoundedSolution(np.zeros((len(targets), 0)), none)
        if np.isinf(self._low):
            return BoundedSolution(targets @ np.linalg.pinv(columns, rcond=RANK), none)
        from nodegraph_blendshapes.solve import pivoting_kernel

        squares, share = self._squares, KKT
        if not squares.ridge:
            share = np.inf  # all at once, below
            if len(targets) > columns.shape[1] > len(columns):
                # what is at right angles to all columns plays no part
                directions, triangle = np.linalg.qr(columns.T)
                columns, targets = np.ascontiguousarray(triangle.T), targets @ directions
                squares = squares._replace(columns=columns)
        targets = np.ascontiguousarray(targets)
        weights, solved = np.empty((len(targets), len(columns))), np.empty_like(none)
        linears, work = targets @ columns.T, pivoting_kernel.new_work(len(columns))
        pivoting_kernel.bounded(squares, targets, linears, work, _ROUNDS, share, weights, solved)
        if not squares.ridge:
            solved = are_least(columns, targets, weights, self._low, self._high)
            again = np.flatnonzero(~solved)
            found, least = np.empty((len(again), len(columns))), np.empty(len(again), np.bool_)
            some = targets[again], linears[again]
            pivoting_kernel.bounded(squares, *some, work, _ROUNDS, KKT, found, least)
            weights[again], solved[again] = found, least
        weights[~solved] = np.nan
        return BoundedSolution(weights, ~solved)

    @cached_property
    def _squares(self) -> Any:
        from nodegraph_blendshapes.solve import pivoting_kernel

        columns = self._columns
        gram, lengths = columns @ columns.T, np.linalg.norm(columns, axis=1)
        ridge = 0.0 if _are_apart(columns / lengths[:, None]) else RIDGE * lengths.max() ** 2
        gram += ridge * np.eye(len(gram))
        return pivoting_kernel.Squares(columns, gram, lengths, self._low, self._high, ridge)


def _are_apart(unit: Matrix) -> bool:
    """Return whether each column is well apart from all before it."""
    try:
        factor = np.linalg.cholesky(unit @ unit.T)
    except np.linalg.LinAlgError:
        return False
    return bool(np.diag(factor).min() ** 2 > _PLAIN)


def inwards(columns: Matrix, targets: Matrix, weights: Matrix, low: float, high: float) -> Matrix:
    """Return the (N, K) gradient of half the squares, 0 where it pushes a weight at its bound."""
    gradient = (weights @ columns - targets) @ columns.T
    out = (weights <= low) & (gradient > 0.0) | (weights >= high) & (gradient < 0.0)
    return np.where(out, 0.0, gradient)


def noise(columns: Matrix, targets: Matrix, weights: Matrix) -> Matrix:
    """Return what the (N, K) gradients are sums of: ``|column| (|target| + sum(|w| |column|))``."""
    lengths = np.linalg.norm(columns, axis=1)
    return np.outer(np.linalg.norm(targets, axis=1) + np.abs(weights) @ lengths, lengths)


def are_least(columns: Matrix, targets: Matrix, weights: Matrix, low: float, high: float) -> Flags:
    """Return which of (N, K) weights, within the bounds, are those of least squares."""
    small = np.abs(inwards(columns, targets, weights, low, high)) <= KKT * noise(
        columns, targets, weights
    )
    return np.asarray(small.all(axis=1))
