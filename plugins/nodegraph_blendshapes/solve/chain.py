"""A quadratic function of the weights of frames that hang together, and its least within bounds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]
    Flags = NDArray[np.bool_]

_ZERO = 1e-14
"""A gradient is zero up to this share of `Chain.noise`."""

_STILL = 1e30
"""Added to the curvature of a weight, it does not move."""

_ROUNDS, _STAYS = 50, 5


@dataclass(frozen=True, kw_only=True)
class Chain:
    """``w' H w / 2 - linear' w`` with weights w between bounds.

    Attributes
    ----------
    grams : (P, K, K) array of float64
        Blocks of H.
    which : (T,) array of int
        The block of each frame.
    coupled : (T,) array of bool
        Whether a frame has a price for its difference from the one before.
    linear : (T, K) array of float64
    low, high : float
        Infinite where there is none.
    smoothness : float
        The price: half of it for the square of each difference.
    """

    grams: Matrix
    which: NDArray[np.intp]
    coupled: Flags
    linear: Matrix
    low: float
    high: float
    smoothness: float

    @property
    def scale(self) -> float:
        """The largest curvature."""
        return float(np.max(np.diagonal(self.grams, axis1=1, axis2=2))) + 4.0 * self.smoothness

    @property
    def size(self) -> float:
        """The largest gradient at weights of 0; 1 if there is none."""
        return float(np.abs(self.linear).max()) or 1.0

    def noise(self, weights: Matrix) -> float:
        """Return what the largest gradient is a sum of, at most."""
        return self.size + self.scale * float(np.abs(weights).max())

    def gradient(self, weights: Matrix) -> Matrix:
        """Return ``H w - linear``."""
        from nodegraph_blendshapes.solve import chain_kernel

        chain = self.grams, self.which, self.coupled, self.smoothness
        return np.asarray(chain_kernel.times(*chain, weights)) - self.linear

    def inwards(self, weights: Matrix, gradient: Matrix) -> Matrix:
        """Return the gradient, 0 where it pushes a weight against its bound."""
        out = (weights <= self.low) & (gradient > 0.0) | (weights >= self.high) & (gradient < 0.0)
        return np.where(out, 0.0, gradient)

    def divided(self, diagonal: Matrix) -> Callable[[Matrix], Matrix]:
        """Return what solves ``(H + diagonal) w = right`` for w."""
        from nodegraph_blendshapes.solve import chain_kernel as kernel

        chain = self.grams, self.which, self.coupled, self.smoothness
        inverses = np.empty((*self.linear.shape, self.linear.shape[1]))
        kernel.eliminate(*chain, diagonal, inverses)
        return lambda right: np.asarray(
            kernel.substitute(inverses, self.coupled, self.smoothness, right)
        )

    def exchanged(self, weights: Matrix) -> Matrix | None:
        """Return the least, found by block pivoting from the weights that are at a bound.

        As in `pivoting_kernel`, over all frames at once. None if it goes round in circles.
        """
        free = (weights > self.low) & (weights < self.high)
        weights = np.clip(weights, self.low, self.high)
        fewest, stays = weights.size + 1, 0
        for _ in range(_ROUNDS):
            weights, gradient = self._freed(weights, free)
            pulled = np.abs(self.inwards(weights, gradient)) > _ZERO * self.noise(weights)
            wrong = np.where(free, (weights < self.low) | (weights > self.high), pulled)
            count = int(np.count_nonzero(wrong))
            if count == 0:
                return weights
            stays = 0 if count < fewest else stays + 1
            fewest = min(fewest, count)
            if stays > _STAYS:
                break
            free = free ^ wrong
            weights = np.clip(weights, self.low, self.high)
        return None

    def _freed(self, weights: Matrix, free: Flags) -> tuple[Matrix, Matrix]:
        """Return the weights of gradient 0 where they are free, and the gradient."""
        divided = self.divided(np.where(free, 0.0, _STILL))
        for _ in range(2):  # the second takes away what rounding has left
            step = divided(np.where(free, -self.gradient(weights), 0.0))
            weights = weights + np.where(free, step, 0.0)
        return weights, self.gradient(weights)
