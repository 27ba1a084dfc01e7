"""Weights of a whole take at once, where a change from frame to frame has a price."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Refusal
from nodegraph_blendshapes.solve.chain import Chain
from nodegraph_blendshapes.solve.frames import Solved, patterns
from nodegraph_blendshapes.solve.problem import Problem

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

KKT, ROUNDING = 1e-12, 1e-15
"""A gradient is zero up to these shares of the largest at weights of 0 and of `Chain.noise`."""

ENOUGH = 1e-10
"""With no larger share left of the largest gradient at weights of 0, the weights are given."""

SHARE = 1e-9
"""Weight of the norm beside the squares while the weights of least norm are approached."""

_APPROACHES = 25

# Of the steps from within the bounds.
_STEPS = 100
_NEAR, _EXACT, _SHORT = 1e-20, 1e-13, 1e-8
_PART = 0.995


def solve_take(
    problem: Problem, low: float, high: float, ridge: float, smoothness: float
) -> Solved:
    """Return the weights of least squares within the bounds, with smoothness over time.

    Parameters
    ----------
    problem
    low, high
        The bounds, infinite where there are none.
    ridge, smoothness
        Factors of the squares of the weights and of their differences between frames, mm^2.
    """
    solved = Solved.empty(problem)
    filled = problem.present.any(axis=1)
    if filled.any() and problem.seen.any():
        chain = _chain(problem, low, high, ridge, smoothness)
        for pattern in patterns(problem, 0.0):
            solved.unseen[np.ix_(pattern.frames, problem.seen)] = True
            solved.unseen[np.ix_(pattern.frames, pattern.shapes)] = False
        solved.values[np.ix_(filled, problem.seen)] = least(chain)
    return solved


def _chain(problem: Problem, low: float, high: float, ridge: float, smoothness: float) -> Chain:
    times = np.flatnonzero(problem.present.any(axis=1))
    seen = np.flatnonzero(problem.seen)
    which = np.zeros(len(problem.offsets), dtype=np.intp)
    linear = np.zeros((len(problem.offsets), len(seen)))
    grams: list[Matrix] = []
    for pattern in patterns(problem, 0.0):
        places = np.searchsorted(seen, pattern.shapes)
        gram = ridge * np.eye(len(seen))
        gram[np.ix_(places, places)] += pattern.columns @ pattern.columns.T
        linear[np.ix_(pattern.frames, places)] = pattern.targets @ pattern.columns.T
        which[pattern.frames] = len(grams)
        grams.append(gram)
    return Chain(
        grams=np.array(grams),
        which=which[times],
        coupled=np.diff(times, prepend=-2) == 1,
        linear=linear[times],
        low=low,
        high=high,
        smoothness=smoothness,
    )


def least(chain: Chain) -> Matrix:
    """Return the (T, K) weights of least squares.

    The proximal point method (Rockafellar, 1976): with a small share of the norm, the weights are
    the only ones; what that has taken from the squares is given back by small steps, each the
    shortest. Of several weights that are as good these are, but for the share, those of least norm.

    Raises
    ------
    Refusal
        If something is missing still.
    """
    share = SHARE * chain.scale
    strict = replace(chain, grams=chain.grams + share * np.eye(chain.linear.shape[1]))
    weights, left = np.zeros_like(chain.linear), np.inf
    for _ in range(_APPROACHES):
        weights = _nearest(strict, weights)
        left = float(np.abs(chain.inwards(weights, chain.gradient(weights))).max())
        if left <= max(KKT * chain.size, ROUNDING * chain.noise(weights)):
            break
        strict = replace(strict, linear=chain.linear + share * weights)
    if left > ENOUGH * chain.size:
        raise Refusal(
            "the weights of least squares with smoothness could not be found within rounding: a "
            f"gradient of {left / chain.size:.1g} of the largest at weights of 0 is left; try a "
            "larger ridge or less smoothness"
        )
    return weights


def _nearest(chain: Chain, weights: Matrix) -> Matrix:
    """Return the weights of the least, from others that may be near it or, failing that, inside."""
    exchanged = chain.exchanged(weights)
    if exchanged is None:
        inside = interior(chain)
        exchanged = chain.exchanged(inside)
    return inside if exchanged is None else exchanged


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
