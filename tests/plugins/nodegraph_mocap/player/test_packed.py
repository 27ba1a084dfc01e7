from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from nodegraph_mocap.player.data import MOST_STEPS, Blob
from tests.plugins.nodegraph_mocap.player.unpacked import Read

REACH = 1000.0
SHAPES = array_shapes(min_dims=2, max_dims=2, min_side=0, max_side=9)
NUMBERS = arrays(np.float64, SHAPES, elements=st.floats(-REACH, REACH) | st.just(np.nan))


@given(NUMBERS, st.sampled_from([0.01, 0.5, 1e-4]))
def test_numbers_come_back_to_half_a_step(values: np.ndarray, step: float) -> None:
    blob = Blob()
    packed, steps = blob.steps(values, step)
    read = Read(blob.packed({}))
    back = read.steps(packed)
    assert np.array_equal(back, steps)
    known = ~np.isnan(values)
    assert np.all(np.abs(back * step - values)[known] <= step / 2 * (1 + 1e-6))


@given(st.lists(st.sampled_from([MOST_STEPS, -MOST_STEPS, 0, 1]), min_size=1, max_size=12))
def test_the_farthest_numbers_come_back_beside_the_farthest_others(given: list[int]) -> None:
    values = np.array([given], dtype=np.float64)
    blob = Blob()
    first, like = blob.steps(-values, 1.0)
    second, _ = blob.steps(values, 1.0, like)
    read = Read(blob.packed({}))
    assert np.array_equal(read.steps(second, read.steps(first)), values)


def test_several_arrays_lie_where_the_head_says() -> None:
    blob = Blob()
    places = [blob.small(np.arange(count, dtype=np.uint8)) for count in (1, 2, 3, 5)]
    packed = blob.exact(np.array([0.5, np.pi]))
    read = Read(blob.packed({"label": "\u00e9</script>"}))
    for place, count in zip(places, (1, 2, 3, 5), strict=True):
        assert read.small(place, count).tolist() == list(range(count))
    assert read.exact(packed) == pytest.approx([0.5, np.pi], rel=1e-7)
    assert all(place % 4 == 0 for place in (*places, packed["at"]))
    assert read.head == {"label": "\u00e9</script>"}


def test_equal_things_make_equal_bytes() -> None:
    def packed() -> bytes:
        blob = Blob()
        blob.steps(np.linspace(0, 1, 50).reshape(5, 10), 0.01)
        return blob.packed({"one": 1})

    assert packed() == packed()
