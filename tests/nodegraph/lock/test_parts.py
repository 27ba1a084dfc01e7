"""Where two arrays differ is told from a few numbers of either."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph.lock.sketch import Parts, Span, parts_of

VALUES = np.random.default_rng(0).normal(size=(40, 6, 3))


def taken(values: np.ndarray[tuple[int, ...], np.dtype[np.float64]], most: int = 64) -> Parts:
    found = parts_of("positions", values, 2, most)
    assert found is not None
    return found


def changed(*places: tuple[int, int], by: float = 1.0) -> Parts:
    other = VALUES.copy()
    for place in places:
        other[place] += by
    return taken(other)


@pytest.mark.parametrize("by", [0.01, 1.0, -1e3])
def test_one_sample_is_found_where_it_is(by: float) -> None:
    for frame, column in np.ndindex(40, 6):
        frames, columns = taken(VALUES).apart(changed((frame, column), by=by), 1e-9)
        assert frames == [Span(frame, frame, True)]
        assert columns == [Span(column, column, True)]


def test_neighbours_are_told_together_and_the_largest_apart() -> None:
    other = VALUES.copy()
    other[3:7, 2] += 0.001
    other[20:25, 4] += 1.0
    frames, columns = taken(VALUES).apart(taken(other), 1e-9)
    assert {at for one in frames for at in range(one.first, one.last + 1)} == {
        *range(3, 7),
        *range(20, 25),
    }
    assert not any(one.most for one in frames if one.last < 20)
    assert any(one.most for one in frames)
    assert [(one.first, one.most) for one in columns] == [(2, False), (4, True)]


def test_nothing_differs_from_itself() -> None:
    assert taken(VALUES).apart(taken(VALUES.copy()), 1e-12) == ([], [])


def test_rounding_is_no_difference() -> None:
    assert taken(VALUES).apart(taken(VALUES * (1.0 + 1e-13)), 1e-9) == ([], [])


def test_a_sample_that_is_missing_differs() -> None:
    other = VALUES.copy()
    other[7, 5] = np.nan
    assert taken(VALUES).apart(taken(other), 1e-9)[0] == [Span(7, 7, True)]


def test_long_axes_are_told_in_parts() -> None:
    frames, columns = taken(VALUES, most=5).apart(taken(VALUES, most=5), 1e-9)
    assert (frames, columns) == ([], [])
    other = VALUES.copy()
    other[17, 5] += 1.0
    frames, columns = taken(VALUES, most=5).apart(taken(other, most=5), 1e-9)
    assert frames == [Span(16, 23, True)]
    assert [one for one in columns if one.first <= 5 <= one.last] == columns


@given(
    st.tuples(st.integers(0, 9), st.integers(0, 4), st.integers(1, 3)),
    st.integers(1, 7),
)
def test_parts_and_their_text_say_the_same(shape: tuple[int, int, int], most: int) -> None:
    values = np.random.default_rng(1).normal(size=shape)
    parts = taken(values, most)
    read = Parts.read(parts.text)
    assert read.shape == shape
    for one, other in zip(parts.sums, read.sums, strict=True):
        assert np.allclose(one, other, rtol=1e-6)
    assert not any(parts.apart(read, 1e-6))


@pytest.mark.parametrize(
    "text", ["", "2x2", "2x2 2,2 AAAA", "2xa 1,1 AAAAAAAAAAA=", "2 1 ????????"]
)
def test_a_text_that_says_nothing_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        Parts.read(text)


@pytest.mark.filterwarnings("error")
def test_numbers_that_four_bytes_do_not_hold_have_no_parts() -> None:
    assert parts_of("a", np.full((2000, 2), 1.797e308), 2, 64) is None
    assert parts_of("a", np.full((2000, 2), 1e30), 2, 64) is not None


def test_as_many_parts_as_there_should_be_are_compared() -> None:
    few = Parts(VALUES.shape, (np.ones(3), np.ones(6)))
    assert few.apart(taken(VALUES), 1e-9)[0] == taken(VALUES).apart(few, 1e-9)[0]
