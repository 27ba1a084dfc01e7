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
        hidden = matrix.hidden_ends(gaps)
        at, there = hidden.frame, self.means[hidden.frame]
        rows, lacking = matrix.rows[at] - self.middle, hidden.missing & ~matrix.missing[at]
        counts = np.count_nonzero(lacking, axis=1)
        for count in np.unique(counts):
            some = np.flatnonzero(counts == count)
            lost = np.nonzero(lacking[some])[1].reshape(len(some), count)
            values = np.take_along_axis(rows[some], lost, axis=1)
            there[some] = self._without(values, lost, there[some], self.covariances[at[some]])
        ends = hidden.of_gaps(self._positions(matrix, there))
        sigma = self._sigma(matrix, gaps) if with_sigma else None
        return Estimate(self._positions(matrix, self.means), sigma, ends)

    def _without(
        self,
        values: NDArray[np.float64],
        lost: NDArray[np.intp],
        states: NDArray[np.float64],
        covariances: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """Return states, (E, D), without coordinates that they were a part of, (E, L) each.

        With c the rows of the basis of these, r their noise and y their values,
        ``P c' inv(r - c P c') (y - c x)`` is subtracted from x.
        """
        some = self.basis[lost]
        gain = some @ covariances
        off = values[..., None] - some @ states[..., None]
        rest = -gain @ some.transpose(0, 2, 1)
        place = np.arange(lost.shape[1])
        rest[:, place, place] += self.noise[lost]
        shares = np.linalg.solve(rest, off).transpose(0, 2, 1)
        return np.asarray(states - (shares @ gain)[:, 0])

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
