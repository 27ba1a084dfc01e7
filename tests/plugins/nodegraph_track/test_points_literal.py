"""Points typed into a graph become a recording, or an error that names the marker."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph import GraphError
from nodegraph.graph import Graph, build
from nodegraph.graphfile import read_graph_text
from nodegraph.plugin.registry import Registry
from nodegraph_mocap import Origin
from nodegraph_track.points_literal import literal
from tests.texts import any_text

REGISTRY = Registry.of((literal,), plugin="track")
NUMBERS = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(10**9), 10**9)


def test_points_in_the_plane_lie_at_z_0() -> None:
    recording = literal(points={"a": [1, 1], "b": [1, 2], "c": [3, 2]})
    assert recording.markers == ("a", "b", "c")
    np.testing.assert_array_equal(recording.positions, [[[1, 1, 0], [1, 2, 0], [3, 2, 0]]])
    assert (recording.rate, recording.marker_set) == (1.0, None)
    assert (recording.origin == Origin.MEASURED).all()


@given(
    st.integers(1, 4).flatmap(
        lambda frames: st.dictionaries(
            any_text(),
            st.lists(st.lists(NUMBERS, min_size=3, max_size=3), min_size=frames, max_size=frames),
            min_size=1,
            max_size=5,
        )
    )
)
def test_every_number_comes_out_where_it_went_in(points: dict[str, list[list[float]]]) -> None:
    recording = literal(points=points)
    for column, (marker, frames) in enumerate(points.items()):
        assert recording.markers[column] == marker
        np.testing.assert_array_equal(recording.positions[:, column], np.array(frames, dtype=float))


WRONG: list[tuple[dict[str, object], str]] = [
    ({"Brow": [1]}, "[x, y] or [x, y, z] in finite numbers for 'Brow', not [1]"),
    ({"Brow": [1, 2, 3, 4]}, "for 'Brow', not [1, 2, 3, 4]"),
    ({"Brow": "[1, 2]"}, "for 'Brow', not '[1, 2]'"),
    ({"Brow": []}, "for 'Brow', not []"),
    ({"Brow": [[1, 2], []]}, "for 'Brow', not []"),
    ({"Brow": [[1, 2], 3]}, "for 'Brow', not 3"),
    ({"Brow": [1, [2, 3]]}, "for 'Brow', not [1, [2, 3]]"),
    ({"Brow": [1, math.nan]}, "for 'Brow', not [1, nan]"),
    ({"Brow": [-math.inf, 1]}, "for 'Brow', not [-inf, 1]"),
    ({"Brow": [10**400, 1]}, "for 'Brow', not [1"),
    ({"Brow": [True, 1]}, "for 'Brow', not [True, 1]"),
    ({"Brow": ["1", 1]}, "for 'Brow', not ['1', 1]"),
    ({"Brow": [None, 1], "Lip": [1]}, "not [None, 1]; should have [x, y] or [x, y, z] in finite "),
    ({"Brow": [[1, 2], None]}, "for 'Brow', not None"),
    ({"Brow": [1, 2], "Lip": [[1, 2], [3, 4]]}, "for every marker: 'Brow' has 1, 'Lip' has 2"),
    ({}, "should name at least one marker"),
]


@pytest.mark.parametrize(("points", "message"), WRONG)
def test_what_is_no_point_names_its_marker(points: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=r"^points should ") as caught:
        literal(points=points)
    assert message in str(caught.value)


def graph(folder: Path, points: str, more: str = "") -> Graph:
    lines = (
        "nodegraph: 1",
        "title: Points",
        "nodes:",
        "  x:",
        "    use: points.literal",
        f"    with: {{points: {points}{more}}}",
    )
    return build(read_graph_text("\n".join(lines), "points.yaml", folder), REGISTRY)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ("{Brow_L: [1, x]}", "should have [x, y] or [x, y, z] in finite numbers for 'Brow_L', not"),
        ("[[1, 2]]", "should be an object"),
        ("{Brow_L: [1, 2], Lip: []}", "for 'Lip', not []"),
    ],
)
def test_a_graph_with_wrong_points_is_refused(tmp_path: Path, points: str, message: str) -> None:
    with pytest.raises(GraphError) as caught:
        graph(tmp_path, points)
    assert "points.yaml:6:20: x: setting 'points' of points.literal " in str(caught.value)
    assert message in str(caught.value)


@pytest.mark.parametrize("rate", ["0", ".nan", "fast"])
def test_the_rate_is_a_positive_number(tmp_path: Path, rate: str) -> None:
    with pytest.raises(GraphError, match=r"setting 'rate' of points\.literal"):
        graph(tmp_path, "{a: [1, 2]}", f", rate: {rate}")
