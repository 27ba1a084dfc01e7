"""A recording shows itself in a notebook."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np

from nodegraph_mocap import Origin, Trajectories


def shown(recording: Trajectories) -> ElementTree.Element:
    return ElementTree.fromstring(recording._repr_html_())


def test_counts_and_strips_say_where_samples_come_from() -> None:
    positions = np.zeros((10, 2, 3))
    positions[4:6, 1] = np.nan
    origin = np.ones((10, 2), np.uint8)
    origin[4:6, 1] = Origin.MISSING
    origin[7, 0] = Origin.FILLED
    take = Trajectories(positions=positions, markers=("a", "b"), rate=5.0, origin=origin)
    result = shown(take)
    text = " ".join("".join(result.itertext()).split())
    assert "10 frames, 2 markers, 5 Hz, 2 s" in text
    assert "17 samples (85.0 %) measured" in text
    assert "1 sample (5.0 %) filled" in text
    assert "no samples repaired" in text
    assert "2 samples (10.0 %) missing" in text
    measured, filled, _ = (path.get("d") or "" for path in result.iter("path"))
    runs = re.findall(r"M(\d+) (\d+)\.1h(\d+)", measured)
    assert runs == [("0", "0", "7"), ("8", "0", "2"), ("0", "1", "4"), ("6", "1", "4")]
    assert filled == "M7 0.1h1v.8h-1z"


def test_names_are_shown_and_never_run() -> None:
    name = "<script>alert(1)</script>&"
    take = Trajectories(positions=np.zeros((1, 1, 3)), markers=(name,), rate=1.0)
    assert [value.text for value in shown(take).iter("title")] == [name]
