"""Marker correlations: the markers' principal components, carried over to the missing one."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import Refusal
from nodegraph_fill.pca import Strategy, pca
from tests.plugins.recordings import make_recording

Positions = NDArray[np.float64]


def take(frames: int = 60, markers: int = 6, seed: int = 2) -> Positions:
    """Markers that three hidden movements drive, a little noise, and a head that moves."""
    random = np.random.default_rng(seed)
    places = random.normal(0, 60, (markers, 3))
    hidden = np.cumsum(random.normal(0, 1, (frames, 3)), axis=0)
    shapes = random.normal(0, 1, (3, markers, 3))
    noise = random.normal(0, 0.02, (frames, markers, 3))
    head = np.cumsum(random.normal(0, 3, (frames, 1, 3)), axis=0)
    return np.asarray(places + head + np.einsum("tk,kmc->tmc", hidden, shapes) + noise)


def reconstructed(
    gappy: Positions,
    wanted: list[int],
    predictors: list[int],
    scale: float,
    floor: float,
    share: float,
) -> Positions:
    """The published steps one by one, for markers of which all that are asked are never missing."""
    whole = [m for m in range(gappy.shape[1]) if not np.isnan(gappy[:, m]).any()]
    data = gappy - gappy[:, whole].mean(axis=1, keepdims=True)
    distance = np.full(gappy.shape[1], np.inf)
    for m in wanted:
        apart = np.linalg.norm(data - data[:, [m]], axis=2)
        distance = np.minimum(distance, np.nanmean(apart, axis=0))
    weight = np.exp(-(distance**2) / (2 * scale**2))
    weight[wanted] = floor
    used = sorted(wanted + predictors)
    complete = ~np.isnan(data[:, used]).any(axis=(1, 2))
    middle, spread = data[complete].mean(axis=0), data[complete].std(axis=0)
    scaled = ((data - middle) / spread * weight[:, None])[:, used].reshape(len(data), -1)
    hidden = np.repeat(np.isin(used, wanted), 3)
    zeros = np.where(hidden, 0.0, scaled)
    _, values, b = np.linalg.svd(scaled[complete], full_matrices=False)
    _, values0, b0 = np.linalg.svd(zeros[complete], full_matrices=False)
    kept = max(
        int(np.flatnonzero(np.cumsum(spectrum) >= share * spectrum.sum())[0]) + 1
        for spectrum in (values, values0)
    )
    b, b0 = b[:kept].T, b0[:kept].T
    expected = (zeros @ b0 @ b0.T @ b @ b.T)[:, hidden].reshape(len(data), -1, 3)
    expected = expected / floor * spread[wanted] + middle[wanted]
    return np.asarray(expected + gappy[:, whole].mean(axis=1, keepdims=True))


def test_each_marker_is_filled_from_those_that_have_no_gaps() -> None:
    gappy = take()
    gappy[20:30, 0] = gappy[25:40, 4] = np.nan
    filled = pca(make_recording(gappy), weight_scale=50.0, weight_missing=0.1, singular_values=0.9)
    for marker, gap in ((0, slice(20, 30)), (4, slice(25, 40))):
        output = reconstructed(gappy, [marker], [1, 2, 3, 5], 50.0, 0.1, 0.9)
        np.testing.assert_allclose(filled.positions[gap, marker], output[gap, 0], rtol=0, atol=1e-7)


def test_together_all_markers_with_gaps_are_hidden() -> None:
    gappy = take()
    gappy[20:30, 0] = gappy[45:50, 4] = np.nan
    filled = pca(make_recording(gappy), strategy="together")
    shape = gappy[~np.isnan(gappy[..., 0]).any(axis=1)][0]
    apart = np.linalg.norm(shape[:, None] - shape, axis=2)[np.triu_indices(6, k=1)].mean()
    output = reconstructed(gappy, [0, 4], [1, 2, 3, 5], apart, 0.02, 0.99)
    np.testing.assert_allclose(filled.positions[20:30, 0], output[20:30, 0], rtol=0, atol=1e-7)
    np.testing.assert_allclose(filled.positions[45:50, 4], output[45:50, 1], rtol=0, atol=1e-7)


def test_with_all_components_it_is_least_squares_or_the_mean() -> None:
    gappy = take(markers=8)
    gappy[20:30, 0] = gappy[25:32, 4] = np.nan
    whole, gaps = [1, 2, 3, 5, 6, 7], {0: slice(20, 30), 4: slice(25, 32)}
    middle = gappy[:, whole].mean(axis=1, keepdims=True)
    centred = gappy - middle
    complete = ~np.isnan(gappy).any(axis=(1, 2))
    known = np.column_stack([np.ones(len(gappy)), centred[:, whole].reshape(len(gappy), -1)])
    recording = make_recording(gappy)
    for marker, gap in gaps.items():
        learnt, *_ = np.linalg.lstsq(known[complete], centred[complete, marker], rcond=None)
        fitted = (known @ learnt + middle[:, 0])[gap]
        for scale in (50.0, 2000.0):
            filled = pca(
                recording,
                strategy="together",
                weight_scale=scale,
                weight_missing=1e-6,
                singular_values=1.0,
            )
            np.testing.assert_allclose(filled.positions[gap, marker], fitted, rtol=0, atol=1e-3)
        filled = pca(recording, strategy="together", weight_missing=0.5, singular_values=1.0)
        mean = (centred[complete, marker].mean(axis=0) + middle[:, 0])[gap]
        np.testing.assert_allclose(filled.positions[gap, marker], mean, rtol=0, atol=1e-3)


def test_a_near_marker_with_another_gap_is_asked_a_far_one_is_not() -> None:
    near, far = take(), take()
    near[:, 1] += near[:, 0].mean(axis=0) - near[:, 1].mean(axis=0) + [1.0, 0.0, 0.0]
    far[:, 1] += far[:, 0].mean(axis=0) - far[:, 1].mean(axis=0) + [500.0, 0.0, 0.0]
    for positions, used in ((near, True), (far, False)):
        positions[20:30, 0] = positions[40:45, 1] = np.nan
        moved = positions.copy()
        moved[:, 1] += np.random.default_rng(1).normal(size=(60, 3))
        first, second = (
            pca(make_recording(p), weight_scale=200.0).positions[20:30, 0]
            for p in (positions, moved)
        )
        assert np.array_equal(first, second) is not used


@pytest.mark.parametrize("strategy", ["each", "together"])
def test_without_a_complete_frame_it_is_refused(strategy: Strategy) -> None:
    gappy = take()
    gappy[:, 1] = gappy[:, 0] + 1.0
    gappy[::2, 0] = gappy[1::2, 1] = np.nan
    message = r"needs one complete frame: none of 60 has .* \(2 of 6 markers have gaps to fill; at "
    with pytest.raises(Refusal, match=message + "most 5 are present at once"):
        pca(make_recording(gappy), strategy=strategy)


def test_a_marker_without_a_complete_frame_is_left_and_reported() -> None:
    gappy = take()
    gappy[:, 1] = gappy[:, 0] + 1.0
    gappy[::2, 0] = gappy[1::2, 1] = gappy[:5, 4] = np.nan
    message = "^60 samples of 2 markers left missing: no marker to fill from, or no frame complete "
    with pytest.warns(UserWarning, match=message + "with those 60$"):
        filled = pca(make_recording(gappy))
    assert filled.present[:, 4].all()


def test_static_markers_tell_nothing_and_are_filled() -> None:
    truth = take()
    truth[:] = truth[0]
    gappy = truth.copy() + np.array([1234.5, 0.1, 0.2])
    gappy[4:9, 2] = np.nan
    filled = pca(make_recording(gappy))
    np.testing.assert_allclose(filled.positions[6, 2], gappy[3, 2], rtol=0, atol=1e-9)


def test_an_unknown_strategy_is_refused() -> None:
    with pytest.raises(ValueError, match="strategy must be each or together, got 'both'"):
        pca(make_recording(take()), strategy="both")
