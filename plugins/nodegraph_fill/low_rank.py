"""The take completed to a matrix of small nuclear norm, without any complete frame."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_fill.whole_take import TakeMatrix

_MOST_ROUNDS = 1000
_NEAR, _SETTLED = 1e-3, 1e-11
"""How little, relative to the root mean square of what is known, a round may change: before
Newton's step is tried, and at the end.
"""
_ROUNDING = 10.0 * float(np.finfo(np.float64).eps)
_MEMORY = 10
"""Rounds that the extrapolation looks back."""
_MOST_TURNS, _REST = 100, 1e-3
"""Of conjugate gradients: their number, and the share of the gradient that they leave."""


@dataclass(frozen=True)
class Principal:
    """Where completed rows vary most.

    Attributes
    ----------
    middle : (P,) array of float64
        Their mean.
    basis : (P, D) array of float64
        Orthogonal columns of length 1, the one along which they vary most first.
    variances : (D,) array of float64
        Along each, mm^2.
    total : float
        The variance along all directions, mm^2.
    """

    middle: NDArray[np.float64]
    basis: NDArray[np.float64]
    variances: NDArray[np.float64]
    total: float


class LowRank:
    """The matrix completed; see `fill.soft_impute` for what is sought.

    The missing entries that are sought make ``f = sum h(d_i)`` least, d the singular values of the
    completed matrix X and ``h(d) = d^2 / 2`` up to s, ``s d - s^2 / 2`` beyond: what is left of
    ``|X - Z|^2 / 2 + s |Z|_*`` when Z is the best for X. Its gradient is ``X K`` with
    ``K = V min(1, s / d) V'`` from the singular value decomposition of X. As h is concave in d^2,
    the quadratic ``x' K x / 2`` summed over the rows x touches f from above at any X. Its least is
    found row by row, gives the next X, and so on, from straight lines through the gaps, each X
    extrapolated from the latest rounds by Anderson's mixing. Where these rounds change little,
    Newton's step follows, by conjugate gradients that the quadratic conditions; where it does not
    come nearer, more rounds do. The sum only needs the rows that have missing entries.

    Parameters
    ----------
    matrix
        The take.
    shrinkage
        s as a share of the largest singular value of the rows with zeros where missing.
    near
        The completion of nearly the same take, to begin from; none: from straight lines.

    Attributes
    ----------
    rows : (T, P) array of float64
        Completed.
    precision : (P, P) array of float64
        K at the solution.
    """

    rows: NDArray[np.float64]
    precision: NDArray[np.float64]

    def __init__(self, matrix: TakeMatrix, shrinkage: float, near: LowRank | None = None) -> None:
        self.rows = matrix.rows.copy()
        lacking = matrix.missing.any(axis=1)
        whole, some = matrix.rows[~lacking], matrix.rows[lacking]
        self._missing, self._constant = _Entries(matrix.missing[lacking]), whole.T @ whole
        square = float(np.linalg.eigvalsh(self._constant + some.T @ some)[-1])
        self._threshold = shrinkage * math.sqrt(max(square, 0.0))
        # 0 only if nothing ever moves
        self.precision = np.eye(matrix.rows.shape[1])
        if self._threshold:
            size = float(np.linalg.norm(matrix.rows)) / math.sqrt(
                matrix.rows.size - np.count_nonzero(matrix.missing)
            )
            if near is None:
                some = matrix.with_lines()[lacking]
            else:
                some = near.completed(some, self._missing.mask)
            self._solve(some, size, size * max(_SETTLED, _ROUNDING / shrinkage))
            self.rows[lacking] = some

    def completed(
        self, rows: NDArray[np.float64], missing: NDArray[np.bool_]
    ) -> NDArray[np.float64]:
        """Return other rows completed by the same K: each x to the least ``x' K x``."""
        entries, filled = _Entries(missing), np.where(missing, 0.0, rows)
        filled[missing] = -entries.solved(self.precision, (filled @ self.precision)[missing])
        return filled

    def principal(self, share: float) -> Principal:
        """Return the principal subspace of the completed rows that has a share of the variance."""
        middle = self.rows.mean(axis=0)
        rows = self.rows - middle
        squares, vectors = np.linalg.eigh(rows.T @ rows / len(rows))
        variances = np.maximum(squares[::-1], 0.0)
        reached = np.cumsum(variances)
        size = 1 + int(np.searchsorted(reached, share * reached[-1]))
        basis = np.ascontiguousarray(vectors[:, ::-1][:, :size])
        return Principal(middle, basis, variances[:size], float(reached[-1]))

    def _solve(self, rows: NDArray[np.float64], size: float, settled: float) -> None:
        """Write the missing entries of the rows that have some.

        Parameters
        ----------
        rows
            With a first guess.
        size, settled
            The root mean square of what is known, and how little the last step may change, mm.
        """
        missing, mixing = self._missing, _Mixing(len(rows[self._missing.mask]))
        near, before, lower = _NEAR * size, math.inf, rows[missing.mask]
        for _ in range(_MOST_ROUNDS):
            spectrum = _Spectrum.of(self._constant + rows.T @ rows, self._threshold)
            self.precision = spectrum.precision
            gradient = (rows @ self.precision)[missing.mask]
            step = missing.solved(self.precision, gradient)
            change = float(np.abs(step).max(initial=0.0))
            if change <= settled:
                return
            if change > before:
                # Newton's step went too far
                rows[missing.mask], near, before = lower, near / 10.0, math.inf
                continue
            lower = rows[missing.mask] - step
            if change <= near:
                rows[missing.mask] -= missing.newton(spectrum, rows, gradient, settled)
                before = change
            else:
                rows[missing.mask] = mixing.extrapolated(lower, -step)
        warnings.warn(
            f"completing the take has not settled after {_MOST_ROUNDS} rounds: the last one "
            f"still changed a coordinate by {change:.1g} mm",
            stacklevel=6,
        )


