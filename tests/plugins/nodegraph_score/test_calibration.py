"""Whether the standard deviations that an estimate states are those of its errors."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import norm

from nodegraph_mocap import Mask, Trajectories
from nodegraph_score.calibration import Calibration, calibration
from nodegraph_tables import info_of

FRAMES, MARKERS = 400, 10
LEVELS = ("50 %", "80 %", "90 %", "95 %")
NAMES = tuple(f"m{number}" for number in range(MARKERS))
RANDOM = np.random.default_rng(3)
SIGMA = RANDOM.uniform(0.2, 3.0, (FRAMES, MARKERS))
ERROR = SIGMA[..., None] * RANDOM.normal(size=(FRAMES, MARKERS, 3))


def hidden() -> NDArray[np.bool_]:
    """Gaps of 60 frames, of 3 and, at the end, of 20."""
    mask = np.zeros((FRAMES, MARKERS), dtype=np.bool_)
    mask[10:70] = mask[100:103] = mask[-20:] = True
    return mask


def judged(sigma: NDArray[np.float64] | None, error: NDArray[np.float64] = ERROR) -> Calibration:
    places = RANDOM.normal(0.0, 40.0, (FRAMES, MARKERS, 3))
    truth = Trajectories(positions=places, markers=NAMES, rate=60.0)
    estimate = Trajectories(positions=places + error, markers=NAMES, rate=60.0, sigma=sigma)
    return calibration(estimate, truth, Mask(hidden=hidden(), markers=NAMES))


@pytest.mark.parametrize("stated", [1.0, 0.5])
def test_normal_errors_are_within_as_often_as_their_distribution_has_it(stated: float) -> None:
    table = judged(stated * SIGMA).table.set_index("frames")
    assert list(table.index) == ["1 to 5", "16 to 45", "over 45", "all"]
    assert list(table["samples"]) == [30, 200, 600, 830]
    for level in LEVELS:
        reach = norm.ppf(0.5 + float(level[:2]) / 200)
        expected = norm.cdf(stated * reach) - norm.cdf(-stated * reach)
        assert table.loc["all", level] == pytest.approx(expected, abs=0.03)
        within = np.abs(ERROR[10:70]) <= stated * reach * SIGMA[10:70, :, None]
        assert table.loc["over 45", level] == pytest.approx(within.mean(), abs=1e-12)
    width = 2 * norm.ppf(0.975) * stated * SIGMA[hidden()].mean()
    assert table.loc["all", "width"] == pytest.approx(width)


def test_samples_without_sigma_are_left_out_and_counted() -> None:
    sigma, error = SIGMA.copy(), ERROR.copy()
    sigma[10:70] = np.nan
    error[100, 0] = np.nan
    with pytest.warns(UserWarning, match="601 of 830 hidden samples"):
        table = judged(sigma, error).table
    assert list(table["frames"]) == ["1 to 5", "16 to 45", "all"]
    assert list(table["samples"]) == [29, 200, 229]
    assert "601 of 830" in " ".join(info_of(table).notes)
    with pytest.warns(UserWarning, match="830 of 830 hidden samples"):
        none = judged(None).table
    assert list(none["samples"]) == [0]
    assert none[[*LEVELS, "width"]].isna().all(axis=None)


def test_the_figure_has_a_line_per_row_beside_the_diagonal() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        table, figure = judged(SIGMA)
    (axis,) = figure.axes
    diagonal, *lines = axis.get_lines()
    np.testing.assert_array_equal(diagonal.get_xdata(), diagonal.get_ydata())
    for line, (_, row) in zip(lines, table.iterrows(), strict=True):
        np.testing.assert_array_equal(line.get_xdata(), [0.5, 0.8, 0.9, 0.95])
        np.testing.assert_array_equal(line.get_ydata(), row[[*LEVELS]].to_numpy(dtype=float))
        assert str(row["frames"]) in str(line.get_label())
