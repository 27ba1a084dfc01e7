"""Frames as a random walk in a subspace, seen through noise: what fills by smoothing share."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_fill.whole_take import Estimate, HiddenEnds, TakeMatrix

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_fill.gaps import Gaps
    from nodegraph_fill.meet_ends import Ends


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

        rows = matrix.rows - self.middle
        states, covariances = kalman_kernel.smooth(
            *self._likelihood(rows, ~matrix.missing), self.first, self.drift
        )
        sigma = self._sigma(matrix, covariances) if with_sigma else None
        estimate = Estimate(self._positions(matrix, states), sigma)
        if ends == "as_published":
            return estimate
        hidden = matrix.hidden_ends(gaps)
        lacking = hidden.missing & ~matrix.missing[hidden.frame]
        beside = self._without(rows, lacking, states, covariances, hidden)
        return replace(estimate, ends=hidden.of_gaps(self._positions(matrix, beside)))

    def _positions(self, matrix: TakeMatrix, states: NDArray[np.float64]) -> NDArray[np.float64]:
        return matrix.positions(states @ self.basis.T + self.middle)

    def _likelihood(
        self, rows: NDArray[np.float64], known: NDArray[np.bool_]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return what the known entries of rows tell of the state, as the kernel takes it."""
        weight = np.where(known, 1.0 / self.noise, 0.0)
        information = (weight @ self._products()).reshape(len(rows), *self.drift.shape)
        return information, (weight * rows) @ self.basis

    def _sigma(self, matrix: TakeMatrix, covariances: NDArray[np.float64]) -> NDArray[np.float64]:
        sigma = np.full((len(covariances), len(matrix.seen)), np.nan)
        spread = covariances.reshape(len(covariances), -1) @ self._products().T + self.noise
        sigma[:, matrix.seen] = np.sqrt(spread.reshape(len(covariances), -1, 3).mean(axis=2))
        return sigma

    def _products(self) -> NDArray[np.float64]:
        """Return the products of every two numbers in each row of C, (P, D * D)."""
        return (self.basis[:, :, None] * self.basis[:, None, :]).reshape(len(self.basis), -1)

    def _without(
        self,
        rows: NDArray[np.float64],
        lacking: NDArray[np.bool_],
        states: NDArray[np.float64],
        covariances: NDArray[np.float64],
        ends: HiddenEnds,
    ) -> NDArray[np.float64]:
        """Return the states, (E, D), without the contribution of what is lacking, (E, P)."""
        information, vector = self._likelihood(rows[ends.frame], lacking)
        covariance, state = covariances[ends.frame], states[ends.frame, :, None]
        system = np.eye(len(self.drift)) - covariance @ information
        return np.asarray(np.linalg.solve(system, state - covariance @ vector[:, :, None])[..., 0])
