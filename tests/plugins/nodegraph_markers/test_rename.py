"""Names change, in the marker set too; nothing else does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph_markers.rename import rename
from nodegraph_mocap import MarkerSet
from nodegraph_mocap.specimens import recordings

FACE = recordings()["gaps"]


def test_recording_and_every_part_of_the_marker_set_are_renamed() -> None:
    result = rename(FACE, names={"brow_left": "LBRO", "forehead": "FHD", "temple_left": "LTMP"})
    assert result.markers[0] == "LBRO"
    assert result.marker_set is not None
    assert result.marker_set.markers == result.markers
    assert result.marker_set.pairs[0] == ("LBRO", "brow_right")
    assert result.marker_set.midline == ("nose", "FHD")
    assert result.marker_set.stable == ("LTMP", "temple_right", "nose", "FHD")
    assert result.marker_set.edges[:2] == (("LBRO", "FHD"), ("FHD", "brow_right"))
    assert result.positions is FACE.positions
    assert np.array_equal(result.origin, FACE.origin)


def test_markers_swap_their_names() -> None:
    result = rename(FACE, names={"nose": "forehead", "forehead": "nose"})
    swapped = result.keep(["forehead", "nose"]).positions
    assert np.array_equal(swapped, FACE.keep(["nose", "forehead"]).positions, equal_nan=True)


@pytest.mark.parametrize(
    ("names", "what"),
    [
        ({"noze": "a"}, r"'noze' \(did you mean 'nose'\?\)"),
        ({"nose": "forehead"}, "'nose' and 'forehead' would both be called 'forehead'"),
        ({"nose": "a", "forehead": "a"}, "'nose' and 'forehead' would both be called 'a'"),
        ({"nose": " "}, "the new name of nose is empty"),
    ],
)
def test_names_that_cannot_be_given(names: dict[str, str], what: str) -> None:
    with pytest.raises(ValueError, match=what):
        rename(FACE, names=names)


def test_a_clash_within_a_larger_marker_set_is_reported() -> None:
    larger = MarkerSet(markers=(*FACE.markers, "chin"))
    with pytest.raises(ValueError, match="marker set: 'nose' and 'chin'"):
        rename(replace(FACE, marker_set=larger), names={"nose": "chin"})
