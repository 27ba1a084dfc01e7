from __future__ import annotations

import numpy as np
import pytest

from nodegraph_synthesize.smooth_noise import smooth_noise


@pytest.mark.parametrize("cutoff", [0.5, 2.0, 8.0])
def test_curves_have_mean_0_and_deviation_1(cutoff: float) -> None:
    curves = smooth_noise(np.random.default_rng(0), 6000, [cutoff] * 40, 60.0)
    assert curves.shape == (6000, 40)
    assert np.sqrt(np.mean(curves**2)) == pytest.approx(1.0, abs=0.06)
    assert abs(np.mean(curves)) < 0.06


def test_nothing_is_left_above_the_cutoff() -> None:
    curve = smooth_noise(np.random.default_rng(0), 4096, [2.0], 60.0)[:, 0]
    power = np.abs(np.fft.rfft(curve * np.hanning(4096))) ** 2
    frequencies = np.fft.rfftfreq(4096, 1 / 60.0)
    assert power[frequencies > 6.0].sum() < 1e-5 * power.sum()


def test_the_end_knows_nothing_of_the_start() -> None:
    curves = smooth_noise(np.random.default_rng(0), 1024, [0.5] * 400, 60.0)
    assert abs(np.corrcoef(curves[0], curves[-1])[0, 1]) < 0.2
