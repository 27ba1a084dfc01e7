from __future__ import annotations

import warnings

import numpy as np
import pytest

from nodegraph_files.missing import mark_missing

MARKERS = ("brow", "lip", "chin")
NONE = np.zeros((2, 3), dtype=np.bool_)


def test_whole_samples_stay_and_nothing_is_reported() -> None:
    positions = np.arange(1.0, 19.0).reshape(2, 3, 3)
    positions[1, 2] = np.nan
    np.testing.assert_array_equal(
        mark_missing(positions, NONE, MARKERS, zeros_missing=True), positions
    )


def test_what_the_file_calls_missing_is_not_reported_again() -> None:
    positions = np.zeros((2, 3, 3))
    positions[0, 0, 0] = np.inf
    lost = ~NONE
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.isnan(mark_missing(positions, lost, MARKERS, zeros_missing=True)).all()


def test_each_reason_is_counted_with_its_first_place() -> None:
    positions = np.ones((2, 3, 3))
    positions[0, 1] = 1, np.nan, 3
    positions[1, 0] = np.nan, np.inf, np.nan
    positions[1, 1] = positions[1, 2] = 0
    with pytest.warns(UserWarning) as caught:  # noqa: PT030
        read = mark_missing(positions, NONE, MARKERS, zeros_missing=True)
    assert [str(warning.message) for warning in caught] == [
        "1 samples are infinite and count as missing; the first is in frame 1, marker brow",
        "1 samples lack a coordinate and count as missing; the first is in frame 0, marker lip",
        "2 samples are at exactly (0, 0, 0) and count as missing; the first is in frame 1, "
        "marker lip",
    ]
    assert np.isnan(read).all(axis=2).sum() == 4
    assert np.isfinite(read).all(axis=2).sum() == 2


def test_a_coordinate_of_zero_is_no_missing_sample() -> None:
    positions = np.array([[[0.0, 0.0, 1.0]]])
    lost = np.zeros((1, 1), dtype=np.bool_)
    np.testing.assert_array_equal(
        mark_missing(positions, lost, MARKERS, zeros_missing=True), positions
    )
    np.testing.assert_array_equal(
        mark_missing(positions * 0, lost, MARKERS, zeros_missing=False), 0
    )
