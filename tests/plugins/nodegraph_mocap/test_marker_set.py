from __future__ import annotations

from typing import Any

import pytest

from nodegraph_mocap import MarkerSet

FACE = MarkerSet(
    markers=("l", "r", "nose", "chin"),
    pairs=(("l", "r"),),
    midline=("nose", "chin"),
    stable=("nose",),
    edges=(("l", "nose"), ("nose", "r"), ("nose", "chin")),
)


@pytest.mark.parametrize(
    ("part", "names"),
    [("pairs", (("l", "x"),)), ("midline", ("x",)), ("stable", ("x",)), ("edges", (("x", "l"),))],
)
def test_a_part_that_names_no_marker_is_refused(part: str, names: Any) -> None:
    with pytest.raises(ValueError, match=f"marker set: {part} names unknown markers: x"):
        MarkerSet(markers=("l", "r"), **{part: names})


def test_a_marker_listed_twice_is_refused() -> None:
    with pytest.raises(ValueError, match="listed twice: a, b"):
        MarkerSet(markers=("b", "a", "b", "a", "c"))


def test_keeping_leaves_out_what_names_another() -> None:
    assert FACE.keep(["chin", "nose", "r"]) == MarkerSet(
        markers=("chin", "nose", "r"),
        midline=("nose", "chin"),
        stable=("nose",),
        edges=(("nose", "r"), ("nose", "chin")),
    )
    assert FACE.keep(FACE.markers) == FACE


def test_keeping_all_of_a_pair_keeps_the_pair() -> None:
    assert FACE.keep(["r", "l"]).pairs == (("l", "r"),)
