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
_SETTLED = 1e-8
"""How little, relative to the root mean square of what is known, the last round may change."""
_MEMORY = 10
"""Rounds that the extrapolation looks back."""


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

    The missing entries that are sought make ``sum h(d_i)`` least, d the singular values of the
    completed matrix and ``h(d) = d^2 / 2`` up to s, ``s d - s^2 / 2`` beyond: what is left of
    ``|X - Z|^2 / 2 + s |Z|_*`` when Z is the best for X. As h is concave in d^2, the quadratic
    ``x' K x / 2`` summed over the rows x touches it from above at any X, with
    ``K = V min(1, s / d) V'`` from the singular value decomposition of that X. Its least is
    found row by row, gives the next X, and so on, from straight lines through the gaps. Each X is
    extrapolated from the latest rounds by Anderson's mixing, begun anew whenever a round changes
    more than the one before. The sum only needs the rows that have missing entries.

    Parameters
    ----------
    matrix
        The take.
    shrinkage
        s as a share of the largest singular value of the rows with zeros where missing.

    Attributes
    ----------
    rows : (T, P) array of float64
        Completed.
    precision : (P, P) array of float64
        K at the solution.
    """

    rows: NDArray[np.float64]
    precision: NDArray[np.float64]

    def __init__(self, matrix: TakeMatrix, shrinkage: float) -> None:
        self.rows = matrix.rows.copy()
        lacking = matrix.missing.any(axis=1)
        whole, some = matrix.rows[~lacking], matrix.rows[lacking]
        self._missing, self._constant = matrix.missing[lacking], whole.T @ whole
        square = float(np.linalg.eigvalsh(self._constant + some.T @ some)[-1])
        self._threshold = shrinkage * math.sqrt(max(square, 0.0))
        # 0 only if nothing ever moves
        self.precision = np.eye(matrix.rows.shape[1])
        if self._threshold:
            settled = (
                _SETTLED
                * float(np.linalg.norm(matrix.rows))
                / math.sqrt(matrix.rows.size - np.count_nonzero(matrix.missing))
            )
            some = matrix.with_lines()[lacking]
            self._solve(some, settled)
            self.rows[lacking] = some

    def completed(
        self, rows: NDArray[np.float64], missing: NDArray[np.bool_]
    ) -> NDArray[np.float64]:
        """Return other rows completed by the same K."""
        from nodegraph_fill import low_rank_kernel

        filled = np.ascontiguousarray(rows).copy()
        low_rank_kernel.complete(filled, missing, self.precision)
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

    def _solve(self, rows: NDArray[np.float64], settled: float) -> None:
        from nodegraph_fill import low_rank_kernel

        entries, places = rows.reshape(-1), np.flatnonzero(self._missing)
        # what the solution and the step have changed by, in each of the latest rounds
        changes, latest = np.zeros((2, _MEMORY, len(places))), np.zeros((2, len(places)))
        length = math.inf
        for turn in range(_MOST_ROUNDS):
            before = entries[places]
            self.precision = self._majorant(rows)
            low_rank_kernel.complete(rows, self._missing, self.precision)
            solution = entries[places]
            step = solution - before
            if np.abs(step).max(initial=0.0) <= settled:
                return
            changes[:, turn % _MEMORY] = (solution, step) - latest
            latest[:] = solution, step
            length, longest = float(step @ step), length
            if not turn or length > longest:
                changes[:] = 0.0
            solutions, steps = changes
            shares = np.linalg.lstsq(steps @ steps.T, steps @ step)[0]
            entries[places] = solution - shares @ solutions
        off = float(np.abs(step).max())
        warnings.warn(
            f"completing the take has not settled after {_MOST_ROUNDS} rounds: the last one "
            f"still changed a coordinate by {off:.1g} mm",
            stacklevel=6,
        )

    def _majorant(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        squares, vectors = np.linalg.eigh(self._constant + rows.T @ rows)
        values = np.sqrt(np.maximum(squares, self._threshold**2))
        return np.asarray((vectors * (self._threshold / values)) @ vectors.T)
