"""Each purpose and each seed has random numbers of its own, the same every time."""

from __future__ import annotations

from nodegraph_mocap.random_numbers import Seed, random_for


def test_purposes_and_seeds_have_streams_of_their_own() -> None:
    streams = [("noise", 0), ("noise", 1), ("impulses", 0), ("impulses", 1)]
    drawn = [random_for(purpose, seed).random() for purpose, seed in streams]
    assert len(set(drawn)) == len(drawn)
    assert drawn == [random_for(purpose, seed).random() for purpose, seed in streams]


def test_a_seed_of_several_parts_depends_on_each() -> None:
    seeds: list[Seed] = [3, (3,), (3, "a"), (3, "b"), (4, "a"), (3, 0)]
    drawn = [random_for("noise", seed).random() for seed in seeds]
    assert drawn[0] == drawn[1]
    for absolute in ("/home/me/a.c3d", r"C:\me\a.c3d"):
        assert random_for("", (absolute,)).random() == random_for("", ("a.c3d",)).random()
    assert random_for("", ("me/a.c3d",)).random() != random_for("", ("a.c3d",)).random()
    assert len(set(drawn[1:])) == len(drawn) - 1
