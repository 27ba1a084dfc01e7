"""The take completed to a matrix of small nuclear norm, without any complete frame."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

from nodegraph_fill.kept import kept_of
from nodegraph_fill.whole_take import TakeMatrix
from nodegraph_mocap import Trajectories

_Real = TypeVar("_Real", np.float32, np.float64)
_MOST_ROUNDS = 1000
_NEAR = 0.1
"""Largest change of a round, relative to the root mean square of the known samples, at which
Newton's step is tried.
"""
_ROUNDING = 10.0 * float(np.finfo(np.float64).eps)
_MEMORY = 10
"""Rounds that the extrapolation looks back."""
_MOST_TURNS, _REST = 100, 0.1
"""Limits of conjugate gradients: their number, and the share of the gradient that may be left."""


@dataclass(frozen=True)
class Principal:
    """The principal components of completed rows.

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
    settled
        What the last round may change a coordinate by, as a share of the root mean square of
        what is known.

    Attributes
    ----------
    rows : (T, P) array of float64
        Completed.
    precision : (P, P) array of float64
        K at the solution.
    unsettled : str
        What to warn of where the rounds have not settled.
    """

    rows: NDArray[np.float64]
    precision: NDArray[np.float64]
    unsettled: str

    def __init__(
        self,
        matrix: TakeMatrix,
        shrinkage: float,
        near: LowRank | None = None,
        settled: float = 1e-11,
    ) -> None:
        self.rows, self.unsettled = matrix.rows.copy(), ""
        lacking = matrix.missing.any(axis=1)
        whole, some = matrix.rows[~lacking], matrix.rows[lacking]
        self._missing, self._constant = Entries(matrix.missing[lacking]), whole.T @ whole
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
            self._solve(some, size, size * max(settled, _ROUNDING / shrinkage))
            self.rows[lacking] = some

    @staticmethod
    def of(recording: Trajectories, shrinkage: float) -> LowRank:
        """Return the completion of a recording."""
        kept, key = kept_of(recording), (LowRank, shrinkage)
        if key not in kept:
            kept[key] = LowRank(TakeMatrix.of(recording), shrinkage)
        found: LowRank = kept[key]
        return found

    def completed(
        self, rows: NDArray[np.float64], missing: NDArray[np.bool_]
    ) -> NDArray[np.float64]:
        """Return other rows completed by the same K: each x to the least ``x' K x``."""
        entries, filled = Entries(missing), np.where(missing, 0.0, rows)
        gradient = entries.product(filled, self.precision)
        filled[missing] = -entries.inverse(self.precision)(gradient)
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
        missing, mixing = self._missing, Mixing()
        near, before, lower = _NEAR * size, math.inf, rows[missing.mask]
        for _ in range(_MOST_ROUNDS):
            spectrum = _Spectrum.of(self._constant + rows.T @ rows, self._threshold)
            self.precision = spectrum.precision
            gradient = missing.product(rows, self.precision)
            inverse = missing.inverse(self.precision)
            step = inverse(gradient)
            change = float(np.abs(step).max(initial=0.0))
            if change <= settled:
                return
            if change > before:
                # Newton's step went too far
                rows[missing.mask], near, before = lower, near / 10.0, math.inf
                continue
            lower = rows[missing.mask] - step
            if change <= near:
                rest = min(_REST, change / size)
                newton = _Newton(missing, rows, spectrum, inverse)
                rows[missing.mask] -= newton.step(gradient, rest, settled)
                before = change
            else:
                rows[missing.mask] = mixing.extrapolated(lower, -step)
        self.unsettled = (
            f"completing the take has not settled after {_MOST_ROUNDS} rounds: the last one "
            f"still changed a coordinate by {change:.1g} mm"
        )


