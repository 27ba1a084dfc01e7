"""Markers lie where they are seen from the front, in the region that their names speak of."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_mocap import Trajectories
from nodegraph_mocap.face_layout import layout, regions
from nodegraph_mocap.view import frontal
from tests.plugins.nodegraph_plot import made_face


def test_markers_lie_at_their_median_as_seen_from_the_front() -> None:
    truth = made_face.truth()
    lying = layout({"estimate": made_face.filled(90.0), "truth": truth}, "marker")
    assert lying is not None
    expected = frontal(truth, "auto").project(np.median(truth.positions, axis=0))
    assert np.array(lying["points"]) == pytest.approx(expected, abs=0.006)
    assert lying["names"] == list(made_face.MARKERS)
    assert lying["edges"] == [[0, 2], [7, 8], [7, 2]]
    assert lying["regions"]["brow"] == [3, 4]


def test_markers_that_are_never_seen_lie_nowhere() -> None:
    whole = made_face.truth()
    positions = whole.positions.copy()
    positions[:, 0] = np.nan
    unseen = Trajectories(
        positions=positions, markers=whole.markers, rate=60.0, marker_set=whole.marker_set
    )
    seen = layout({"recording": unseen}, "marker")
    assert seen is not None
    assert seen["names"] == list(made_face.MARKERS[1:])
    assert [6, 7] in seen["edges"]
    assert layout({"recording": whole.keep(())}, "marker") is None
    assert layout({"recording": whole}, "trial") is None
    assert layout({"weights": 3}, "marker") is None


def test_the_first_region_in_a_name_counts() -> None:
    names = ("Leyebrow_M", "Reye_Up", "L_eyelid2", "NoseTop", "Mouth_Rend", "C7", "ForeHead_L")
    expected = {"forehead": [6], "brow": [0], "eyelid": [2], "eye": [1], "nose": [3], "mouth": [4]}
    assert regions(names) == expected
