"""A linear dynamical system of a few states, learnt from the take by EM."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.state_space import States
from nodegraph_fill.tuning import Tune
from nodegraph_fill.whole_take import Estimate, TakeMatrix, whole_take
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ROUNDS = 5
_BESIDE = slice(None, -1), slice(1, None)
"""Frames that have one after, and frames that have one before."""
_LEAST = 1e-8
"""Least variance of anything, relative to the mean variance of a coordinate."""


@whole_take(
    "fill.dynammo",
    cite="li2009",
    adapted=(
        "from Li et al. 2009: coordinates have means, EM begins from principal components, whose "
        "number follows from their variance, and takes no estimate of a missing sample for a sample"
    ),
)
def dynammo(
    recording: Trajectories,
    gaps: Gaps,
    *,
    variance: Annotated[float, Field(gt=0, le=1), Tune(0.995, 0.999)] = 0.995,
) -> Estimate:
    """Fill gaps by a linear dynamical system that EM learns (DynaMMo; Li et al., 2009).

    A frame, all coordinates in a row, is ``mu + G z[t] + v[t]`` of states
    ``z[t+1] = F z[t] + w[t]`` that begin as ``z[0] = m + u``; u, v and w are independent normal
    noise, each of one variance for all its coordinates. F, G, mu, m and the three variances are
    those under which the present samples are likelier in each of five rounds of EM: a Kalman
    filter and smoother give the mean and the covariance of the states, all present samples being
    known, and these the next F, G, mu, m and variances by least squares. ``mu + G z`` of the last
    means of the states fills the gaps. No frame need be complete.

    It begins from the take with straight lines through the gaps: mu is its mean, G are its
    principal components, the first that have the share `variance` of its variance, F is the
    least-squares step of what the frames are along these; further rounds changed errors by few
    percent on two real and two made faces. Li et al. begin from random numbers, and without mu;
    the authors' code ends after ten rounds, and in each of them counts the last round's estimates
    of missing samples as samples.

    For `ends` met, the estimate beside a gap is that which leaves the samples there out, as those
    in the gap are.

    Does not depend on where the origin lies, how the axes are turned, or the unit. The head's
    motion is part of the states: remove it first, where it is large.

    Looks at the whole take.

    Parameters
    ----------
    variance
        Share of the variance that the states begin with.
    """
    matrix = TakeMatrix.of(recording)
    system = _System.first(matrix.with_lines(), variance)
    if not system.noise:
        # nothing ever moves
        return Estimate(matrix.positions(matrix.rows))
    for _ in range(_ROUNDS - 1):
        system = system.next(matrix)
    return system.states(matrix)[0].estimate(matrix, gaps, with_sigma=False)


@dataclass(frozen=True)
class _System:
    """A linear dynamical system.

    Attributes
    ----------
    transition : (D, D) array of float64
        F.
    basis : (P, D) array of float64
        G.
    middle : (P,) array of float64
        mu.
    start : (D,) array of float64
        m.
    spread, drift, noise : float
        The variances of u, w and v.
    least : float
        Least variance.
    """

    transition: NDArray[np.float64]
    basis: NDArray[np.float64]
    middle: NDArray[np.float64]
    start: NDArray[np.float64]
    spread: float
    drift: float
    noise: float
    least: float

    @staticmethod
    def first(lines: NDArray[np.float64], variance: float) -> _System:
        """Return the system that rows without gaps begin with."""
        middle = lines.mean(axis=0)
        rows = lines - middle
        values, vectors = np.linalg.eigh(rows.T @ rows)
        reached = np.cumsum(values[::-1])
        count = 1 + int(np.searchsorted(reached, variance * reached[-1]))
        basis = vectors[:, ::-1][:, :count].copy()
        states, least = rows @ basis, _LEAST * float(np.mean(rows * rows))
        transition = np.linalg.lstsq(states[:-1], states[1:])[0].T
        off, left = states[1:] - states[:-1] @ transition.T, rows - states @ basis.T
        drift = max(float(np.mean(off * off)), least)
        noise = max(float(np.mean(left * left)), least)
        return _System(transition, basis, middle, states[0], drift, drift, noise, least)

    def states(self, matrix: TakeMatrix) -> tuple[States, NDArray[np.float64]]:
        """Return the states of the rows and the sum of the covariances of each and the next."""
        from nodegraph_fill import kalman_kernel

        # in units in which the states drift by 1
        unit, one = math.sqrt(self.drift), np.eye(len(self.start))
        basis = self.basis * unit
        products = (basis[:, :, None] * basis[:, None, :]).reshape(len(basis), -1) / self.noise
        means = np.where(matrix.missing, 0.0, matrix.rows - self.middle) @ basis / self.noise
        blocks = np.broadcast_to(products.sum(axis=0), (len(means), products.shape[1])).copy()
        lacking = matrix.missing.any(axis=1)
        blocks[lacking] = (~matrix.missing[lacking]).astype(np.float64) @ products
        blocks = blocks.reshape(-1, *one.shape)
        blocks[:-1] += self.transition.T @ self.transition
        blocks[1:] += one
        blocks[0] += self.drift / self.spread * one
        means[0] += self.start * unit / self.spread
        steps = np.zeros_like(one)
        kalman_kernel.smooth_linear(self.transition, means, blocks, steps)
        noise = np.full(len(basis), self.noise)
        states = States(self.middle, self.basis, noise, means * unit, blocks * self.drift)
        return states, steps * self.drift

    def next(self, matrix: TakeMatrix) -> _System:
        """Return the system under which the rows are likelier."""
        states, steps = self.states(matrix)
        size = states.means.shape[1]
        # with a last one, of which mu is the weight
        means = np.pad(states.means, ((0, 0), (0, 1)), constant_values=1.0)
        squares = means[:, :, None] * means[:, None, :]
        squares[:, :size, :size] += states.covariances
        flat = squares.reshape(len(means), -1)
        totals = np.broadcast_to(flat.sum(axis=0), (len(self.basis), flat.shape[1])).copy()
        lacking = matrix.missing.any(axis=0)
        totals[lacking] = (~matrix.missing[:, lacking]).T.astype(np.float64) @ flat
        sums = matrix.rows.T @ means
        weights = np.linalg.solve(totals.reshape(-1, size + 1, size + 1), sums[..., None])[..., 0]
        before, after = (squares[each, :size, :size].sum(axis=0) for each in _BESIDE)
        following = steps.T + states.means[1:].T @ states.means[:-1]
        transition = np.linalg.solve(before, following.T).T
        off = float(np.trace(after) - np.sum(transition * following))
        left = float(np.sum(matrix.rows * matrix.rows) - np.sum(weights * sums))
        known = matrix.missing.size - np.count_nonzero(matrix.missing)
        return _System(
            transition,
            np.ascontiguousarray(weights[:, :size]),
            weights[:, size],
            states.means[0],
            max(float(np.trace(states.covariances[0])) / size, self.least),
            max(off / (size * (len(means) - 1)), self.least),
            max(left / known, self.least),
            self.least,
        )
