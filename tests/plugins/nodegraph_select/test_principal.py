"""Rows of leading eigenvectors, beside a singular value decomposition of the same data."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_mocap import Trajectories
from nodegraph_select.features import Features, features_of
from nodegraph_select.pfa import leading_vectors


def plain(values: NDArray[np.float64], variance: float) -> NDArray[np.float64]:
    """Return the leading right singular vectors, the fewest that have the share."""
    _, singular, vectors = np.linalg.svd(values - values.mean(axis=0), full_matrices=False)
    for count in range(1, len(singular) + 1):
        if (singular[:count] ** 2).sum() / (singular**2).sum() >= variance:
            break
    return np.asarray(vectors[:count].T)


def same_up_to_signs(first: NDArray[np.float64], second: NDArray[np.float64]) -> None:
    assert first.shape == second.shape
    assert np.abs(first.T @ second) == pytest.approx(np.eye(first.shape[1]), abs=1e-6)


@pytest.mark.parametrize("variance", [0.3, 0.9, 0.98, 0.999])
@pytest.mark.parametrize("standardize", [False, True])
def test_the_fewest_vectors_that_have_the_share(
    face: Trajectories, variance: float, standardize: bool
) -> None:
    features = features_of(face)
    values = features.values / (features.values.std(axis=0) if standardize else 1.0)
    selection = leading_vectors(features, variance=variance, standardize=standardize)
    same_up_to_signs(selection, plain(values, variance))
    assert 1 <= selection.shape[1] < len(selection)


def test_all_of_the_variance_is_the_rank_and_not_rounding() -> None:
    random = np.random.default_rng(4)
    values = random.normal(size=(50, 3)) @ random.normal(size=(3, 12))
    features = Features(tuple("abcd"), values - values.mean(axis=0))
    assert leading_vectors(features, variance=1.0, standardize=False).shape == (12, 3)


@pytest.mark.parametrize(("variance", "kept"), [(0.25, 1), (0.26, 2), (0.5, 2), (0.75, 3)])
def test_a_share_that_is_reached_exactly_is_reached(variance: float, kept: int) -> None:
    signs = np.array([[1, 1, 1, 1], [1, -1, 1, -1], [1, 1, -1, -1], [1, -1, -1, 1]], float)
    values = np.concatenate([signs, -signs]) @ np.eye(4, 6)
    features = Features(("a", "b"), values)
    assert leading_vectors(features, variance=variance, standardize=False).shape[1] == kept


def test_what_stands_still_cannot_be_standardized_and_stays_zero(face: Trajectories) -> None:
    positions = face.positions.copy()
    positions[:, 2] = [1.1, 2.2, 3.3]
    features = features_of(replace(face, positions=positions))
    with pytest.warns(UserWarning, match="3 of 33 features do not move.*coordinates of chin$"):
        selection = leading_vectors(features, variance=0.98, standardize=True)
    number = features.markers.index("chin")
    assert selection[3 * number : 3 * number + 3] == pytest.approx(0.0, abs=1e-12)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        leading_vectors(features, variance=0.98, standardize=False)


@pytest.mark.parametrize("largest", [1.0, 1e-4])
def test_rounding_is_not_blown_up_to_a_standard_deviation_of_one(largest: float) -> None:
    random = np.random.default_rng(2)
    values = random.normal(0, largest, (60, 9)) * np.array([1, 1, 1, 1, 1, 1, 1, 1, 0])
    values[:, 8] = random.normal(0, 1e-12, 60)
    features = Features(("a", "b", "c"), values - values.mean(axis=0))
    with pytest.warns(UserWarning, match="1 of 9 features do not move.*coordinates of c$"):
        selection = leading_vectors(features, variance=1.0, standardize=True)
    assert selection.shape == (9, 8)
    assert selection[8] == pytest.approx(0.0, abs=1e-12)
