"""Frames that have the same markers are solved together, and each as if it were alone."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_blendshapes.solve.frames import solve_frames
from nodegraph_blendshapes.solve.problem import Problem
from tests.plugins.nodegraph_blendshapes.solve.statements import at, by_scipy, face, left, posed

VALUES = np.random.default_rng(0).uniform(-0.3, 1.3, (30, 5))


def gappy() -> tuple[Problem, np.ndarray]:
    """Six patterns of markers, one of them without any."""
    model, _, _ = face(VALUES)
    recording = posed(model, VALUES, noise=0.5)
    positions = recording.positions.copy()
    for number, gone in enumerate(([], [0], [1, 2], list(range(8)), [7], [1, 2, 3, 4])):
        positions[number::6, gone] = np.nan
    return Problem.of(at(recording, positions), model), positions


@pytest.mark.parametrize("ridge", [0.0, 1e-6, 3.0])
@pytest.mark.parametrize(
    ("low", "high"), [(0.0, 1.0), (-0.1, 0.8), (0.0, np.inf), (-np.inf, np.inf)]
)
def test_every_frame_beside_scipy(low: float, high: float, ridge: float) -> None:
    problem, positions = gappy()
    solved = solve_frames(problem, low, high, ridge)
    assert np.flatnonzero(np.isnan(solved.values).any(axis=1)).tolist() == [3, 9, 15, 21, 27]
    assert not solved.unsolved.any()
    for frame in range(30):
        there = np.isfinite(positions[frame, :, 0])
        if not there.any():
            continue
        columns = problem.shapes[:, there].reshape(5, -1)
        target = problem.offsets[frame, there].ravel()
        columns = np.hstack([columns, np.sqrt(ridge) * np.eye(5)])
        target = np.concatenate([target, np.zeros(5)])
        expected = by_scipy(columns, target[None], low, high)[0]
        np.testing.assert_allclose(solved.values[frame], expected, rtol=0, atol=1e-9)
        assert left(columns, target[None], solved.values[None, frame], low, high) <= 1e-10


def test_shapes_that_frames_do_not_see() -> None:
    model, recording, _ = face(VALUES)
    shapes = model.shapes.copy()
    shapes[2, 1:] = 0.1
    model = type(model)(
        neutral=model.neutral, shapes=shapes, names=model.names, markers=model.markers
    )
    positions = posed(model, np.clip(VALUES, 0, 1)).positions.copy()
    positions[4:7, 0] = np.nan
    solved = solve_frames(Problem.of(at(recording, positions), model), 0.0, 1.0, 0.0)
    hidden = np.zeros((30, 5), dtype=bool)
    hidden[4:7, 2] = True
    np.testing.assert_array_equal(solved.unseen, hidden)
    np.testing.assert_array_equal(solved.values[4:7, 2], 0.0)
    seen = [frame for frame in range(30) if frame not in (4, 5, 6)]
    np.testing.assert_allclose(solved.values[seen], np.clip(VALUES, 0, 1)[seen], atol=1e-9)
