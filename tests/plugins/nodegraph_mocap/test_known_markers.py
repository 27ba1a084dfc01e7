"""Names that are not there are told, with the nearest."""

from __future__ import annotations

import pytest

from nodegraph_mocap import check_markers
from nodegraph_mocap.specimens import recordings

FACE = recordings()["complete"]


def test_names_that_are_there_pass_in_any_order() -> None:
    check_markers(FACE, reversed(FACE.markers))
    check_markers(FACE, [])


def test_each_unknown_name_is_told_with_the_nearest_whatever_its_case() -> None:
    near = FACE.markers[0]
    told = rf"the neutral has no marker '{near.upper()}' \(did you mean '{near}'\?\); 'q'; it has "
    with pytest.raises(ValueError, match=told):
        check_markers(FACE, [near.upper(), "q"], what="the neutral")


def test_names_that_stand_twice_are_told_once() -> None:
    one, two, three, *_ = FACE.markers
    with pytest.raises(ValueError, match=f"the recording: asked twice for {one}, {three}$"):
        check_markers(FACE, [one, two, three, three, one, one])
