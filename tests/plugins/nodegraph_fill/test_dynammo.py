"""Frames as what a linear dynamical system shows of its states."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_fill.dynammo import dynammo
from tests.plugins.recordings import make_recording

Array = NDArray[np.float64]


class System:
    """A system of known F, G, mu and m, and variances of u, w and v."""

    def __init__(self, f: Array, g: Array, mu: Array, m: Array, *variances: float) -> None:
        self.f, self.g, self.mu, self.m = f, g, mu, m
        self.spread, self.drift, self.noise = variances

    def smoothed(self, rows: Array) -> tuple[Array, Array, Array]:
        """Means, covariances, and covariances of each state and the one before, by the book."""
        one = np.eye(len(self.f))
        means, covariances, ahead = [], [], []
        mean, covariance = self.m, self.spread * one
        for row in rows:
            ahead.append((mean, covariance))
            some = self.g[~np.isnan(row)]
            gain = covariance @ some.T
            gain = gain @ np.linalg.inv(some @ gain + self.noise * np.eye(len(some)))
            mean = mean + gain @ ((row - self.mu)[~np.isnan(row)] - some @ mean)
            covariance = covariance - gain @ some @ covariance
            means.append(mean)
            covariances.append(covariance)
            mean, covariance = self.f @ mean, self.f @ covariance @ self.f.T + self.drift * one
        beside = []
        for t in range(len(rows) - 2, -1, -1):
            expected, spread = ahead[t + 1]
            back = covariances[t] @ self.f.T @ np.linalg.inv(spread)
            means[t] = means[t] + back @ (means[t + 1] - expected)
            beside.append(covariances[t + 1] @ back.T)
            covariances[t] = covariances[t] + back @ (covariances[t + 1] - spread) @ back.T
        return np.array(means), np.array(covariances), np.array(beside[::-1])

    def likelier(self, rows: Array) -> System:
        """One round of EM, coordinate by coordinate."""
        means, covariances, beside = self.smoothed(rows)
        squares = covariances + means[:, :, None] * means[:, None, :]
        steps = (beside + means[1:, :, None] * means[:-1, None, :]).sum(axis=0)
        f = steps @ np.linalg.inv(squares[:-1].sum(axis=0))
        off = np.trace(squares[1:].sum(axis=0) - f @ steps.T)
        size = len(f)
        ones = np.ones((len(rows), size + 1))
        ones[:, :size] = means
        both = ones[:, :, None] * ones[:, None, :]
        both[:, :size, :size] = squares
        weights, left = np.empty((len(self.g), size + 1)), 0.0
        for j, column in enumerate(rows.T):
            there = ~np.isnan(column)
            weights[j] = column[there] @ ones[there] @ np.linalg.inv(both[there].sum(axis=0))
            g = weights[j, :size]
            left += float(((column[there] - ones[there] @ weights[j]) ** 2).sum())
            left += float(np.einsum("i,tij,j->", g, covariances[there], g))
        return System(
            f,
            weights[:, :size],
            weights[:, size],
            means[0],
            float(np.trace(covariances[0])) / size,
            float(off) / (size * (len(rows) - 1)),
            left / np.count_nonzero(~np.isnan(rows)),
        )

    def fill(self, rows: Array) -> Array:
        """What the system makes of rows."""
        return np.asarray(self.mu + self.smoothed(rows)[0] @ self.g.T)


def drawn(seed: int) -> tuple[System, Array, Array]:
    """A system of three states, what it shows without noise, and that with noise and holes."""
    random = np.random.default_rng(seed)
    turn, size = np.deg2rad(6.0), 0.99
    f = size * np.array(
        [[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
    )
    views, mu = random.normal(0, 1, (18, 3)), random.normal(0, 30, 18)
    system = System(f, views, mu, np.array([3.0, 0.0, 2.0]), 0.25, 0.25, 0.04)
    states = [system.m]
    for _ in range(119):
        states.append(f @ states[-1] + random.normal(0, 0.5, 3))
    truth = mu + np.array(states) @ views.T
    rows = truth + random.normal(0, 0.2, truth.shape)
    for start in range(5, 110, 9):
        marker = 3 * random.integers(0, 6)
        rows[start : start + 6, marker : marker + 3] = np.nan
    return system, truth, rows


def filled(rows: Array) -> Array:
    recording = make_recording(rows.reshape(len(rows), -1, 3))
    return dynammo(recording, variance=0.99).positions.reshape(rows.shape)


def test_it_fills_what_five_rounds_of_em_by_the_book_fill() -> None:
    _, _, rows = drawn(1)
    frames = np.arange(len(rows))
    lines = np.array([np.interp(frames, frames[~np.isnan(c)], c[~np.isnan(c)]) for c in rows.T]).T
    mu = lines.mean(axis=0)
    values, vectors = np.linalg.eigh((lines - mu).T @ (lines - mu))
    assert values[-2:].sum() < 0.99 * values.sum() < values[-3:].sum()
    g = vectors[:, ::-1][:, :3]
    z = (lines - mu) @ g
    f = np.linalg.lstsq(z[:-1], z[1:])[0].T
    drift, noise = np.mean((z[1:] - z[:-1] @ f.T) ** 2), np.mean((lines - mu - z @ g.T) ** 2)
    system = System(f, g, mu, z[0], float(drift), float(drift), float(noise))
    for _ in range(4):
        system = system.likelier(rows)
    missing = np.isnan(rows)
    np.testing.assert_allclose(filled(rows)[missing], system.fill(rows)[missing], atol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_it_errs_little_more_than_who_knows_the_system(seed: int) -> None:
    system, truth, rows = drawn(seed)
    hidden = np.isnan(rows)
    error, least = (filled(rows) - truth)[hidden], (system.fill(rows) - truth)[hidden]
    assert np.sqrt((error**2).mean()) < 1.2 * np.sqrt((least**2).mean())
