"""Impulses are single, of one size, where they are said to be, and nested."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from nodegraph_mocap import Trajectories
from nodegraph_synthesize.face import synthesize_face
from nodegraph_synthesize.impulses import add


def recording(present: NDArray[np.bool_]) -> Trajectories:
    positions = np.random.default_rng(3).normal(0, 60, (*present.shape, 3))
    positions[~present] = np.nan
    names = tuple(f"m{index}" for index in range(present.shape[1]))
    return Trajectories(positions=positions, markers=names, rate=60.0)


def whole(frames: int = 600, markers: int = 12) -> Trajectories:
    return recording(np.ones((frames, markers), dtype=np.bool_))


def gappy(frames: int = 600, markers: int = 12) -> Trajectories:
    return recording(np.random.default_rng(1).random((frames, markers)) > 0.05)


@pytest.mark.parametrize("share", [0.0, 0.005, 0.05, 0.2])
@pytest.mark.parametrize("make", [whole, gappy])
def test_as_many_as_asked_and_exactly_where_they_are_said_to_be(
    share: float, make: Callable[[], Trajectories]
) -> None:
    take = make()
    result = add(take, share=share, size=7.0)
    assert result.truth is take
    hit = result.impulses.hidden
    assert np.count_nonzero(hit) == round(share * np.count_nonzero(take.present))
    off = np.linalg.norm(result.spiky.positions - take.positions, axis=2)
    np.testing.assert_allclose(off[hit], 7.0, rtol=1e-12)
    same = np.where(take.present, result.spiky.positions[..., 0] == take.positions[..., 0], True)
    np.testing.assert_array_equal(same | hit, np.ones_like(hit))
    np.testing.assert_array_equal(off[take.present & ~hit], 0.0)
    np.testing.assert_array_equal(result.spiky.origin, take.origin)


@given(
    present=arrays.arrays(np.bool_, st.tuples(st.integers(1, 25), st.integers(1, 5))),
    share=st.floats(0.0, 0.2),
    seed=st.integers(0, 99),
)
@pytest.mark.filterwarnings("ignore:no impulse")
def test_each_has_an_untouched_sample_on_each_side_or_the_error_counts(
    present: NDArray[np.bool_], share: float, seed: int
) -> None:
    take = recording(present)
    try:
        hit = add(take, share=share, seed=seed).impulses.hidden
    except ValueError as error:
        requested, _, fitting = map(
            int, re.findall(r"\b(\d+) (?:impulses|present|fit)", str(error))
        )
        assert fitting < requested == round(share * np.count_nonzero(present))
        return
    for frame, marker in np.argwhere(hit):
        assert 0 < frame < take.frames - 1
        for beside in (frame - 1, frame + 1):
            assert present[beside, marker]
            assert not hit[beside, marker]
    assert np.count_nonzero(hit) == round(share * np.count_nonzero(present))


@given(
    shares=st.tuples(st.floats(0.0, 0.2), st.floats(0.0, 0.2)).map(sorted),
    sizes=st.tuples(st.floats(0.1, 50.0), st.floats(0.1, 50.0)),
    seed=st.integers(0, 10**6),
)
@pytest.mark.filterwarnings("ignore:no impulse")
def test_a_larger_share_contains_a_smaller_ones_hits_in_the_same_directions(
    shares: list[float], sizes: tuple[float, float], seed: int
) -> None:
    take = gappy(80, 6)
    fewer, more = (
        add(take, share=share, size=size, seed=seed)
        for share, size in zip(shares, sizes, strict=True)
    )
    both = fewer.impulses.hidden
    assert not np.any(both & ~more.impulses.hidden)
    first, other = (
        (result.spiky.positions - take.positions)[both] / size
        for result, size in zip((fewer, more), sizes, strict=True)
    )
    np.testing.assert_allclose(first, other, rtol=0, atol=1e-10)


def test_directions_favour_none() -> None:
    take = whole(3000)
    result = add(take, share=0.2, size=1.0)
    directions = (result.spiky.positions - take.positions)[result.impulses.hidden]
    np.testing.assert_allclose(directions.mean(axis=0), 0.0, rtol=0, atol=0.03)
    np.testing.assert_allclose(
        directions.T @ directions / len(directions), np.eye(3) / 3, atol=0.02
    )


def test_places_do_not_depend_on_positions() -> None:
    take = gappy()
    moved = replace(take, positions=2.0 * take.positions + 1.0)
    first, other = add(take).impulses, add(moved).impulses
    np.testing.assert_array_equal(first.hidden, other.hidden)
    assert not np.array_equal(first.hidden, add(take, seed=1).impulses.hidden)


def test_the_same_seed_hits_a_made_face_elsewhere_than_its_own_impulses() -> None:
    face = synthesize_face(seconds=5, missing=0.0)
    again = add(face.captured).impulses.hidden
    assert np.count_nonzero(again & face.impulses.hidden) < 0.1 * np.count_nonzero(again)


def test_what_does_not_fit_is_counted() -> None:
    with pytest.raises(
        ValueError, match=r"4 impulses requested \(0.2 of 20 present.*, 0 fit with seed"
    ):
        add(whole(2, 10), share=0.2)
    # one sample in two is present: no sample has one on each side
    comb = np.zeros((40, 3), dtype=np.bool_)
    comb[::2] = True
    with pytest.raises(ValueError, match=r"3 impulses requested .* 0 fit with seed 0"):
        add(recording(comb), share=0.05)


def test_too_small_a_share_to_hit_anything_is_reported() -> None:
    with pytest.warns(UserWarning, match=r"no impulse: 0.005 of 60 present samples is none"):
        result = add(whole(6, 10))
    assert not result.impulses.hidden.any()
