"""Least squares within bounds, of many targets at once: what to solve by which method.

Where the columns are well apart, block pivoting on normal equations finds the weights. Where they
are not, or where it does not, an active-set search does; and where several weights are as good, the
least of them are taken. What either finds is held against the conditions for a least sum of squares
(Karush, Kuhn & Tucker): weights that do not meet them are not given.
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
"""A combination of shapes that moves less than this share of what the largest moves is a tie."""

KKT = 1e-12
"""What the gradient may be that does not push against a bound, as a share of `noise`."""

_PLAIN = 1e-9
"""As long as no column lies closer to the others (squared sine), normal equations will do."""

_TIE = 5e-14
"""Up to this share of `noise`, a gradient is not evidence about the bound that a weight is at."""

_ROUNDS = 200
_MOST_RELEASES = 20
"""How many times each column may be freed."""


class Answer(NamedTuple):
    """Weights of N targets.

    Attributes
    ----------
    weights : (N, K) array of float64
        NaN where unsolved.
    unshared : (N,) array of bool
        Targets with several answers of which the least could not be determined.
    unsolved : (N,) array of bool
        Targets whose answer could not be found.
    """

    weights: Matrix
    unshared: Flags
    unsolved: Flags


def least_squares(columns: Matrix, targets: Matrix, low: float, high: float) -> Answer:
    """Return the weights w of least ``|sum(w[k] columns[k]) - target|^2`` within the bounds.

    Of several, those of the least norm.

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
        if len(self._columns) and np.isfinite(self._low) and self._plain:
            from nodegraph_blendshapes.solve import pivoting_kernel

            if self._work is None:
                self._work = pivoting_kernel.new_work(self._squares)
            weights = np.empty(len(self._columns))
            if pivoting_kernel.bounded_next(
                self._squares, target, self._work, _ROUNDS, KKT, weights
            ):
                return weights
            self._work = None
        return np.asarray(self.solve(target[None]).weights[0])

    def solve(self, targets: Matrix) -> Answer:
        """Return the weights of (N, R) targets."""
        columns = self._columns
        none = np.zeros(len(targets), dtype=np.bool_)
        if not len(columns):
            return Answer(np.zeros((len(targets), 0)), none, none)
        if np.isinf(self._low):
            projector, sizes, coordinates = self._singular_vectors
            return Answer((targets @ coordinates.T / sizes) @ projector.T, none, none)
        if not self._plain:
            return self._searched(targets)
        weights, solved = self._by_normal_equations(targets)
        if solved.all():
            return Answer(weights, none, none)
        left = self._searched(targets[~solved])
        weights[~solved] = left.weights
        return Answer(weights, none, unsolved=np.asarray(np.isnan(weights).any(axis=1)))

    @cached_property
    def _plain(self) -> bool:
        """Whether each column is well apart from all before it."""
        unit = self._columns / np.linalg.norm(self._columns, axis=1, keepdims=True)
        try:
            factor = np.linalg.cholesky(unit @ unit.T)
        except np.linalg.LinAlgError:
            return False
        return bool(np.diag(factor).min() ** 2 > _PLAIN)

    @cached_property
    def _singular_vectors(self) -> tuple[Matrix, Matrix, Matrix]:
        return _singular_vectors(self._columns)

    @cached_property
    def _squares(self) -> Any:
        return _squares(self._columns, self._low, self._high)

    def _by_normal_equations(self, targets: Matrix) -> tuple[Matrix, Flags]:
        """Return weights, and which of them are those of least squares."""
        from nodegraph_blendshapes.solve import pivoting_kernel

        columns, squares = self._columns, None
        if len(targets) > columns.shape[1] > len(columns):
            # no more coordinates than columns: what is at right angles to them all plays no part
            directions, triangle = np.linalg.qr(columns.T)
            columns, targets = np.ascontiguousarray(triangle.T), targets @ directions
            squares = _squares(columns, self._low, self._high)
        targets = np.ascontiguousarray(targets)
        weights = np.empty((len(targets), len(columns)))
        pivoting_kernel.bounded(
            squares or self._squares, targets, targets @ columns.T, _ROUNDS, weights
        )
        return weights, are_least(columns, targets, weights, self._low, self._high)

    def _searched(self, targets: Matrix) -> Answer:
        from nodegraph_blendshapes.solve import search_kernel

        low, high = self._low, self._high
        projector, sizes, coordinates = self._singular_vectors
        system = search_kernel.System(
            *(np.ascontiguousarray(array) for array in (self._columns, targets, coordinates))
        )
        columns = np.ascontiguousarray(projector * sizes)
        targets = np.ascontiguousarray(targets @ coordinates.T)
        lengths = np.linalg.norm(columns, axis=1)
        squares = search_kernel.Squares(columns, lengths, low, high)
        weights = np.empty((len(targets), len(columns)))
        free = np.empty(weights.shape, dtype=np.bool_)
        search_kernel.search(squares, targets, system, _MOST_RELEASES * len(columns), weights, free)
        unsolved = ~are_least(columns, targets, weights, low, high)
        lows, highs = _between(columns, targets, weights, low, high)
        several = np.any((lows < highs) & ~free, axis=1) & ~unsolved
        least, exact = _least(projector, weights[several], lows[several], highs[several])
        exact &= are_least(columns, targets[several], least, low, high)
        weights[np.flatnonzero(several)[exact]] = least[exact]
        weights[unsolved] = np.nan
        several[np.flatnonzero(several)[exact]] = False
        return Answer(weights, unshared=several, unsolved=unsolved)


