"""Errors are drawn where the marker is, as discs on one scale, over all takes of a method."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection

from nodegraph import Across, Label
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.view import frontal
from nodegraph_plot.error_map import error_map
from nodegraph_tables.figures import store_figure
from tests.plugins.nodegraph_plot import made_face


def across(**recordings: Trajectories) -> Across[Trajectories]:
    return Across.of(recordings, axis="fill")


def alone(truth: Trajectories) -> Across[Trajectories]:
    return Across((), (({}, truth),))


def drawn(axis: Axes, label: str) -> PathCollection:
    return next(
        artist
        for artist in axis.collections
        if isinstance(artist, PathCollection) and artist.get_label() == label
    )


def count(axis: Axes, label: str) -> int:
    return len(np.asarray(drawn(axis, label).get_offsets()))


def smoothed(offset: float) -> Trajectories:
    """Return the truth with every marker off by a share of an offset, all of it repaired."""
    truth = made_face.truth()
    size = offset * np.arange(len(made_face.MARKERS)) / 10
    positions = truth.positions + size[:, np.newaxis] * np.array([0.6, 0.0, 0.8])
    changed = np.ones(positions.shape[:2], bool)
    return truth.with_samples(positions, changed=changed, origin=Origin.REPAIRED)


def errors_of(axis: Axes) -> Any:
    return np.asarray(drawn(axis, "error").get_array())


def numbers_of(axis: Axes) -> list[str]:
    return [text.get_text() for text in axis.texts]


def test_each_marker_has_a_disc_of_its_error_at_its_mean_place() -> None:
    truth, recording = made_face.truth(), smoothed(5.0)
    axis, numbers = error_map(across(one=recording), alone(truth)).axes
    dots = drawn(axis, "error")
    place = frontal(truth, "auto").project(truth.positions.mean(axis=0))
    assert np.asarray(dots.get_offsets()) == pytest.approx(place)
    assert errors_of(axis) == pytest.approx(0.5 * np.arange(len(made_face.MARKERS)))
    assert count(axis, "no sample") == 0
    areas = np.asarray(dots.get_sizes())[1:]
    # equal ratios of errors are equal differences of areas
    assert areas[3] - areas[1] == pytest.approx(areas[7] - areas[3])
    assert numbers_of(numbers) == [str(made_face.FRAMES)] * len(made_face.MARKERS)


def test_only_made_samples_count_and_the_others_are_hollow() -> None:
    recording, truth = made_face.filled(3.0), alone(made_face.truth())
    with pytest.warns(UserWarning, match="drawn hollow: one 8"):
        axis, numbers = error_map(across(one=recording), truth).axes
    assert errors_of(axis) == pytest.approx([3.0 * np.sqrt(3)])
    assert count(axis, "no sample") == len(made_face.MARKERS) - 1
    assert numbers_of(numbers).count("0") == len(made_face.MARKERS) - 1
    whole = error_map(across(one=recording), truth, samples="all").axes[0]
    errors = errors_of(whole)
    assert errors[made_face.GAP_MARKER] == pytest.approx(3.0 * np.sqrt(3 * 6 / made_face.FRAMES))
    assert np.count_nonzero(errors) == 1


def test_all_pictures_have_one_scale() -> None:
    recordings = across(small=smoothed(1.0), large=smoothed(4.0))
    small, large, _ = error_map(recordings, alone(made_face.truth())).axes
    for axis in (small, large):
        assert drawn(axis, "error").get_clim() == pytest.approx((0.1, 3.2))
    sizes = [np.asarray(drawn(axis, "error").get_sizes()) for axis in (small, large)]
    assert sizes[0][4] == pytest.approx(sizes[1][1])


def over_takes(**sizes: tuple[float, ...]) -> Across[Trajectories]:
    entries: tuple[tuple[dict[str, Label], Trajectories], ...] = tuple(
        ({"take": take, "smooth": name}, smoothed(size))
        for name, each in sizes.items()
        for take, size in enumerate(each)
    )
    return Across(("take", "smooth"), entries)


def test_takes_of_one_method_are_one_picture_with_their_mean_error() -> None:
    truth = Across.of(dict.fromkeys(range(3), made_face.truth()), axis="take")
    recordings = over_takes(a=(1.0, 2.0, 6.0), b=(1.0, 1.0))
    first, second, numbers = error_map(recordings, truth).axes
    assert errors_of(first) == pytest.approx(0.3 * np.arange(9))
    assert errors_of(second) == pytest.approx(0.1 * np.arange(9))
    assert [axis.get_title().split("\n")[0] for axis in (first, second)] == ["a", "b"]
    assert "3 takes" in first.get_title()
    assert numbers_of(numbers) == [str(2 * made_face.FRAMES)] * 9
    assert "at least" in numbers.get_title()


def test_each_recording_is_compared_with_the_truth_of_its_labels() -> None:
    truth = made_face.truth()
    moved = replace(truth, positions=truth.positions + 5.0)
    recordings = Across(
        ("take", "fill"),
        tuple(({"take": take, "fill": "a"}, replace(truth, positions=truth.positions + off))
              for take, off in (("here", 1.0), ("there", 4.0))),
    )  # fmt: skip
    truths = Across.of({"there": moved, "here": truth}, axis="take")
    (axis, _) = error_map(recordings, truths, samples="all").axes
    assert errors_of(axis) == pytest.approx([np.sqrt(3)] * 9)
    with pytest.raises(ValueError, match="no truth of there, a"):
        error_map(recordings, Across.of({"here": truth}, axis="take"))
    with pytest.raises(ValueError, match="2 truths of one: fix take"):
        error_map(across(one=truth), truths)


def test_equal_errors_one_marker_and_no_errors_are_drawn() -> None:
    truth = made_face.truth()
    for off in (1.0, 0.0):
        recording = replace(truth, positions=truth.positions + off)
        for markers in (made_face.MARKERS, ("nose",)):
            figure = error_map(
                across(one=recording.keep(markers)), alone(truth.keep(markers)), samples="all"
            )
            assert count(figure.axes[0], "error") == len(markers)
            assert store_figure(figure).svg


def test_what_cannot_be_compared_is_an_error() -> None:
    truth = made_face.truth()
    with pytest.raises(ValueError, match="no recording has a sample"):
        error_map(across(one=made_face.gappy()), alone(truth))
    with pytest.raises(ValueError, match="b has no markers: there is nothing to draw"):
        error_map(across(a=made_face.filled(1.0), b=truth.keep(())), alone(truth))
    shorter = replace(truth, positions=truth.positions[:5], origin=truth.origin[:5])
    with pytest.raises(ValueError, match="the truth has 5 frames"):
        error_map(across(one=made_face.filled(1.0)), alone(shorter))
