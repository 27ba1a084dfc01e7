"""The least of a quadratic function within bounds, approached from within them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_blendshapes.solve.chain import Chain

    Matrix = NDArray[np.float64]

_STEPS = 100
_NEAR, _EXACT, _SHORT = 1e-20, 1e-13, 1e-8
_PART = 0.995


@dataclass
class _Side:
    """A bound: how far the weights are from it, and how much it holds them back."""

    inwards: float
    apart: Matrix
    push: Matrix

    def pushed(self, way: Matrix, product: Matrix | float) -> Matrix:
        """Return how the push changes for ``apart * push`` to become `product`."""
        return np.asarray((product - self.push * self.inwards * way) / self.apart - self.push)

    def part(self, way: Matrix, pushed: Matrix) -> float:
        """Return how much of a step keeps distance and push positive."""
        falls = np.minimum(self.inwards * way / self.apart, pushed / self.push).min()
        return float(min(1.0, -1.0 / falls)) if falls < 0.0 else 1.0


def interior(chain: Chain) -> Matrix:
    """Return weights near the least, at a bound where it holds them back.

    The predictor-corrector method of Mehrotra (1992): the weights stay within the bounds; each
    bound pushes them away, so that distance times push is the same everywhere, and less with each
    step.
    """
    weights, sides = _start(chain)
    for _ in range(_STEPS):
        rest = chain.gradient(weights) - sum(side.inwards * side.push for side in sides)
        product = float(np.mean([np.mean(side.apart * side.push) for side in sides]))
        if product <= _NEAR * chain.size and np.abs(rest).max() <= _EXACT * chain.noise(weights):
            break
        part, way, pushes = _step(chain, sides, rest, product)
        weights = weights + part * way
        for side, pushed in zip(sides, pushes, strict=True):
            side.apart = side.apart + part * side.inwards * way
            side.push = side.push + part * pushed
        if part < _SHORT:
            break
    for side in sides:
        held = side.push > side.apart * chain.size
        weights = np.where(held, chain.low if side.inwards > 0.0 else chain.high, weights)
    return np.clip(weights, chain.low, chain.high)


def _start(chain: Chain) -> tuple[Matrix, list[_Side]]:
    """Return weights half way between the bounds, or 1 from the only one."""
    far = min(1.0, 0.5 * (chain.high - chain.low))
    weights = np.full_like(chain.linear, chain.low + far)
    bounds = [inwards for inwards in (1.0, -1.0) if inwards > 0.0 or np.isfinite(chain.high)]
    return weights, [
        _Side(inwards, np.full_like(weights, far), np.full_like(weights, chain.size))
        for inwards in bounds
    ]


def _step(
    chain: Chain, sides: list[_Side], rest: Matrix, product: float
) -> tuple[float, Matrix, list[Matrix]]:
    """Return how far to go, where, and how the pushes change with it."""
    divided = chain.divided(np.asarray(sum(side.push / side.apart for side in sides)))

    def way(products: list[Matrix | float]) -> tuple[Matrix, list[Matrix]]:
        right = -rest
        for side, product in zip(sides, products, strict=True):
            right = right + side.inwards * (product / side.apart - side.push)
        step = divided(right)
        changed = zip(sides, products, strict=True)
        return step, [side.pushed(step, product) for side, product in changed]

    def part(step: Matrix, pushes: list[Matrix]) -> float:
        changed = zip(sides, pushes, strict=True)
        return min(side.part(step, pushed) for side, pushed in changed)

    step, pushes = way([0.0] * len(sides))
    gone = part(step, pushes)
    changed = list(zip(sides, pushes, strict=True))
    after = np.mean([
        np.mean((side.apart + gone * side.inwards * step) * (side.push + gone * pushed))
        for side, pushed in changed
    ])  # fmt: skip
    central = product * (float(after) / product) ** 3
    step, pushes = way([central - side.inwards * step * pushed for side, pushed in changed])
    return _PART * part(step, pushes), step, pushes