def _squares(columns: Matrix, low: float, high: float) -> Any:
    from nodegraph_blendshapes.solve import pivoting_kernel

    lengths = np.linalg.norm(columns, axis=1)
    return pivoting_kernel.Squares(columns, columns @ columns.T, lengths, low, high)


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


def _singular_vectors(columns: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """Return the singular vectors and values that are not rounding."""
    projector, sizes, coordinates = np.linalg.svd(columns, full_matrices=False)
    rank = int(np.count_nonzero(sizes > RANK * sizes[0]))
    return np.ascontiguousarray(projector[:, :rank]), sizes[:rank], coordinates[:rank]


def _between(
    columns: Matrix, targets: Matrix, weights: Matrix, low: float, high: float
) -> tuple[Matrix, Matrix]:
    """Return between what each weight lies in every answer: those that are pushed do not move."""
    gradient = np.abs((weights @ columns - targets) @ columns.T)
    bound = (weights <= low) | (weights >= high)
    still = bound & (gradient > _TIE * noise(columns, targets, weights))
    return np.where(still, weights, low), np.where(still, weights, high)


def _least(projector: Matrix, weights: Matrix, lows: Matrix, highs: Matrix) -> tuple[Matrix, Flags]:
    """Return the weights of least norm of the same ``projector' w``, and which are exact."""
    solution, solved = _same(projector, weights @ projector, lows, highs)
    for frame in np.flatnonzero(~solved):
        # what can move may hardly do what is wanted in some direction: its own decomposition can
        low, high, moving = lows[frame], highs[frame], lows[frame] < highs[frame]
        own, *_ = _singular_vectors(projector[moving])
        wanted = weights[None, frame, moving] @ own
        solution[frame] = weights[frame]
        shared, exact = _same(own, wanted, low[None, moving], high[None, moving])
        solution[frame, moving], solved[frame] = shared[0], exact[0]
    return solution, solved


def _same(projector: Matrix, wanted: Matrix, lows: Matrix, highs: Matrix) -> tuple[Matrix, Flags]:
    from nodegraph_blendshapes.solve import share_kernel

    shared = np.empty_like(lows)
    solved = np.empty(len(lows), dtype=np.bool_)
    share_kernel.share(projector, wanted, lows, highs, shared, solved)
    return shared, solved