class _Mixing:
    """Anderson's extrapolation of a sequence, each from the latest ones and their steps.

    Begun anew whenever a step is longer than the one before.
    """

    def __init__(self, size: int) -> None:
        self._turn, self._length = 0, math.inf
        # what the solution and the step have changed by, in each of the latest rounds
        self._changes, self._latest = np.zeros((2, _MEMORY, size)), np.zeros((2, size))

    def extrapolated(
        self, solution: NDArray[np.float64], step: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return where to go on from a solution that a step has led to."""
        self._changes[:, self._turn % _MEMORY] = (solution, step) - self._latest
        self._latest[:] = solution, step
        length, longest = float(step @ step), self._length
        if not self._turn or length > longest:
            self._changes[:] = 0.0
        self._turn, self._length = self._turn + 1, length
        solutions, steps = self._changes
        shares = np.linalg.lstsq(steps @ steps.T, steps @ step)[0]
        return np.asarray(solution - shares @ solutions)


@dataclass(frozen=True)
class _Spectrum:
    """The sum ``f = sum h(d_i)`` and what its derivatives are made of, from ``X' X = V d^2 V'``.

    Attributes
    ----------
    total : float
        f.
    vectors : (P, P) array of float64
        V.
    precision : (P, P) array of float64
        ``K = V k V'``.
    bend : (P, P) array of float64
        The divided differences of k as a function of d^2: a change E of X changes K by
        ``V (bend * V' (E' X + X' E) V) V'``.
    """

    total: float
    vectors: NDArray[np.float64]
    precision: NDArray[np.float64]
    bend: NDArray[np.float64]

    @staticmethod
    def of(gram: NDArray[np.float64], threshold: float) -> _Spectrum:
        squares, vectors = np.linalg.eigh(gram)
        squares = np.maximum(squares, 0.0)
        values = np.sqrt(squares)
        large, small = np.maximum(values, threshold), np.minimum(values, threshold)
        shares = threshold / large
        bend = -threshold / (np.multiply.outer(large, large) * np.add.outer(large, large))
        flat = values <= threshold
        if flat.any():
            bend[np.ix_(flat, flat)] = 0.0
            mixed = flat[:, None] != flat
            i, j = np.nonzero(mixed)
            bend[i, j] = (shares[i] - shares[j]) / (squares[i] - squares[j])
        return _Spectrum(
            total=float((small * (large - threshold + small / 2.0)).sum()),
            vectors=vectors,
            precision=(vectors * shares) @ vectors.T,
            bend=bend,
        )


class _Entries:
    """The entries that rows lack, row by row: what is done with these alone.

    Parameters
    ----------
    mask : (N, P) array of bool
    """

    def __init__(self, mask: NDArray[np.bool_]) -> None:
        self.mask = mask
        self._row, self._column = np.nonzero(mask)
        self._start = np.concatenate([[0], np.cumsum(np.count_nonzero(mask, axis=1))])

    def solved(
        self, precision: NDArray[np.float64], values: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return ``inv(K_mm) v`` for each row's values v, m being the entries that it lacks."""
        from nodegraph_fill import low_rank_kernel

        solution = low_rank_kernel.solve(self._start, self._column, precision, values)
        return np.asarray(solution)

    def newton(
        self,
        spectrum: _Spectrum,
        rows: NDArray[np.float64],
        gradient: NDArray[np.float64],
        settled: float,
    ) -> NDArray[np.float64]:
        """Return what to subtract from the entries, by conjugate gradients.

        They end when the rest of the gradient, measured by inv(K_mm), is a share of it, or would
        change no entry by half of what counts as settled.
        """
        scores = rows @ spectrum.vectors
        rest, step = gradient.copy(), np.zeros_like(gradient)
        ahead = self.solved(spectrum.precision, rest)
        square = float(rest @ ahead)
        enough = _REST**2 * square
        for _ in range(_MOST_TURNS):
            turned = self._curved(spectrum, scores, ahead)
            curvature = float(ahead @ turned)
            if curvature <= 0.0:  # of rounding: the sum is convex
                break
            length = square / curvature
            step += length * ahead
            rest -= length * turned
            next_step = self.solved(spectrum.precision, rest)
            before, square = square, float(rest @ next_step)
            if square <= enough or np.abs(next_step).max() <= 0.5 * settled:
                break
            ahead = next_step + square / before * ahead
        return step

    def _curved(
        self, spectrum: _Spectrum, scores: NDArray[np.float64], step: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the change of the gradient by a step of the entries, scores being ``X V``."""
        from nodegraph_fill import low_rank_kernel

        product = low_rank_kernel.product(self._row, self._column, step, scores)
        half = spectrum.vectors.T @ product
        change = spectrum.vectors @ (spectrum.bend * (half + half.T))
        return np.asarray(
            low_rank_kernel.curvature(
                self._start, self._column, spectrum.precision, step, scores, change
            )
        )
