"""Markers belong together as the marker set says, and each that it does not place is alone."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import pytest

from nodegraph_mocap import MarkerSet, Trajectories
from nodegraph_select.pairs import in_order, membership, pairs_of, sizes
from tests.plugins.nodegraph_select.faces import make_face

PAIRS = (
    ("lip_left", "lip_right"), ("brow_left", "brow_right"), ("cheek_left", "cheek_right"),
    ("jaw_left", "jaw_right"), ("chin",), ("nose",), ("forehead",),
)  # fmt: skip


def test_pairs_then_the_midline(face: Trajectories) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert pairs_of(face) == PAIRS


def test_neither_in_a_pair_nor_on_the_midline_is_alone_and_reported(face: Trajectories) -> None:
    known = face.marker_set
    assert known is not None
    some = replace(face, marker_set=replace(known, pairs=known.pairs[1:], midline=("nose",)))
    with pytest.warns(UserWarning, match=r"^4 of 11 markers .*: lip_left, lip_right, chin, forehe"):
        selection = pairs_of(some)
    assert selection == (
        *PAIRS[1:4], ("nose",), ("lip_left",), ("lip_right",), ("chin",), ("forehead",)
    )  # fmt: skip


def test_without_its_partner_in_the_recording_a_marker_is_alone(face: Trajectories) -> None:
    some = face.keep([name for name in face.markers if name != "jaw_right"])
    with pytest.warns(UserWarning, match="in no pair with another marker.*: jaw_left$"):
        selection = pairs_of(some)
    assert selection == (*PAIRS[:3], ("chin",), ("nose",), ("forehead",), ("jaw_left",))


def test_a_marker_set_of_more_markers_than_the_recording_has(face: Trajectories) -> None:
    some = replace(face.keep(("lip_left", "nose")), marker_set=face.marker_set)
    with pytest.warns(UserWarning, match="1 of 2 markers"):
        assert pairs_of(some) == (("nose",), ("lip_left",))


def test_without_a_marker_set_all_are_alone(face: Trajectories) -> None:
    bare = replace(face, marker_set=None)
    with pytest.warns(UserWarning, match="11 of 11 .* no marker set.* and 5 more$"):
        assert pairs_of(bare) == tuple((name,) for name in face.markers)


@pytest.mark.parametrize(
    "values",
    [
        {"pairs": (("a", "b"), ("b", "c"))},
        {"pairs": (("a", "b"),), "midline": ("b",)},
    ],
)
def test_a_marker_in_two_places(values: dict[str, Any]) -> None:
    abc = replace(make_face().keep(("chin", "nose", "forehead")), markers=("a", "b", "c"))
    bad = replace(abc, marker_set=MarkerSet(markers=("a", "b", "c"), **values))
    with pytest.raises(ValueError, match="marker set: b: in more than one pair, or"):
        pairs_of(bad)


def test_numbers_sizes_and_the_order_of_the_recording(face: Trajectories) -> None:
    assert membership(PAIRS, ("jaw_right", "chin", "lip_left")).tolist() == [3, 4, 0]
    assert sizes(PAIRS).tolist() == [2, 2, 2, 2, 1, 1, 1]
    assert in_order(face, [PAIRS[5], PAIRS[0]]) == ("lip_left", "lip_right", "nose")
