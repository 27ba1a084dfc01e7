"""The compiled passes equal the textbook's, where nothing is known of the first state."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_smooth import kalman_kernel


@pytest.mark.parametrize("order", [2, 3])
def test_equals_the_covariance_form_with_a_wide_prior(order: int) -> None:
    """Kalman's filter and the smoother of Rauch, Tung & Striebel, with covariances."""
    density, length = 0.4, 25
    run = np.random.default_rng(order).normal(0, 1, length)
    step = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]])[:order, :order]
    full = np.array([[1 / 20, 1 / 8, 1 / 6], [1 / 8, 1 / 3, 1 / 2], [1 / 6, 1 / 2, 1]])
    noise = density * full[3 - order :, 3 - order :]
    mean, covariance = np.zeros(order), 1e7 * np.eye(order)
    filtered, predicted = [], []
    for sample in run:
        gain = covariance[:, 0] / (covariance[0, 0] + 1.0)
        mean = mean + gain * (sample - mean[0])
        covariance = covariance - np.outer(gain, covariance[0])
        filtered.append((mean, covariance))
        mean, covariance = step @ mean, step @ covariance @ step.T + noise
        predicted.append((mean, covariance))
    mean, covariance = filtered[-1]
    means, variances = [mean[0]], [covariance[0, 0]]
    for t in range(length - 2, -1, -1):
        back = filtered[t][1] @ step.T @ np.linalg.inv(predicted[t][1])
        mean = filtered[t][0] + back @ (mean - predicted[t][0])
        covariance = filtered[t][1] + back @ (covariance - predicted[t][1]) @ back.T
        means.append(mean[0])
        variances.append(covariance[0, 0])
    *matrices, variance = kalman_kernel.gains(length, order, density)
    smoothed = kalman_kernel.smooth(run[:, None], *matrices)[:, 0]
    np.testing.assert_allclose(smoothed, means[::-1], rtol=0, atol=1e-5)
    np.testing.assert_allclose(variance, variances[::-1], rtol=1e-5)


@pytest.mark.parametrize("order", [2, 3])
def test_as_many_samples_as_components_stay_as_they_are(order: int) -> None:
    run = np.random.default_rng(order).normal(0, 1, (order, 2))
    *matrices, variance = kalman_kernel.gains(order, order, 0.4)
    np.testing.assert_allclose(kalman_kernel.smooth(run, *matrices), run, rtol=0, atol=1e-12)
    np.testing.assert_allclose(variance, 1.0, rtol=1e-12)
