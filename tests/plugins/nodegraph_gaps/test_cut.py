"""Gaps lie where they may, as many as requested, the same for the same seed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal, get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from nodegraph.node.decorator import node_of
from nodegraph_gaps.cut import Cut, cut
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.recordings import make_recording, runs_in

Pattern = Literal["random", "contiguous", "region", "end", "occlusion"]
PATTERNS: tuple[Pattern, ...] = get_args(Pattern)


def recording(frames: int = 200, markers: int = 12, *, missing: float = 0.0) -> Trajectories:
    random = np.random.default_rng(7)
    positions = random.normal(size=(1, markers, 3)) * [60, 80, 20] + random.normal(
        size=(frames, markers, 3)
    )
    positions[random.random((frames, markers)) < missing] = np.nan
    return make_recording(positions)


@pytest.mark.parametrize("pattern", PATTERNS)
@pytest.mark.parametrize("simultaneous", [1, 3])
@pytest.mark.parametrize("missing", [0.0, 0.02])
def test_gaps_are_as_asked(pattern: Pattern, simultaneous: int, missing: float) -> None:
    source = recording(missing=missing)
    count = 3 if pattern == "end" else 8
    result = cut(
        source,
        length=6,
        count=count,
        simultaneous=simultaneous,
        pattern=pattern,
        seed=3,
    )
    actual = runs_in(result.hidden.hidden)
    assert [length for *_, length in actual] == [6] * (count * simultaneous)
    starts = [start for _, start, _ in actual]
    assert len(actual) == count * simultaneous
    for marker, start, length in actual:
        assert source.measured[start - 1 : start + length, marker].all()
        if pattern == "end":
            assert start + length == source.frames
        else:
            assert result.gappy.present[start + length, marker]
        assert result.gappy.present[start - 1, marker]
    assert len(set(starts)) <= count


def test_only_hidden_samples_differ() -> None:
    source = recording(missing=0.05)
    result = cut(source, length=5, count=10)
    hidden = result.hidden.hidden
    assert result.truth is source
    assert np.array_equal(
        result.gappy.positions[~hidden], source.positions[~hidden], equal_nan=True
    )
    assert np.isnan(result.gappy.positions[hidden]).all()
    assert (result.gappy.origin[hidden] == Origin.MISSING).all()
    assert np.array_equal(result.gappy.origin[~hidden], source.origin[~hidden])


def test_the_seed_decides_and_nothing_else() -> None:
    first, again, other = (cut(recording(), seed=seed, length=5) for seed in (1, 1, 2))
    assert np.array_equal(first.hidden.hidden, again.hidden.hidden)
    assert not np.array_equal(first.hidden.hidden, other.hidden.hidden)


def test_every_place_can_be_drawn() -> None:
    source = recording(frames=6, markers=2)
    seen = {
        runs_in(cut(source, length=2, count=1, seed=seed).hidden.hidden)[0] for seed in range(200)
    }
    assert seen == {(marker, start, 2) for marker in range(2) for start in (1, 2, 3)}


def test_as_many_gaps_as_there_is_room_for() -> None:
    # one marker, 21 frames: gaps of 4 need a sample between them, so four fit
    source = recording(frames=21, markers=1)
    for seed in range(20):
        result = cut(source, length=4, count=4, seed=seed)
        assert len(runs_in(result.hidden.hidden)) == 4


@pytest.mark.parametrize(
    ("length", "count", "fitting"), [(4, 5, 4), (19, 2, 1), (20, 1, 0), (50, 3, 0)]
)
def test_too_many_gaps_say_how_many_fit(length: int, count: int, fitting: int) -> None:
    with pytest.raises(
        ValueError, match=rf"{count} gaps of {length} frames requested, {fitting} fit"
    ):
        cut(recording(frames=21, markers=1), length=length, count=count)


@pytest.mark.parametrize("pattern", PATTERNS)
@pytest.mark.parametrize(("simultaneous", "length"), [(1, 6), (3, 9), (3, 25), (4, 3)])
def test_a_graph_is_refused_only_for_gaps_that_no_seed_can_cut(
    pattern: Pattern, simultaneous: int, length: int
) -> None:
    source = recording(frames=24, markers=3, missing=0.03)
    described = node_of(cut)
    assert described is not None
    requires = described.requires
    assert requires is not None
    for count in range(1, 13):
        settings: dict[str, object] = {
            "length": length, "count": count, "simultaneous": simultaneous, "pattern": pattern
        }  # fmt: skip
        early = message(requires, source, None, **settings)
        late = {message(cut, source, seed=seed, **settings) for seed in range(4)}
        assert late == {early} if early or simultaneous == 1 else late


def message(function: Callable[..., object], *inputs: object, **settings: object) -> str:
    try:
        function(*inputs, **settings)
    except ValueError as error:
        return str(error)
    return ""


def test_contiguous_gaps_hide_the_nearest_markers() -> None:
    source = recording()
    result = cut(source, length=5, count=6, simultaneous=3, pattern="contiguous")
    shape = np.median(source.positions, axis=0)
    for group in events(result):
        groups = [
            set(np.argsort(np.linalg.norm(shape - shape[member], axis=1))[:3]) for member in group
        ]
        assert group in groups


def test_a_region_lies_on_one_side_of_its_nearest_marker() -> None:
    source = recording(markers=20)
    result = cut(source, length=5, count=6, simultaneous=4, pattern="region")
    shape = source.positions[0]
    for group in events(result):
        members = shape[sorted(group)]
        # some member has all others within a half space, so no others surround it
        spans = [members - member for member in members]
        assert any(_fits_half_space(span[np.linalg.norm(span, axis=1) > 0]) for span in spans)


def _fits_half_space(directions: NDArray[np.float64]) -> bool:
    random = np.random.default_rng(0)
    sides = directions @ random.normal(size=(3, 5000))
    return bool((sides >= 0).all(axis=0).any())


@given(
    missing=arrays.arrays(np.float64, (30, 8), elements=st.floats(0, 1)),
    pattern=st.sampled_from(PATTERNS),
    simultaneous=st.integers(1, 3),
    seed=st.integers(0, 2**40),
)
def test_only_seed_gaps_and_reference_shape_decide(
    missing: NDArray[np.float64], pattern: Pattern, simultaneous: int, seed: int
) -> None:
    """The first complete frame gives the shape; what the others hold does not count.

    Where no marker has a name that says where occlusions are, they go by movement.
    """
    source = recording(frames=30, markers=8)
    source = replace(source, markers=(*source.markers[:-1], "mouth"))
    positions = np.where((missing > 0.95)[..., None], np.nan, source.positions)
    positions[0] = source.positions[0]
    displaced = 5.0 - 3.0 * positions
    displaced[0] = positions[0]
    first, second = (
        replace(source, positions=held, origin=Trajectories.origin)
        for held in (positions, displaced)
    )
    masks: list[str | bytes] = []
    for take in (first, second):
        try:
            result = cut(
                take, length=2, count=2, simultaneous=simultaneous, pattern=pattern, seed=seed
            )
        except ValueError as error:
            masks.append(str(error))
        else:
            masks.append(result.hidden.hidden.tobytes())
    assert masks[0] == masks[1]


def events(result: Cut) -> list[set[int]]:
    """Return the markers of each event; events of one start frame would be one."""
    actual: dict[int, set[int]] = {}
    for marker, start, _ in runs_in(result.hidden.hidden):
        actual.setdefault(start, set()).add(marker)
    return list(actual.values())


def test_what_cannot_be_done_is_said() -> None:
    with pytest.raises(
        ValueError, match="5 markers at once requested, 0 fit into 200 frames of 3 markers"
    ):
        cut(recording(markers=3), simultaneous=5)
    empty = Trajectories(positions=np.zeros((0, 1, 3)), markers=("a",), rate=60.0)
    with pytest.raises(ValueError, match="0 fit into 0 frames"):
        cut(empty)
    lost = Trajectories(positions=np.full((30, 2, 3), np.nan), markers=("a", "b"), rate=60.0)
    for pattern in PATTERNS:
        with pytest.raises(ValueError, match="0 fit"):
            cut(lost, length=2, count=1, simultaneous=2, pattern=pattern)
