"""Frames as draws of a normal distribution of few components and noise."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_fill.ppca import ppca
from tests.plugins.recordings import make_recording

Positions = NDArray[np.float64]


def take(seed: int) -> Positions:
    """Markers that three slow movements drive, and noise."""
    random = np.random.default_rng(seed)
    time = np.arange(240)[:, None] / 60.0
    movements = np.sin(2.0 * np.pi * time * (0.3, 0.5, 0.8) + random.uniform(0.0, 6.0, 3))
    shapes = random.normal(0, 2, (3, 18))
    noise = random.normal(0, 0.2, (240, 18))
    return np.asarray((random.normal(0, 30, 18) + movements @ shapes + noise).reshape(240, 6, 3))


def holed(seed: int) -> Positions:
    positions = take(seed)
    random = np.random.default_rng(seed)
    for start in range(5, 230, 9):
        positions[start : start + 6, random.integers(0, 6)] = np.nan
    return positions


def most_likely(gappy: Positions, components: int) -> Positions:
    """The paper's own EM: W, mu and v from the states of each frame, as its present samples say."""
    rows = gappy.reshape(len(gappy), -1)
    seen, size = ~np.isnan(rows), rows.shape[1]
    middle, noise = np.nanmean(rows, axis=0), 1.0
    weights = np.linalg.qr(np.random.default_rng(0).normal(size=(size, components)))[0] * 5.0
    for _ in range(3000):
        states, squares, spread = np.ones((len(rows), components + 1)), [], []
        for row, there, state in zip(rows, seen, states, strict=True):
            some = weights[there]
            inner = np.linalg.inv(some.T @ some + noise * np.eye(components))
            state[:-1] = inner @ some.T @ (row[there] - middle[there])
            spread.append(noise * inner)
            squares.append(np.outer(state, state))
            squares[-1][:-1, :-1] += spread[-1]
        totals = np.einsum("tp,tij->pij", seen, squares)
        solution = np.linalg.solve(totals, (np.nan_to_num(rows).T @ states)[..., None])[..., 0]
        weights, middle = solution[:, :-1], solution[:, -1]
        variance = np.einsum("pi,tij,pj->tp", weights, spread, weights)
        off = (rows - states @ solution.T) ** 2 + variance
        before, noise = noise, float(off[seen].mean())
        if abs(noise - before) < 1e-8:
            break
    return np.where(seen, rows, states @ solution.T).reshape(gappy.shape)


def test_it_fills_what_the_paper_s_em_fills() -> None:
    gappy = holed(2)
    filled = ppca(make_recording(gappy)).positions
    np.testing.assert_allclose(filled, most_likely(gappy, 3), atol=0.02)


@pytest.mark.parametrize("seed", range(3))
def test_it_errs_little_more_than_who_knows_the_distribution(seed: int) -> None:
    truth, gappy = take(seed), holed(seed)
    hidden = np.isnan(gappy)
    error = (ppca(make_recording(gappy)).positions - truth)[hidden]
    rows = truth.reshape(len(truth), -1)
    covariance = np.cov(rows.T)
    best = rows.copy()
    for row, lost in zip(best, hidden.reshape(rows.shape), strict=True):
        if lost.any():
            known = row[~lost] - rows.mean(axis=0)[~lost]
            slope = np.linalg.solve(covariance[np.ix_(~lost, ~lost)], covariance[~lost][:, lost])
            row[lost] = rows.mean(axis=0)[lost] + known @ slope
    least = (best.reshape(truth.shape) - truth)[hidden]
    assert np.sqrt((error**2).mean()) < 1.3 * np.sqrt((least**2).mean())
