from __future__ import annotations

import numpy as np
import pytest

from nodegraph_mocap.shape_names import matched, sides_as

LIVE_LINK = ("EyeBlinkLeft", "BrowInnerUp", "MouthRight", "MouthSmileRight")
ARKIT = ("mouthSmileRight", "eyeBlinkLeft", "mouthRight", "browInnerUp")
FACE_CAP = ("browInnerUp", "mouthRight", "eyeBlink_L", "mouthSmile_R")


@pytest.mark.parametrize("names", [LIVE_LINK, ARKIT, FACE_CAP])
@pytest.mark.parametrize("others", [LIVE_LINK, ARKIT, FACE_CAP])
def test_the_conventions_match_each_other(names: tuple[str, ...], others: tuple[str, ...]) -> None:
    plain = {name.lower().replace("_l", "left").replace("_r", "right"): name for name in others}
    expected = {
        name: plain[name.lower().replace("_l", "left").replace("_r", "right")] for name in names
    }
    pairs = matched(names, others)
    assert pairs == expected
    assert tuple(pairs) == names


@pytest.mark.parametrize(
    ("name", "other"),
    [("jaw.L", "jawLeft"), ("JAW_OPEN", "jawOpen"), ("jaw open", "jawOpen"), ("jaw-l", "jaw_L")],
)
def test_capitals_and_what_stands_between_words_do_not_count(name: str, other: str) -> None:
    assert matched([name], [other]) == {name: other}


@pytest.mark.parametrize(
    ("name", "other"),
    [("jawOpen", "jawOpened"), ("eyeBlink_L", "eyeBlink_R"), ("eyeBlink", "eyeBlink_L"),
     ("squeal", "squeaLeft"), ("roller", "rolleRight")],
)  # fmt: skip
def test_other_shapes_do_not_match(name: str, other: str) -> None:
    assert matched([name], [other]) == {}


def test_the_same_writing_comes_first() -> None:
    both = ["eyeBlink_L", "EyeBlinkLeft"]
    assert matched(both, both) == {name: name for name in both}


def test_a_name_that_may_be_two_others_is_an_error() -> None:
    with pytest.raises(ValueError, match="'eyeBlinkLeft' may be 'eyeBlink_L' or 'EyeBlinkLeft'"):
        matched(["eyeBlinkLeft"], ["eyeBlink_L", "EyeBlinkLeft"])


@pytest.mark.parametrize("names", [["eyeBlink_L", "EyeBlinkLeft"], ["jawOpen", "JawOpen"]])
def test_two_names_for_one_other_are_an_error(names: list[str]) -> None:
    other = names[0].replace("_L", "Left")
    message = f"'{names[0]}' and '{names[1]}' both mean '{other}'"
    with pytest.raises(ValueError, match=message):
        matched(names, [other])


@pytest.mark.parametrize("shape", ["BrowInnerUp", "cheekPuff", "mouthPucker", "noseSneer"])
@pytest.mark.parametrize(("left", "right"), [("_L", "_R"), ("Left", "Right"), (".l", ".r")])
def test_a_shape_that_one_convention_splits_into_sides(shape: str, left: str, right: str) -> None:
    whole, halves = ["jawOpen", shape], [shape.lower() + right, "JawOpen", shape.lower() + left]
    split = sides_as(whole, halves)
    assert split.names == ("jawOpen", halves[2], halves[0])
    assert split.of(np.array([[1.0, 0.25], [np.nan, 3.0]])).tolist()[0] == [1, 0.25, 0.25]
    assert split.notes == (
        f"1 weights without sides count for the left and the right shape: {shape}",
    )
    joined = sides_as(halves, whole)
    assert joined.names == ("JawOpen", shape)
    assert joined.of(np.array([0.5, 0.75, 1.0])).tolist() == [0.75, 0.75]
    assert joined.notes == (
        f"1 shapes without sides get the mean of a left and a right weight: {shape}",
    )


@pytest.mark.parametrize(
    ("names", "others"),
    [
        (["browInnerUp"], ["browInnerUp_L"]),
        (["browInnerUp", "browInnerUp_L"], ["browInnerUp_L", "browInnerUp_R"]),
        (["browInnerUp_L", "browInnerUp_R"], ["BrowInnerUp", "BrowInnerUpLeft"]),
        (["mouthLeft", "mouthRight"], ["mouth_L", "mouth_R"]),
    ],
)
def test_sides_are_only_made_where_both_are_free(names: list[str], others: list[str]) -> None:
    sides = sides_as(names, others)
    assert (sides.names, sides.notes) == (tuple(names), ())
    values = np.random.default_rng(0).normal(size=(3, len(names)))
    np.testing.assert_array_equal(sides.of(values), values)
