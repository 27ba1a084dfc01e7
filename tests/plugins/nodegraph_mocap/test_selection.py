"""A selection holds what it says, and nothing that contradicts itself."""

from __future__ import annotations

from nodegraph_mocap import Selection
from nodegraph_mocap.specimens import recordings, selections


def test_markers_alone_are_enough() -> None:
    result = Selection(chosen=("a",))
    assert (result.pairs, result.frequencies, result.history) == ((), None, None)


def test_specimens_choose_markers_of_the_recordings_of_their_names() -> None:
    for name, value in selections().items():
        assert set(value.chosen) <= set(recordings()[name].markers)
