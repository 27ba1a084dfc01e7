from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_compare.curve.marks import knee, local_minima, shared_minimum

VALUES = st.lists(st.integers(0, 4).map(float), max_size=9)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ([], []),
        ([1], []),
        ([2, 1], []),
        ([2, 1, 2], [1]),
        ([1, 2, 3], []),
        ([3, 1, 1, 2], [1]),
        ([3, 1, 1, 0], []),
        ([1, 1, 2], []),
        ([2, 1, 1], []),
        ([5, 1, 4, 0, 3], [1, 3]),
    ],
)
def test_a_local_minimum_is_lower_than_what_is_before_and_after(
    value: list[float], expected: list[int]
) -> None:
    assert local_minima(np.array(value, dtype=float)).tolist() == expected


@given(VALUES)
def test_walking_from_a_minimum_either_way_leads_up_first(value: list[float]) -> None:
    def climbs(steps: list[float], here: float) -> bool:
        return next((value > here for value in steps if value != here), False)

    expected = [
        place
        for place, here in enumerate(value)
        if climbs(value[place + 1 :], here)
        and climbs(value[:place][::-1], here)
        and value[place - 1] != here
    ]
    assert local_minima(np.array(value)).tolist() == expected


@pytest.mark.parametrize(
    ("minima", "tolerance", "expected"),
    [
        ([[35], [35], [35]], 0, 35),
        ([[33, 35], [36], [34, 50]], 2, 34),
        ([[33], [37]], 2, None),
        ([[33], [37], [35]], 2, 35),
        ([[35], []], 2, None),
        ([[20, 40], [41, 21]], 2, 20),
        ([[0.6], [0.8]], 0.2, 0.6),
        ([], 2, None),
    ],
)
def test_a_minimum_is_shared_if_every_curve_has_one_near_it(
    minima: list[list[float]], tolerance: float, expected: float | None
) -> None:
    arrays = [np.array(minimum, dtype=float) for minimum in minima]
    assert shared_minimum(arrays, tolerance) == expected


@given(st.lists(VALUES.filter(len), min_size=1, max_size=4), st.integers(0, 2))
def test_the_shared_minimum_is_the_smallest_of_all_that_fit(
    minima: list[list[float]], tolerance: int
) -> None:
    fitting = [
        x
        for x in itertools.chain(*minima)
        if all(any(abs(x - other) <= tolerance for other in minimum) for minimum in minima)
    ]
    shared = shared_minimum([np.array(value) for value in minima], tolerance)
    assert shared == min(fitting, default=None)


@given(
    st.lists(st.integers(0, 1000), min_size=3, max_size=9, unique=True),
    st.data(),
)
def test_the_knee_is_farthest_from_the_chord_among_the_points_below_it(
    places: list[int], data: st.DataObject
) -> None:
    x = np.sort(np.array(places, dtype=float))
    value = np.array(data.draw(st.lists(st.integers(0, 99), min_size=len(x), max_size=len(x))))
    first, last = np.array([x[0], value[0]]), np.array([x[-1], value[-1]])
    along = (last - first) / np.linalg.norm(last - first)
    away = np.stack([x, value], axis=1) - first
    beside = along[1] * away[:, 0] - along[0] * away[:, 1]  # positive below the chord
    place = knee(x, value.astype(float))
    if beside.max() <= 1e-9:
        assert place is None
    else:
        assert place is not None
        assert beside[place] == pytest.approx(beside.max())


def test_a_curve_that_bends_the_other_way_or_is_too_short_has_no_knee() -> None:
    assert knee(np.array([1.0, 2.0, 3.0]), np.array([3.0, 2.9, 1.0])) is None
    assert knee(np.array([1.0, 2.0]), np.array([3.0, 1.0])) is None
    assert knee(np.arange(5.0), np.array([4.0, 1.0, 0.5, 0.2, 0.0])) == 1
