from __future__ import annotations

import pytest

from nodegraph_mocap.shape_names import matched

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


def test_a_name_without_match_is_left_out() -> None:
    assert matched(["jawOpen", "HeadYaw"], ["JawOpen"]) == {"jawOpen": "JawOpen"}


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
