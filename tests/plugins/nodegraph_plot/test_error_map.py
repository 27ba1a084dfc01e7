"""Errors are drawn where the marker is, in the colour of their size."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import PathCollection

from nodegraph import Across
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.view import frontal
from nodegraph_plot.error_map import error_map
from tests.plugins.nodegraph_plot import made_face


def across(**recordings: Trajectories) -> Across[Trajectories]:
    return Across.of(recordings, axis="fill")


def drawn(axis: Any, label: str) -> PathCollection:
    return next(
        artist
        for artist in axis.collections
        if isinstance(artist, PathCollection) and artist.get_label() == label
    )


def count(axis: Any, label: str) -> int:
    return len(np.asarray(drawn(axis, label).get_offsets()))


def smoothed(offset: float) -> Trajectories:
    """Return the truth with every marker off by a share of an offset, all of it repaired."""
    truth = made_face.truth()
    size = offset * np.arange(len(made_face.MARKERS)) / 10
    positions = truth.positions + size[:, np.newaxis] * np.array([0.6, 0.0, 0.8])
    changed = np.ones(positions.shape[:2], bool)
    return truth.with_samples(positions, changed=changed, origin=Origin.REPAIRED)


def test_each_marker_has_the_colour_of_its_error_at_its_mean_place() -> None:
    truth, recording = made_face.truth(), smoothed(5.0)
    (axis, _) = error_map(across(one=recording), truth).axes
    dots = drawn(axis, "error")
    place = frontal(truth, "auto").project(truth.positions.mean(axis=0))
    assert np.asarray(dots.get_offsets()) == pytest.approx(place)
    assert np.asarray(dots.get_array()) == pytest.approx(0.5 * np.arange(len(made_face.MARKERS)))
    assert count(axis, "no sample") == 0


def test_only_made_samples_count_and_the_others_are_hollow() -> None:
    recording = made_face.filled(3.0)
    with pytest.warns(UserWarning, match="drawn hollow: one 8"):
        (axis, _) = error_map(across(one=recording), made_face.truth()).axes
    assert np.asarray(drawn(axis, "error").get_array()) == pytest.approx([3.0 * np.sqrt(3)])
    assert count(axis, "no sample") == len(made_face.MARKERS) - 1
    whole = error_map(across(one=recording), made_face.truth(), samples="all").axes[0]
    errors = np.asarray(drawn(whole, "error").get_array())
    assert errors[made_face.GAP_MARKER] == pytest.approx(3.0 * np.sqrt(3 * 6 / made_face.FRAMES))
    assert np.count_nonzero(errors) == 1


def test_all_pictures_have_one_scale() -> None:
    figure = error_map(across(small=smoothed(1.0), large=smoothed(4.0)), made_face.truth())
    for axis in figure.axes[:2]:
        assert drawn(axis, "error").get_clim() == pytest.approx((0.0, 3.2))


def test_markers_are_matched_by_name() -> None:
    truth = made_face.truth()
    turned = smoothed(5.0).keep(made_face.MARKERS[::-1])
    (axis, _) = error_map(across(one=turned), truth).axes
    errors = np.asarray(drawn(axis, "error").get_array())
    assert errors[::-1] == pytest.approx(0.5 * np.arange(len(made_face.MARKERS)))


def test_two_markers_and_markers_on_a_line_are_drawn_without_triangles() -> None:
    for names in (("nose", "chin"), ("nose", "forehead", "chin")):
        flat = made_face.truth().positions * np.array([0.0, 1.0, 1.0])
        truth = replace(made_face.truth(), positions=flat).keep(names)
        recording = replace(truth, positions=truth.positions + 1.0)
        figure = error_map(across(one=recording), truth, samples="all", view="+x+y")
        assert count(figure.axes[0], "error") == len(names)


def test_what_cannot_be_compared_is_an_error() -> None:
    truth = made_face.truth()
    with pytest.raises(ValueError, match="no recording has a sample"):
        error_map(across(one=made_face.gappy()), truth)
    with pytest.raises(ValueError, match="b has no markers: there is nothing to draw"):
        error_map(across(a=made_face.filled(1.0), b=truth.keep(())), truth)
    shorter = replace(truth, positions=truth.positions[:5], origin=truth.origin[:5])
    with pytest.raises(ValueError, match="the truth has 5 frames"):
        error_map(across(one=made_face.filled(1.0)), shorter)
