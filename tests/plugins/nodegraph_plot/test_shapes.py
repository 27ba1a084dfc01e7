"""Shapes are drawn over their references, and D is the sum of square differences."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from nodegraph import Across
from nodegraph_mocap import Trajectories
from nodegraph_plot.shapes import shapes
from tests.plugins.nodegraph_plot import made_face

X = {"a": (1.0, 1.0), "b": (1.0, 2.0), "c": (3.0, 2.0)}
Y = {"a": (-3.0, -2.0), "b": (-3.0, -4.0), "c": (-7.0, -4.0)}


def flat(points: dict[str, tuple[float, float]]) -> Trajectories:
    positions = np.array([[(*point, 0.0) for point in points.values()]])
    return Trajectories(positions=positions, markers=tuple(points), rate=1.0)


def of(**drawn: Trajectories) -> Across[Trajectories]:
    return Across.of(drawn, axis="step")


def dots(axis: Axes) -> dict[str, Any]:
    return {
        str(line.get_label()): np.column_stack(line.get_data())
        for line in axis.lines
        if not str(line.get_label()).startswith("_")
    }


def segments(axis: Axes) -> list[Any]:
    """Return the lines of the reference, of the shape, and between the two."""
    drawn = [artist for artist in axis.collections if isinstance(artist, LineCollection)]
    return [np.array(artist.get_segments()).reshape(-1, 2, 2) for artist in drawn]


def test_the_worked_example_as_it_is() -> None:
    (axis,) = shapes(of(original=flat(X)), of(original=flat(Y))).axes
    assert axis.get_title() == "original\nD = 213"
    np.testing.assert_array_equal(dots(axis)["shape"], list(X.values()))
    np.testing.assert_array_equal(dots(axis)["reference"], list(Y.values()))
    around, inner, between = segments(axis)
    corners = np.array(list(Y.values()))
    np.testing.assert_array_equal(around, np.stack([corners, corners[[1, 2, 0]]], axis=1))
    assert len(inner) == 3
    np.testing.assert_array_equal(between, np.stack([list(X.values()), corners], axis=1))


def test_a_panel_per_shape_in_their_order_each_with_its_own_reference() -> None:
    references = of(two=flat(X), one=flat(Y))
    figure = shapes(of(one=flat(X), two=flat(X)), references)
    assert [axis.get_title() for axis in figure.axes] == ["one\nD = 213", "two\nD = 0"]
    figure.savefig(io.BytesIO(), format="svg")


def test_one_reference_serves_all() -> None:
    figure = shapes(of(one=flat(X), two=flat(Y)), Across((), (({}, flat(Y)),)))
    assert [axis.get_title() for axis in figure.axes] == ["one\nD = 213", "two\nD = 0"]


def test_points_are_matched_by_name() -> None:
    (axis,) = shapes(of(a=flat(X).keep("cab")), of(a=flat(X))).axes
    assert axis.get_title() == "a\nD = 0"
    (axis,) = shapes(of(a=flat(X).keep("ab")), of(a=flat(Y))).axes
    assert axis.get_title() == "a\nD = 77"


def test_a_face_is_joined_by_its_edges_and_seen_from_the_front() -> None:
    face = made_face.gappy()
    (axis,) = shapes(of(a=face), of(a=made_face.truth()), frame=17).axes
    around, inner, between = segments(axis)
    assert len(around) == 3
    # two of the three edges end at the missing corner of the mouth
    assert len(inner) == 1
    assert len(between) == len(made_face.MARKERS) - 1
    assert dots(axis)["reference"] == pytest.approx(made_face.truth().positions[17, :, :2])


def test_the_frame_is_drawn_that_is_asked_for() -> None:
    face = made_face.truth()
    first = replace(face, positions=face.positions[:1], origin=face.origin[:1])
    (axis,) = shapes(of(a=face), of(a=first), frame=9).axes
    apart = np.sum((face.positions[9] - face.positions[0]) ** 2)
    assert axis.get_title() == f"a\nD = {apart:.4g}"


def test_what_cannot_be_drawn_is_reported() -> None:
    with pytest.raises(ValueError, match="no frame 3 of a: it has 1 frames"):
        shapes(of(a=flat(X)), of(a=flat(Y)), frame=3)
    whole = made_face.truth()
    two = replace(whole, positions=whole.positions[:2], origin=whole.origin[:2])
    with pytest.raises(ValueError, match="no frame 3 of the reference a: it has 2 frames"):
        shapes(of(a=made_face.truth()), of(a=two), frame=3)
    with pytest.raises(ValueError, match="the shape b has 0 references, not one"):
        shapes(of(a=flat(X), b=flat(X)), of(a=flat(Y)))
    others = flat({"p": (0.0, 0.0), "q": (1.0, 0.0)})
    with pytest.raises(ValueError, match="a: the shape and its reference have no marker in common"):
        shapes(of(a=flat(X)), of(a=others))
    with pytest.raises(ValueError, match="there is no recording to draw"):
        shapes(of(), of(a=flat(Y)))
    with pytest.raises(ValueError, match="view"):
        shapes(of(a=flat(X)), of(a=flat(Y)), view="+x+x")


def test_nothing_but_missing_points_is_an_empty_panel() -> None:
    nothing = Trajectories(positions=np.full((1, 3, 3), np.nan), markers=tuple(X), rate=1.0)
    (axis,) = shapes(of(a=nothing), of(a=nothing)).axes
    assert axis.get_title() == "a\nno point is in both"
