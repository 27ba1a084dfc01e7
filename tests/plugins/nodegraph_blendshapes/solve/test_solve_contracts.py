"""A solver that breaks a promise of its family is caught."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from nodegraph_blendshapes.solve.weights import solve_weights
from nodegraph_mocap import BlendshapeModel, Trajectories, Weights
from tests.promises import Family

SOLVE = Family("solve", "blendshapes")
Spoiled = Callable[[Weights, Trajectories, BlendshapeModel], Weights]


def other_names(weights: Weights, _: Trajectories, __: BlendshapeModel) -> Weights:
    return replace(weights, names=tuple(f"{name}s" for name in weights.names))


def another_rate(weights: Weights, _: Trajectories, __: BlendshapeModel) -> Weights:
    return replace(weights, rate=2 * weights.rate)


def zeros(weights: Weights, _: Trajectories, __: BlendshapeModel) -> Weights:
    return replace(weights, values=np.nan_to_num(weights.values))


def first_marker(weights: Weights, recording: Trajectories, _: BlendshapeModel) -> Weights:
    extra = 1e-3 * np.nan_to_num(recording.positions[:, :1, 0])
    return replace(weights, values=weights.values + extra)


def millimetres(weights: Weights, _: Trajectories, model: BlendshapeModel) -> Weights:
    return replace(weights, values=weights.values + 1e-3 * np.abs(model.shapes).max())


def favourite(weights: Weights, _: Trajectories, __: BlendshapeModel) -> Weights:
    values = weights.values.copy()
    values[:, 0] += 0.25
    return replace(weights, values=values)


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (other_names, "Take `recording` and `model`, and give first the weights"),
        (another_rate, "Take `recording` and `model`, and give first the weights"),
        (zeros, "Give no weights .NaN. where no marker is present"),
        (first_marker, "Give the same with the recording's markers in another order"),
        (millimetres, "Give the same weights of a face and a model twice as large"),
        (favourite, "Give two identical shapes equal weights"),
    ],
)
def test_a_solver_that_breaks_a_promise(spoil: Spoiled, text: str) -> None:
    def broken(recording: Trajectories, model: BlendshapeModel) -> Weights:
        """Find weights, and spoil them."""
        return spoil(solve_weights(recording, model).weights, recording, model)

    SOLVE.refuses(broken, text)


def test_weights_outside_of_the_bounds() -> None:
    def broken(
        recording: Trajectories, model: BlendshapeModel, *, bounds: tuple[float, float] = (0.0, 0.3)
    ) -> Weights:
        """Find weights within other bounds.

        Parameters
        ----------
        bounds
            Not kept to.
        """
        return solve_weights(recording, model).weights

    SOLVE.refuses(broken, "Give no weight outside of the setting")
