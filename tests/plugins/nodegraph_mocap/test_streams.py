"""Each purpose and each seed has random numbers of its own, the same every time."""

from __future__ import annotations

from nodegraph_mocap.streams import random_for


def test_purposes_and_seeds_have_streams_of_their_own() -> None:
    streams = [("noise", 0), ("noise", 1), ("impulses", 0), ("impulses", 1)]
    drawn = [random_for(purpose, seed).random() for purpose, seed in streams]
    assert len(set(drawn)) == len(drawn)
    assert drawn == [random_for(purpose, seed).random() for purpose, seed in streams]
