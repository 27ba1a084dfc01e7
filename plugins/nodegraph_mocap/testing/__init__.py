"""Strategies for hypothesis: recordings and what else travels, ordinary and odd, to test nodes on.

>>> from hypothesis import given
>>> from nodegraph_mocap.testing import recordings
>>> @given(recordings())
... def test_it(recording): ...

They need hypothesis (``pip install hypothesis``), which is imported when one of them is called. An
example shrinks to few frames, few markers at rest, no gaps, nothing filled.
"""

from __future__ import annotations

from nodegraph_mocap.testing.faces import head_motions, marker_sets, models, weights
from nodegraph_mocap.testing.takes import cuts, detections, masks, recordings

__all__ = [
    "cuts",
    "detections",
    "head_motions",
    "marker_sets",
    "masks",
    "models",
    "recordings",
    "weights",
]
