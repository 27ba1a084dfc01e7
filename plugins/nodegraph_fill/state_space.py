"""Frames as a random walk in a subspace, seen through noise: what fills by smoothing share."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_fill.whole_take import Estimate, TakeMatrix

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_fill.gaps import Gaps

_LEAST_DRIFT = 1e-12
"""Smallest drift in any direction, relative to the direction in which states drift most."""


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

    def estimate(self, matrix: TakeMatrix, gaps: Gaps, *, with_sigma: bool) -> Estimate:
        """Return the mean of every sample, and its deviation, all present ones being known."""
        rows = np.where(matrix.missing, 0.0, matrix.rows - self.middle)
        states = States(self.middle, self._basis, self.noise, *self._smoothed(rows, matrix.missing))
        return states.estimate(matrix, gaps, with_sigma=with_sigma)

    def _smoothed(
        self, rows: NDArray[np.float64], missing: NDArray[np.bool_]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the state in every frame, (T, D), and its covariance, (T, D, D)."""
        from nodegraph_fill import kalman_kernel

        missing = np.ascontiguousarray(missing)
        basis, identity = self._basis, np.eye(len(self.first))
        weighted = basis / self.noise[:, None]
        total = basis.T @ weighted
        known = kalman_kernel.information(missing[0], basis, weighted, total)
        start = np.linalg.solve(identity + self._first @ known, self._first)
        states, covariances = rows @ weighted, np.empty((len(rows), *start.shape))
        covariances[0] = np.linalg.solve(identity + start, start) if len(rows) > 1 else start
        kalman_kernel.smooth(missing, basis, weighted, total, states, covariances)
        return states, covariances

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


@dataclass(frozen=True)
class States:
    """The states of rows ``middle + C x[t] + v[t]`` as all present samples have them.

    Attributes
    ----------
    middle : (P,) array of float64
    basis : (P, D) array of float64
        C.
    noise : (P,) array of float64
        The variances of v, mm^2, positive.
    means : (T, D) array of float64
    covariances : (T, D, D) array of float64
    """

    middle: NDArray[np.float64]
    basis: NDArray[np.float64]
    noise: NDArray[np.float64]
    means: NDArray[np.float64]
    covariances: NDArray[np.float64]

    def estimate(self, matrix: TakeMatrix, gaps: Gaps, *, with_sigma: bool) -> Estimate:
        """Return the mean of every sample of these rows, and its deviation.

        The estimates beside the gaps leave out what is missing in them.
        """

        def beside() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
            hidden = matrix.hidden_ends(gaps)
            at, there = hidden.frame, self.means[hidden.frame]
            rows, lacking = matrix.rows[at] - self.middle, hidden.missing & ~matrix.missing[at]
            for row, lost, state, covariance in zip(
                rows, lacking, there, self.covariances[at], strict=True
            ):
                self._forget(row, lost, state, covariance)
            return hidden.of_gaps(self._positions(matrix, there))

        sigma = self._sigma(matrix, gaps) if with_sigma else None
        return Estimate(self._positions(matrix, self.means), sigma, beside)

    def _forget(
        self,
        row: NDArray[np.float64],
        lost: NDArray[np.bool_],
        state: NDArray[np.float64],
        covariance: NDArray[np.float64],
    ) -> None:
        """Take some of the coordinates from a state that they were a part of.

        With c their rows of the basis, r their noise and y their values, ``P c' inv(r - c P c')
        (y - c x)`` is subtracted from x.
        """
        some = self.basis[lost]
        gain = some @ covariance
        off = row[lost] - some @ state
        state -= np.linalg.solve(np.diag(self.noise[lost]) - gain @ some.T, off) @ gain

    def _positions(self, matrix: TakeMatrix, states: NDArray[np.float64]) -> NDArray[np.float64]:
        return matrix.positions(states @ self.basis.T + self.middle)

    def _sigma(self, matrix: TakeMatrix, gaps: Gaps) -> NDArray[np.float64]:
        from nodegraph_fill import kalman_kernel

        spread, sigma = (
            np.full(matrix.missing.shape, np.nan),
            np.full((len(matrix.rows), len(matrix.seen)), np.nan),
        )
        row, column = np.nonzero(np.repeat(gaps.mask[:, matrix.seen], 3, axis=1))
        spread[row, column] = kalman_kernel.spread(row, column, self.covariances, self.basis)
        sigma[:, matrix.seen] = np.sqrt(
            (spread + self.noise).reshape(len(sigma), -1, 3).mean(axis=2)
        )
        return sigma
