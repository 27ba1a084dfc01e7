"""Slow waves of a few shapes: cosines over time times principal components over the markers."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import Refusal
from nodegraph_fill import bilinear as module
from nodegraph_fill.bilinear import bilinear
from nodegraph_fill.soft_impute import soft_impute
from tests.plugins.recordings import make_recording

Positions = NDArray[np.float64]


def take(frames: int = 30, markers: int = 4, seed: int = 1) -> Positions:
    """Markers that two slow hidden movements drive, and a little noise."""
    random = np.random.default_rng(seed)
    places = random.normal(0, 30, (markers, 3))
    time = np.arange(frames)[:, None] / 60
    hidden = np.sin(2 * np.pi * np.array([1.1, 1.7]) * time + [0.3, 1.0])
    shapes = random.normal(0, 5, (2, markers, 3))
    noise = random.normal(0, 0.05, (frames, markers, 3))
    return np.asarray(places + np.einsum("tk,kmc->tmc", hidden, shapes) + noise)


def holed() -> Positions:
    positions = take()
    positions[4:12, 0] = positions[8:15, 2] = positions[:3, 3] = positions[26:, 1] = np.nan
    positions[20:22] = np.nan
    return positions


def waves(frames: int, rate: float, cutoff: float) -> Positions:
    """The cosines up to the cut-off, each of length one."""
    count = sum(k * rate / (2 * frames) <= cutoff for k in range(frames))
    angles = np.pi * np.outer(np.arange(frames) + 0.5, np.arange(count)) / frames
    return np.asarray(np.cos(angles) / np.linalg.norm(np.cos(angles), axis=0))


@pytest.mark.parametrize(("cutoff", "variance"), [(4.0, 0.9), (6.0, 0.999)])
def test_is_the_least_squares_solution(cutoff: float, variance: float) -> None:
    """The normal equations of missing entries and coefficients at once, written out."""
    gappy = holed()
    recording = make_recording(gappy)
    full = soft_impute(recording, ends="as_published").positions.reshape(30, -1)
    middle = full.mean(axis=0)
    _, values, v = np.linalg.svd(full - middle, full_matrices=False)
    size = int(np.flatnonzero(np.cumsum(values**2) >= variance * (values**2).sum())[0]) + 1
    basis = np.kron(waves(30, 60.0, cutoff), v[:size].T)
    rows = gappy.reshape(30, -1) - middle
    missing = np.isnan(rows)
    straight = rows.copy()
    for column in range(rows.shape[1]):
        k = np.flatnonzero(~missing[:, column])
        straight[:, column] = np.interp(np.arange(30), k, rows[k, column])
    m = missing.ravel()
    # |X_o - basis_o c|^2 + |y - basis_m c|^2 + 0.03 |y - straight|^2, unknown y and c
    count, width = int(m.sum()), basis.shape[1]
    upper = np.hstack([np.zeros((int((~m).sum()), count)), basis[~m]])
    middle_rows = np.hstack([-np.eye(count), basis[m]])
    lower = np.hstack([np.sqrt(0.03) * np.eye(count), np.zeros((count, width))])
    known = np.concatenate(
        [straight.ravel()[~m], np.zeros(count), np.sqrt(0.03) * straight.ravel()[m]]
    )
    solution = np.linalg.lstsq(np.vstack([upper, middle_rows, lower]), known, rcond=None)[0]
    output = (basis @ solution[count:]).reshape(30, -1) + middle
    filled = bilinear(recording, cutoff=cutoff, variance=variance, ends="as_published")
    np.testing.assert_allclose(
        filled.positions.reshape(30, -1)[missing], output[missing], rtol=0, atol=1e-5
    )


def test_a_cutoff_beyond_half_the_rate_is_refused() -> None:
    with pytest.raises(Refusal, match="cut-off below half the frame rate, 30 Hz, got 30 Hz"):
        bilinear(make_recording(holed()), cutoff=30.0)


def test_ending_early_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_MOST_ROUNDS", 1)
    with pytest.warns(UserWarning, match="not settled after 1 rounds"):
        bilinear(make_recording(holed()))
