"""Where two arrays differ, from a few numbers of each."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph.lock.array_parts import Parts, Span, part_difference, parts_of

Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]
VALUES = np.random.default_rng(0).normal(size=(40, 6, 3))
SHEET = np.random.default_rng(0).normal(size=(20, 3))
AXES = (("row", ()), ("column", ("left", "middle", "right")))


def parts(values: Array, most: int = 64) -> Parts:
    result = parts_of("positions", values, 2, most)
    assert result is not None
    return result


def changed(*places: tuple[int, int], by: float = 1.0) -> Parts:
    other = VALUES.copy()
    for place in places:
        other[place] += by
    return parts(other)


@pytest.mark.parametrize("by", [0.01, 1.0, -1e3])
def test_a_sample_that_differs_is_located(by: float) -> None:
    for frame, column in np.ndindex(40, 6):
        frames, columns = parts(VALUES).differing(changed((frame, column), by=by), 1e-9)
        assert frames == [Span(frame, frame, True)]
        assert columns == [Span(column, column, True)]


def test_neighbours_are_merged_and_the_largest_difference_is_marked() -> None:
    other = VALUES.copy()
    other[3:7, 2] += 0.001
    other[20:25, 4] += 1.0
    frames, columns = parts(VALUES).differing(parts(other), 1e-9)
    assert {at for span in frames for at in range(span.first, span.last + 1)} == {
        *range(3, 7),
        *range(20, 25),
    }
    assert not any(span.most for span in frames if span.last < 20)
    assert any(span.most for span in frames)
    assert [(span.first, span.most) for span in columns] == [(2, False), (4, True)]


def test_nothing_differs_from_itself() -> None:
    assert parts(VALUES).differing(parts(VALUES.copy()), 1e-12) == ([], [])


def test_rounding_is_no_difference() -> None:
    assert parts(VALUES).differing(parts(VALUES * (1.0 + 1e-13)), 1e-9) == ([], [])


def test_a_sample_that_is_missing_differs() -> None:
    other = VALUES.copy()
    other[7, 5] = np.nan
    assert parts(VALUES).differing(parts(other), 1e-9)[0] == [Span(7, 7, True)]


def test_long_axes_have_parts_of_several_members() -> None:
    frames, columns = parts(VALUES, most=5).differing(parts(VALUES, most=5), 1e-9)
    assert (frames, columns) == ([], [])
    other = VALUES.copy()
    other[17, 5] += 1.0
    frames, columns = parts(VALUES, most=5).differing(parts(other, most=5), 1e-9)
    assert frames == [Span(16, 23, True)]
    assert [span for span in columns if span.first <= 5 <= span.last] == columns


@given(
    st.tuples(st.integers(0, 9), st.integers(0, 4), st.integers(1, 3)),
    st.integers(1, 7),
)
def test_the_text_of_parts_reads_back(shape: tuple[int, int, int], most: int) -> None:
    values = np.random.default_rng(1).normal(size=shape)
    written = parts(values, most)
    read = Parts.read(written.text)
    assert read.shape == shape
    for sums, other in zip(written.sums, read.sums, strict=True):
        assert np.allclose(sums, other, rtol=1e-6)
    assert not any(written.differing(read, 1e-6))


@pytest.mark.parametrize(
    "text", ["", "2x2", "2x2 2,2 AAAA", "2xa 1,1 AAAAAAAAAAA=", "2 1 ????????"]
)
def test_a_text_of_another_form_raises_an_error(text: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        Parts.read(text)


@pytest.mark.filterwarnings("error")
def test_numbers_too_large_for_four_bytes_have_no_parts() -> None:
    assert parts_of("a", np.full((2000, 2), 1.797e308), 2, 64) is None
    assert parts_of("a", np.full((2000, 2), 1e30), 2, 64) is not None


def test_axes_with_other_numbers_of_parts_are_not_compared() -> None:
    few = Parts(VALUES.shape, (np.ones(3), np.ones(6)))
    for spans in (few.differing(parts(VALUES), 1e-9), parts(VALUES).differing(few, 1e-9)):
        assert [bool(axis) for axis in spans] == [False, True]


def difference(was: Array, now: Array) -> str:
    return part_difference(parts(was), parts(now), AXES, 1e-9)


def changed_rows(rows: slice, column: int, by: float = 1.0) -> Array:
    other = SHEET.copy()
    other[rows, column] += by
    return other


@pytest.mark.parametrize(
    ("rows", "column", "place"),
    [
        (slice(4, 5), 0, "row 4, of column left"),
        (slice(4, 7), 2, "rows 4 to 6, of column right"),
        (slice(2, 19, 4), 1, "rows 2, 6, 10, 14, 18, of column middle"),
        (slice(0, 18, 3), 1, "6 rows between 0 and 15, of column middle"),
        (slice(None), 1, "all 20 rows, of column middle"),
    ],
)
def test_members_that_differ_are_named(rows: slice, column: int, place: str) -> None:
    text = re.sub(r" \(most in .*\)", "", difference(SHEET, changed_rows(rows, column)))
    assert text.endswith(f" in {place}")


def test_members_that_differ_most_are_named() -> None:
    other = changed_rows(slice(3, 6), 0, 0.001)
    other[9, 0] += 1.0
    assert "rows 3 to 5, 9 (most in row 9), of column left" in difference(SHEET, other)


@pytest.mark.parametrize(
    ("large", "place"), [((5, slice(None)), "row 2"), ((slice(None), 2), "column left")]
)
def test_a_difference_may_be_within_the_rounding_of_one_axis(
    large: tuple[slice | int, slice | int], place: str
) -> None:
    was = SHEET.copy()
    was[large] = 1e9
    now = was.copy()
    now[2, 0] += 0.01
    assert difference(was, now).endswith(f" in {place}")


def test_equal_arrays_have_no_difference() -> None:
    assert difference(SHEET, SHEET * (1.0 + 1e-13)) == ""


def test_shapes_that_differ_are_reported() -> None:
    assert difference(SHEET, SHEET[:7]).endswith("20 x 3, now 7 x 3")
    assert difference(SHEET[:0], SHEET).endswith("0 x 3, now 20 x 3")
