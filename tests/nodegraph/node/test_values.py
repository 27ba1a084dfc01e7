from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import Files, Value, read_only


@dataclass(frozen=True, eq=False)
class Take(Value):
    positions: NDArray[np.float64]
    markers: tuple[str, ...]


def test_a_value_is_printed_by_the_shapes_of_its_arrays() -> None:
    take = Take(np.zeros((600, 60, 3)), tuple("abcdefghij"))
    assert repr(take) == (
        "Take(positions=float64 array of 600 x 60 x 3, markers=('a', 'b', 'c', ...))"
    )


def test_an_array_of_its_own_is_locked_without_a_copy() -> None:
    array = np.arange(3.0)
    locked = read_only(array)
    assert locked is array
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 9


def test_a_view_into_open_memory_is_copied() -> None:
    array = np.arange(6.0)
    locked = read_only(array[::2])
    array[:] = -1
    assert locked.tolist() == [0, 2, 4]
    assert not locked.flags.writeable


def test_a_locked_view_into_open_memory_is_copied_too() -> None:
    array = np.arange(6.0)
    view = array[:3]
    view.flags.writeable = False
    locked = read_only(view)
    array[:] = -1
    assert locked.tolist() == [0, 1, 2]


def test_a_view_into_locked_memory_is_passed_on() -> None:
    view = read_only(np.arange(6.0))[1:4]
    assert read_only(view) is view


@pytest.mark.parametrize("part", [np.s_[:, :2], np.s_[::-1], np.s_[:, None], np.s_[::2, ::-1]])
def test_a_view_with_gaps_is_copied_as_a_stored_result_has_none(part: Any) -> None:
    view = read_only(np.arange(12.0).reshape(4, 3))[part]
    copied = read_only(view)
    assert (copied is view) == (part == np.s_[:, None])
    assert copied.tolist() == view.tolist()
    assert copied.base is None or copied is view


def test_a_copy_keeps_the_order_in_memory_in_which_sums_run() -> None:
    table = np.asfortranarray(np.random.default_rng(0).normal(size=(40, 18)))
    locked = read_only(table[:, :9])
    assert locked is not table
    assert locked.flags.f_contiguous
    assert locked.sum(axis=1).sum() == table[:, :9].sum(axis=1).sum()


def test_a_view_into_memory_that_nobody_can_write_to_is_passed_on() -> None:
    for memory in (bytes(16), memoryview(bytearray(16)).toreadonly()):
        array = np.frombuffer(memory)
        assert read_only(array) is array
    open_memory = np.frombuffer(bytearray(16))
    assert read_only(open_memory) is not open_memory


@pytest.mark.parametrize(
    "name", ["", ".", "/a.c3d", "../a", "a/../../b", "a//b", "a/", "c:a", "a\\b", "a\nb"]
)
def test_files_stay_in_their_folder(name: str) -> None:
    with pytest.raises(ValueError, match="is not a file name"):
        Files({name: b""})


def test_files_are_bytes() -> None:
    assert Files({"one.c3d": b"1", "more/two.csv": b"2"}).content["more/two.csv"] == b"2"
    with pytest.raises(ValueError, match=r"file 'a.csv': must be bytes, got str"):
        Files({"a.csv": "text"})  # type: ignore[dict-item]
