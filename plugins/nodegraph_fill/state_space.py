"""Frames as a random walk in a subspace, seen through noise: what fills by smoothing share."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_fill.whole_take import Estimate, TakeMatrix

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_fill.gaps import Gaps
    from nodegraph_fill.meet_ends import Ends

_LEAST_DRIFT = 1e-12
"""In each direction, relative to the one along which states drift most."""


@dataclass(frozen=True)
class StateSpace:
    """Rows ``middle + C x[t] + v[t]`` of states ``x[t+1] = x[t] + w[t]``.

    Attributes
    ----------
    middle : (P,) array of float64
    basis : (P, D) array of float64
        C.
    noise : (P,) array of float64
        The variances of v, mm^2, positive.
    first : (D,) array of float64
        The variances of the state before the first frame, mm^2; its mean is 0.
    drift : (D, D) array of float64
        The covariance of w, mm^2.
    """

    middle: NDArray[np.float64]
    basis: NDArray[np.float64]
    noise: NDArray[np.float64]
    first: NDArray[np.float64]
    drift: NDArray[np.float64]

    def estimate(self, matrix: TakeMatrix, gaps: Gaps, ends: Ends, *, with_sigma: bool) -> Estimate:
        """Return the mean of every sample, and its deviation, all present ones being known.

        For `ends` met, the estimates beside the gaps leave out what is missing in them.
        """
        from nodegraph_fill import kalman_kernel

        rows, basis = np.where(matrix.missing, 0.0, matrix.rows - self.middle), self._basis
        states, covariances = kalman_kernel.smooth(
            basis, self.noise, matrix.missing, rows, self._first
        )
        sigma = self._sigma(matrix, gaps, covariances) if with_sigma else None
        estimate = Estimate(self._positions(matrix, states), sigma)
        if ends == "as_published":
            return estimate
        hidden = matrix.hidden_ends(gaps)
        at = hidden.frame
        lacking = hidden.missing & ~matrix.missing[at]
        beside = kalman_kernel.without(
            lacking, rows[at], states[at], covariances[at], basis, self.noise
        )
        return replace(estimate, ends=hidden.of_gaps(self._positions(matrix, beside)))

    @cached_property
    def _scale(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The drift's eigenvectors as columns, and its deviations along them."""
        values, vectors = np.linalg.eigh(self.drift)
        least = _LEAST_DRIFT * max(float(values[-1]), float(self.noise.min()))
        return vectors, np.sqrt(np.maximum(values, least))

    @cached_property
    def _basis(self) -> NDArray[np.float64]:
        """C of the states that drift by 1 in each direction."""
        vectors, scale = self._scale
        return np.ascontiguousarray(self.basis @ vectors * scale)

    @cached_property
    def _first(self) -> NDArray[np.float64]:
        vectors, scale = self._scale
        return np.asarray((vectors.T * self.first) @ vectors / np.multiply.outer(scale, scale))

    def _positions(self, matrix: TakeMatrix, states: NDArray[np.float64]) -> NDArray[np.float64]:
        return matrix.positions(states @ self._basis.T + self.middle)

    def _sigma(
        self, matrix: TakeMatrix, gaps: Gaps, covariances: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        from nodegraph_fill import kalman_kernel

        spread, sigma = (
            np.full(matrix.missing.shape, np.nan),
            np.full((len(matrix.rows), len(matrix.seen)), np.nan),
        )
        row, column = np.nonzero(np.repeat(gaps.mask[:, matrix.seen], 3, axis=1))
        spread[row, column] = kalman_kernel.spread(row, column, covariances, self._basis)
        sigma[:, matrix.seen] = np.sqrt(
            (spread + self.noise).reshape(len(sigma), -1, 3).mean(axis=2)
        )
        return sigma
