"""The smooth course of a marker by itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct as transformed
from scipy.fft import idct

from nodegraph_fill.cubic import cubic
from nodegraph_fill.dct import dct
from tests.plugins.recordings import make_recording

Positions = NDArray[np.float64]


def wave(frames: int = 120) -> Positions:
    """One marker that moves slowly."""
    time = np.arange(frames)[:, None] / 60.0
    return np.asarray(5.0 * np.sin(2.0 * np.pi * time * (0.7, 0.9, 1.1) + (0.0, 1.0, 2.0)))[:, None]


def smoothed(rows: Positions, seen: NDArray[np.bool_], s: float) -> Positions:
    """The paper's iteration, begun near its end, which it must not leave."""
    frames = len(rows)
    waves = 2.0 - 2.0 * np.cos(np.pi * np.arange(frames) / frames)
    gain = (1.0 / (1.0 + s * waves**2))[:, None]
    bends = idct(waves[:, None] ** 2 * transformed(np.eye(frames), axis=0), axis=0)
    known = np.where(seen[:, None], rows, 0.0)
    course = np.linalg.solve(np.diag(seen.astype(float)) + s * bends, known)
    completed = np.where(seen[:, None], rows, course)
    again = idct(gain * transformed(completed, axis=0), axis=0)
    np.testing.assert_allclose(again, course, atol=1e-6)
    return np.asarray(course)


def score(rows: Positions, seen: NDArray[np.bool_], s: float) -> float:
    frames = len(rows)
    waves = 2.0 - 2.0 * np.cos(np.pi * np.arange(frames) / frames)
    left = (rows - smoothed(rows, seen, s))[seen]
    free = 1.0 - np.mean(1.0 / (1.0 + s * waves**2))
    return float(np.mean(left**2) / free**2)


def test_it_fills_what_the_paper_s_iteration_ends_at() -> None:
    random = np.random.default_rng(0)
    positions = wave() + random.normal(0.0, 0.3, (120, 1, 3))
    positions[40:55] = positions[:4] = np.nan
    rows, seen = positions[:, 0], ~np.isnan(positions[:, 0, 0])
    known = np.where(seen[:, None], rows, 0.0)
    best = min(10.0 ** np.arange(-2.0, 6.0, 0.05), key=lambda s: score(known, seen, s))
    filled = dct(make_recording(positions)).positions[:, 0]
    np.testing.assert_allclose(filled[~seen], smoothed(known, seen, best)[~seen], atol=0.03)


def test_it_looks_through_noise() -> None:
    truth, fills = wave(), (dct, cubic)
    errors = np.zeros(len(fills))
    for seed in range(10):
        positions = truth + np.random.default_rng(seed).normal(0.0, 0.3, truth.shape)
        positions[50:60] = np.nan
        filled = [fill(make_recording(positions)).positions for fill in fills]
        errors += [np.mean((each - truth)[50:60] ** 2) for each in filled]
    assert errors[0] < 0.1 * errors[1]
