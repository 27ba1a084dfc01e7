"""Spectra are Welch's, over samples without a gap."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure as MatplotlibFigure
from scipy.signal import welch

from nodegraph import Across
from nodegraph_mocap import Trajectories
from nodegraph_plot.spectra import spectra
from tests.plugins.recordings import make_recording

RATE, FRAMES, SEGMENT = 60.0, 600, 128


def across(**recordings: Trajectories) -> Across[Trajectories]:
    return Across.of(recordings, axis="smooth")


def noise(seed: int, *, markers: int = 3) -> Trajectories:
    positions = np.random.default_rng(seed).normal(0, 1.5, (FRAMES, markers, 3))
    return make_recording(positions)


def lines(figure: MatplotlibFigure) -> dict[str, Any]:
    return {str(line.get_label()): line.get_xydata() for line in figure.axes[0].lines}


def test_the_line_is_the_mean_of_the_markers_and_the_sum_of_the_coordinates() -> None:
    take = noise(0)
    line = lines(spectra(across(raw=take), segment=SEGMENT))["raw"]
    frequency, density = welch(take.positions, fs=RATE, nperseg=SEGMENT, axis=0)
    assert line[:, 0] == pytest.approx(frequency[1:])
    assert line[:, 1] == pytest.approx(density.sum(axis=2).mean(axis=1)[1:])


def test_gaps_split_a_trajectory_and_runs_weigh_by_their_segments() -> None:
    take = noise(2, markers=1)
    positions = take.positions.copy()
    positions[300:310] = np.nan
    holed = Trajectories(positions=positions, markers=take.markers, rate=RATE)
    line = lines(spectra(across(raw=holed), segment=SEGMENT))["raw"]
    parts = [
        welch(run, fs=RATE, nperseg=SEGMENT, axis=0)[1].sum(axis=1)
        for run in (positions[:300, 0], positions[310:, 0])
    ]
    assert line[:, 1] == pytest.approx(((3 * parts[0] + 3 * parts[1]) / 6)[1:])


def test_markers_with_short_runs_only_are_left_out_and_reported() -> None:
    take = noise(3)
    positions = take.positions.copy()
    positions[::100, 1] = np.nan
    holed = Trajectories(positions=positions, markers=take.markers, rate=RATE)
    with pytest.warns(UserWarning, match="1 markers without 128 frames in a row are left out: m1"):
        line = lines(spectra(across(raw=holed), segment=SEGMENT))["raw"]
    rest = lines(spectra(across(raw=take), markers=("m0", "m2"), segment=SEGMENT))["raw"]
    assert line == pytest.approx(rest)


def test_the_default_segment_fits_half_of_the_markers() -> None:
    take = noise(4)
    assert len(lines(spectra(across(raw=take)))["raw"]) == 256 // 2
    positions = take.positions.copy()
    positions[::100, 1:] = np.nan
    holed = Trajectories(positions=positions, markers=take.markers, rate=RATE)
    assert len(lines(spectra(across(raw=holed)))["raw"]) == 64 // 2


def test_what_has_no_run_is_an_error() -> None:
    positions = noise(5).positions.copy()
    positions[::5] = np.nan
    holed = Trajectories(positions=positions, markers=("m0", "m1", "m2"), rate=RATE)
    with pytest.raises(ValueError, match="no 8 frames without a gap: fill it first"):
        spectra(across(raw=holed))
    with pytest.raises(ValueError, match="no marker of raw has 64 frames without a gap"):
        spectra(across(raw=holed), segment=64)
    with pytest.raises(ValueError, match="raw has no marker 'nose'"):
        spectra(across(raw=noise(6)), markers=("nose",))
    assert set(lines(spectra(across(raw=noise(6)), noise(7)))) == {"raw", "truth"}
