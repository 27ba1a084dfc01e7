"""Gaps of real recordings' lengths and patterns, cut into recordings of real faces."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_gaps.cut import cut
from tests.plugins.recordings import real_take, runs_in
from tests.studies import needs_recordings

PATTERNS = ["random", "contiguous", "region", "end", "occlusion"]

pytestmark = needs_recordings


def test_the_shoulder_has_the_gaps_that_it_is_known_for() -> None:
    actual = runs_in(~real_take("vicon/shoulder").present)
    lengths = [length for *_, length in actual]
    assert (len(actual), min(lengths), max(lengths)) == (34, 1, 71)
    assert len({marker for marker, *_ in actual}) == 13
    assert (~real_take("vicon/shoulder").present).sum(axis=1).max() == 3


@pytest.mark.parametrize("name", ["animface/jaw", "animface/cheeks"])
@pytest.mark.parametrize("seed", range(5))
def test_the_shoulders_gaps_on_a_face(name: str, seed: int) -> None:
    origin, face = real_take("vicon/shoulder"), real_take(name)
    theirs = runs_in(~origin.present)
    hidden = cut(face, origin, seed=seed).hidden.hidden
    mine = runs_in(hidden)
    # 100 Hz to 60 Hz: six tenths of the frames, one at least
    wanted = sorted(max(round(0.6 * length), 1) for *_, length in theirs)
    assert sorted(length for *_, length in mine) == wanted
    per_marker = [
        sorted(np.unique([marker for marker, *_ in actual], return_counts=True)[1].tolist())
        for actual in (theirs, mine)
    ]
    assert per_marker[0] == per_marker[1]
    assert hidden.sum(axis=1).max() == 3
    first = min(start for _, start, _ in theirs)
    begin = min(start for _, start, _ in mine)
    late = sorted(round(0.6 * (start - first)) for _, start, _ in theirs)
    shifts = np.array(sorted(start - begin for _, start, _ in mine)) - late
    # where rounding would make two gaps of a marker touch, the later one waits
    assert shifts.min() == 0
    assert shifts.max() <= 2
    seconds = np.count_nonzero(~origin.present) / origin.rate
    assert hidden.sum() / face.rate == pytest.approx(seconds, rel=0.02)


@given(
    name=st.sampled_from(["animface/jaw", "animface/cheeks"]),
    length=st.sampled_from([1, 5, 10, 20, 50, 100, 200]),
    simultaneous=st.sampled_from([1, 3, 5, 10, 20]),
    pattern=st.sampled_from(PATTERNS),
    seed=st.integers(0, 2**31),
)
def test_a_study_of_gaps_gets_them_or_hears_how_many_there_can_be(
    name: str, length: int, simultaneous: int, pattern: object, seed: int
) -> None:
    face = real_take(name)
    ask: Any = {"length": length, "simultaneous": simultaneous, "pattern": pattern, "seed": seed}
    count = 20
    try:
        hidden = cut(face, count=count, **ask).hidden.hidden
    except ValueError as error:
        count = int(re.findall(r"(\d+) fit into", str(error))[0])
        assert 0 < count < 20
        hidden = cut(face, count=count, **ask).hidden.hidden
    actual = runs_in(hidden)
    assert [frames for *_, frames in actual] == [length] * (count * simultaneous)
    for _, start, frames in actual:
        assert start > 0
        assert (start + frames == face.frames) == (pattern == "end")


@pytest.mark.parametrize(
    ("length", "simultaneous", "pattern", "most"),
    [
        (200, 20, "random", 14),
        (200, 20, "region", 14),
        (200, 20, "contiguous", 7),
        (1, 3, "end", 13),
        (200, 20, "end", 2),
    ],
)
def test_how_many_fit_is_all_that_there_is_room_for(
    length: int, simultaneous: int, pattern: Any, most: int
) -> None:
    """41 markers of 1499 frames; no two groups of 20 nearest markers are disjoint there."""
    with pytest.raises(ValueError, match=f"20 gaps of {length} frames .* requested, {most} fit"):
        cut(real_take("animface/cheeks"), length=length, simultaneous=simultaneous, pattern=pattern)