class Mixing:
    """Anderson's extrapolation of a sequence, each from the latest ones and their steps.

    Restarted whenever a step is longer than the one before.
    """

    def __init__(self) -> None:
        self._turn, self._length = 0, math.inf

    def extrapolated(
        self, solution: NDArray[np.float64], step: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return where to go on from a solution that a step has led to.

        The solution may have more numbers than the step, those that follow from where it leads.
        """
        if not self._turn:
            # what the solution and the step have changed by, in each of the latest rounds
            self._solutions = np.zeros((_MEMORY, len(solution)))
            self._steps = np.zeros((_MEMORY, len(step)))
            self._latest = np.zeros(len(solution)), np.zeros(len(step))
        place = self._turn % _MEMORY
        self._solutions[place] = solution - self._latest[0]
        self._steps[place] = step - self._latest[1]
        self._latest = solution.copy(), step.copy()
        length, longest = float(step @ step), self._length
        if not self._turn or length > longest:
            self._solutions[:] = self._steps[:] = 0.0
        self._turn, self._length = self._turn + 1, length
        steps = self._steps
        shares = np.linalg.lstsq(steps @ steps.T, steps @ step)[0]
        return np.asarray(solution - shares @ self._solutions)


@dataclass(frozen=True)
class _Spectrum:
    """The parts of the derivatives of ``f = sum h(d_i)``, from ``X' X = V d^2 V'``.

    Attributes
    ----------
    squares : (P,) array of float64
        d^2.
    vectors : (P, P) array of float64
        V.
    threshold : float
        s.
    """

    squares: NDArray[np.float64]
    vectors: NDArray[np.float64]
    threshold: float

    @staticmethod
    def of(gram: NDArray[np.float64], threshold: float) -> _Spectrum:
        squares, vectors = np.linalg.eigh(gram)
        return _Spectrum(np.maximum(squares, 0.0), vectors, threshold)

    @property
    def precision(self) -> NDArray[np.float64]:
        """``K = V k V'``."""
        return np.asarray((self.vectors * self._shares) @ self.vectors.T)

    @property
    def bend(self) -> NDArray[np.float64]:
        """The divided differences of k as a function of d^2, (P, P).

        A change E of X changes K by ``V (bend * V' (E' X + X' E) V) V'``.
        """
        squares, shares, threshold = self.squares, self._shares, self.threshold
        large = threshold / shares
        bend = -threshold / (np.multiply.outer(large, large) * np.add.outer(large, large))
        flat = squares <= threshold**2
        if flat.any():
            bend[np.ix_(flat, flat)] = 0.0
            i, j = np.nonzero(flat[:, None] != flat)
            bend[i, j] = (shares[i] - shares[j]) / (squares[i] - squares[j])
        return bend

    @property
    def _shares(self) -> NDArray[np.float64]:
        """``k = min(1, s / d)``."""
        return np.asarray(self.threshold / np.maximum(np.sqrt(self.squares), self.threshold))


class Entries:
    """The entries that rows lack, row by row: what is done with these alone.

    Parameters
    ----------
    mask : (N, P) array of bool
    """

    def __init__(self, mask: NDArray[np.bool_]) -> None:
        self.mask = mask
        # contiguous, for which the kernels are compiled
        self._row, self._column = map(np.ascontiguousarray, np.nonzero(mask))
        self._start = np.concatenate([[0], np.cumsum(np.count_nonzero(mask, axis=1))])

    def inverse(
        self, precision: NDArray[np.float64]
    ) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
        """Return ``v -> inv(K_mm) v``, row by row, m being the entries that the row lacks."""
        from nodegraph_fill import low_rank_kernel

        factors = low_rank_kernel.factorize(self._start, self._column, precision)
        return lambda values: np.asarray(low_rank_kernel.solve(self._start, *factors, values))

    def inverses(self, precision: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the sum over all rows of inv(K_mm), at the columns m, (P, P)."""
        from nodegraph_fill import low_rank_kernel

        factors = low_rank_kernel.factorize(self._start, self._column, precision)
        size = self.mask.shape[1]
        return np.asarray(low_rank_kernel.inverses(self._start, self._column, *factors, size))

    def product(self, rows: NDArray[_Real], matrix: NDArray[_Real]) -> NDArray[_Real]:
        """Return the entries of ``Y D'``, from rows Y and a matrix D."""
        from nodegraph_fill import low_rank_kernel

        return np.asarray(low_rank_kernel.product(self._row, self._column, rows, matrix))

    def outer(self, values: NDArray[_Real], rows: NDArray[_Real]) -> NDArray[_Real]:
        """Return ``E' Y``, E being zero but for the entries' values, from rows Y."""
        return self._gathered(self._row, self._column, values, rows, self.mask.shape[1])

    def rows(self, values: NDArray[_Real], matrix: NDArray[_Real]) -> NDArray[_Real]:
        """Return ``E D``, E being zero but for the entries' values, from a matrix D."""
        return self._gathered(self._column, self._row, values, matrix, len(self.mask))

    @staticmethod
    def _gathered(*arguments: Any) -> NDArray[Any]:
        from nodegraph_fill import low_rank_kernel

        return np.asarray(low_rank_kernel.gather(*arguments))


class _Newton:
    """Newton's step of the entries.

    What the change of K adds is computed in single precision: it bounds how much of the way a
    step leaves to the next, not where they end.

    Parameters
    ----------
    entries
        The entries of X.
    rows
        X.
    spectrum
        The spectrum of X.
    inverse
        ``inv(K_mm)``.
    """

    def __init__(
        self,
        entries: Entries,
        rows: NDArray[np.float64],
        spectrum: _Spectrum,
        inverse: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    ) -> None:
        self._entries, self._inverse = entries, inverse
        self._vectors = spectrum.vectors.astype(np.float32)
        self._bend = spectrum.bend.astype(np.float32)
        self._scores = rows.astype(np.float32) @ self._vectors

    def step(
        self, gradient: NDArray[np.float64], left: float, settled: float
    ) -> NDArray[np.float64]:
        """Return what to subtract from the entries, by conjugate gradients.

        They end when the rest of the gradient, measured by inv(K_mm), is the share `left` of it,
        or would change no entry by half of what counts as settled.
        """
        rest, step = gradient.copy(), np.zeros_like(gradient)
        ahead = self._inverse(rest)
        # K_mm ahead
        pulled = rest.copy()
        square = float(rest @ ahead)
        enough = left**2 * square
        for _ in range(_MOST_TURNS):
            turned = pulled + self._bent(ahead)
            curvature = float(ahead @ turned)
            if not curvature > 0.0:  # of rounding: the sum is convex
                break
            length = square / curvature
            step += length * ahead
            rest -= length * turned
            next_step = self._inverse(rest)
            before, square = square, float(rest @ next_step)
            if square <= enough or np.abs(next_step).max() <= 0.5 * settled:
                break
            ahead = next_step + square / before * ahead
            pulled = rest + square / before * pulled
        return step

    def _bent(self, step: NDArray[np.float64]) -> NDArray[np.float32]:
        """Return what a step of the entries changes the gradient by through K."""
        half = self._vectors.T @ self._entries.outer(step.astype(np.float32), self._scores)
        change = self._vectors @ (self._bend * (half + half.T))
        return self._entries.product(self._scores, change)
