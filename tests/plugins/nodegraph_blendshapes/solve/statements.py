"""Plain statements of what weights must be, and faces to find them for."""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear, nnls

from nodegraph_mocap import BlendshapeModel, Trajectories, Weights
from tests.studies import DATA

Matrix = NDArray[np.float64]
FACECAP = DATA / "facecap"


def by_scipy(columns: Matrix, targets: Matrix, low: float, high: float) -> Matrix:
    """Least squares within bounds, a target at a time."""
    if np.isinf(low):
        return np.array([np.linalg.lstsq(columns.T, target, rcond=1e-12)[0] for target in targets])
    if low == 0.0 and np.isinf(high):
        return np.array([nnls(columns.T, target)[0] for target in targets])
    bounds = (low, high)
    solved = (
        lsq_linear(columns.T, target, bounds, "bvls", 1e-15, max_iter=500) for target in targets
    )
    return np.array([solution.x for solution in solved])


def left(columns: Matrix, targets: Matrix, weights: Matrix, low: float, high: float) -> float:
    """The largest gradient that no bound holds back, as a share of ``|column| |target|``."""
    worst = 0.0
    for target, w in zip(targets, weights, strict=True):
        for column, value in zip(columns, w, strict=True):
            gradient = column @ (w @ columns - target)
            held = (value == low and gradient > 0) or (value == high and gradient < 0)
            size = np.linalg.norm(column) * np.linalg.norm(target)
            worst = max(worst, 0.0 if held else abs(gradient) / (size or 1.0))
    return worst


def squares(columns: Matrix, target: Matrix, weights: Matrix) -> float:
    return float(np.sum((weights @ columns - target) ** 2))


def least_norm(columns: Matrix, weights: Matrix, low: float, high: float) -> Matrix:
    """The shortest weights within the bounds that give the same, of every choice of bound ones."""
    wanted, best = weights @ columns, weights
    for places in product((low, high, None), repeat=len(columns)):
        fixed = np.array([0.0 if place is None else place for place in places])
        if not np.isfinite(fixed).all():
            continue
        free = [place is None for place in places]
        tried = fixed.copy()
        if any(free):
            tried[free] = np.linalg.pinv(columns[free].T, 1e-12) @ (wanted - fixed @ columns)
        inside = np.all((tried >= low - 1e-12) & (tried <= high + 1e-12))
        same = np.allclose(tried @ columns, wanted, rtol=0, atol=1e-10)
        if inside and same and tried @ tried < best @ best:
            best = tried
    return best


def face(
    values: Matrix, *, markers: int = 8, seed: int = 0
) -> tuple[BlendshapeModel, Trajectories, Weights]:
    """A model of random shapes, and a recording of it that shows these weights."""
    random = np.random.default_rng(seed)
    names = tuple(f"m{number}" for number in range(markers))
    model = BlendshapeModel(
        neutral=random.normal(0, 40, (markers, 3)),
        shapes=random.normal(0, 4, (values.shape[1], markers, 3)),
        names=tuple(f"s{number}" for number in range(values.shape[1])),
        markers=names,
    )
    weights = Weights(values=values, names=model.names, rate=60.0)
    return model, posed(model, values), weights


def posed(model: BlendshapeModel, values: Matrix, *, noise: float = 0.0) -> Trajectories:
    positions = model.neutral + np.tensordot(values, model.shapes, axes=1)
    positions += np.random.default_rng(5).normal(0, noise, positions.shape)
    return Trajectories(positions=positions, markers=model.markers, rate=60.0)


def at(recording: Trajectories, positions: Matrix) -> Trajectories:
    """The recording with its markers elsewhere, missing where they are NaN."""
    return Trajectories(positions=positions, markers=recording.markers, rate=recording.rate)


@cache
def stored_model() -> BlendshapeModel:
    stored = np.load(FACECAP / "model_60_markers.npz")
    return BlendshapeModel(
        neutral=stored["neutral"],
        shapes=stored["shapes"],
        names=tuple(map(str, stored["shape_names"])),
        markers=tuple(map(str, stored["markers"])),
    )
