"""Markers are kept by selection or by name, in the order asked for, their samples untouched."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_markers.keep import keep
from nodegraph_mocap import Selection
from nodegraph_mocap.specimens import recordings

FACE = recordings()["filled, repaired and with sigma"]
NAMES = ["nose", "lip_left", "brow_right"]


def test_named_markers_come_in_the_order_named_with_everything_of_theirs() -> None:
    kept = keep(FACE, names=NAMES)
    columns = [FACE.markers.index(name) for name in NAMES]
    assert kept.markers == tuple(NAMES)
    assert np.array_equal(kept.positions, FACE.positions[:, columns], equal_nan=True)
    assert np.array_equal(kept.origin, FACE.origin[:, columns])
    assert FACE.sigma is not None
    assert kept.sigma is not None
    assert np.array_equal(kept.sigma, FACE.sigma[:, columns], equal_nan=True)


def test_a_selection_keeps_what_it_has_chosen_in_its_order() -> None:
    kept = keep(FACE, Selection(chosen=("lip_right", "nose", "lip_left")))
    assert kept.markers == ("lip_right", "nose", "lip_left")
    assert kept.marker_set is not None
    assert kept.marker_set.pairs == (("lip_left", "lip_right"),)
    assert kept.marker_set.midline == ("nose",)


@pytest.mark.parametrize(
    ("selection", "names", "what"),
    [
        (None, None, "got neither"),
        (Selection(chosen=("nose",)), ["nose"], "got both"),
        (None, [], "no marker is chosen"),
        (Selection(chosen=()), None, "no marker is chosen"),
        (None, ["nose", "nose"], "duplicate markers nose"),
        (None, ["Nose_"], r"'Nose_' \(did you mean 'nose'\?\); it has brow_left"),
        (None, ["nose", "xyz"], "no marker 'xyz'; it has brow_left, brow_right"),
    ],
)
def test_what_cannot_be_kept_is_said(
    selection: Selection | None, names: list[str] | None, what: str
) -> None:
    with pytest.raises(ValueError, match=what):
        keep(FACE, selection, names=names)
