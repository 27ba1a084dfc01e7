"""Arrays come back of the same type, in the same order in memory, and nobody can write to them."""

from __future__ import annotations

import json
import subprocess
import sys
from itertools import permutations
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from nodegraph import read_only
from nodegraph.store import Packer, Unreadable, Unstorable

PACKER = Packer()
KINDS = ["?", "b", "u1", "<i2", ">i4", "q", "l", "<f2", ">f4", "f8", "c8", ">c16", "<M8[D]",
         ">M8[ns]", "m8[s]", "<U3", ">U2", "S4", "M8"]  # fmt: skip


def there_and_back(array: object) -> Any:
    packed = PACKER.pack(array)
    return PACKER.unpack(packed.head, packed.buffers)


def assert_same(back: Any, array: Any) -> None:
    assert type(back) is type(array)
    assert back.dtype == array.dtype
    assert back.dtype.char == array.dtype.char
    assert back.dtype.byteorder == array.dtype.byteorder
    assert back.shape == array.shape
    assert back.tobytes() == array.tobytes()


@given(st.data())
def test_every_kind_shape_and_layout(data: st.DataObject) -> None:
    shape = data.draw(arrays.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=4))
    kind = np.dtype(data.draw(st.sampled_from(KINDS)))
    seed = data.draw(st.integers(0, 2**32))
    count = int(np.prod(shape))
    raw = np.random.default_rng(seed).integers(0, 120, count * kind.itemsize, np.uint8)
    if kind.kind == "U":
        array = np.array([chr(65 + value) for value in raw[:count]], kind).reshape(shape)
    else:
        array = raw.view(kind).reshape(shape)
    array = array.transpose(data.draw(st.permutations(range(len(shape)))))
    steps = tuple(slice(None, None, data.draw(st.sampled_from([1, -1, 2]))) for _ in shape)
    array = array[steps] if shape else array
    back = there_and_back(array)
    assert_same(back, array)
    assert not back.flags.writeable
    if array.size > 1:
        dense = array.copy(order="K")
        long = [axis for axis, length in enumerate(array.shape) if length > 1]
        assert [back.strides[axis] for axis in long] == [dense.strides[axis] for axis in long]


@pytest.mark.parametrize("order", list(permutations(range(3))))
def test_a_sum_has_the_same_last_bit(order: tuple[int, ...]) -> None:
    array = np.random.default_rng(7).normal(size=(37, 41, 43)).transpose(order)
    array = read_only(array)
    for view in (array, array[:, 3:], array[::-1], np.broadcast_to(array[0], array.shape)):
        value = read_only(view)  # as every node returns it
        back = there_and_back(value)
        assert back.sum() == value.sum()
        assert (back.sum(axis=0) == value.sum(axis=0)).all()


def test_bits_that_no_number_shows_are_kept() -> None:
    bits = np.array([0x7FF0000000000001, 0xFFF8000000000002, 1 << 63, 1], np.uint64)
    assert there_and_back(bits.view("f8")).view("u8").tolist() == bits.tolist()


@pytest.mark.parametrize("order", ["C", "F", "moved"])
def test_no_array_in_one_piece_is_copied(order: str) -> None:
    array = np.zeros((20, 30, 40))
    array = np.asfortranarray(array) if order == "F" else array
    array = array.transpose(1, 2, 0) if order == "moved" else array
    packed = PACKER.pack(array)
    assert np.shares_memory(np.frombuffer(packed.buffers[0]), array)
    memory = np.frombuffer(bytes(packed.buffers[0]), np.uint8)
    assert np.shares_memory(PACKER.unpack(packed.head, [memory]), memory)


def test_a_value_can_pass_on_an_array_from_locked_memory() -> None:
    packed = PACKER.pack(np.arange(6.0).reshape(2, 3).T)
    memory = np.frombuffer(bytes(packed.buffers[0]), np.uint8).copy()
    memory.flags.writeable = False
    back = PACKER.unpack(packed.head, [memory])
    assert read_only(back) is back


def test_an_array_at_an_odd_address_is_moved() -> None:
    packed = PACKER.pack(np.arange(3.0))
    shifted = memoryview(b"x" + bytes(packed.buffers[0]))[1:]
    back = PACKER.unpack(packed.head, [shifted])
    assert back.flags.aligned
    assert back.tolist() == [0, 1, 2]


def test_nobody_can_write_to_an_array_in_memory_that_is_open() -> None:
    packed = PACKER.pack(np.arange(3.0))
    back = PACKER.unpack(packed.head, [bytearray(packed.buffers[0])])
    with pytest.raises(ValueError, match="read-only"):
        back[0] = 1


@pytest.mark.parametrize(
    "array",
    [
        np.array([None]),
        np.zeros(2, [("a", "f8")]),
        np.zeros(2, np.longdouble),
        np.zeros(2, np.clongdouble),
        np.longdouble(1),
        np.zeros(2, "V4"),
        np.ma.masked_array([1.0]),
        np.zeros(3).view(np.recarray),
    ],
    ids=lambda array: f"{type(array).__name__} of {array.dtype}",
)
def test_arrays_that_could_come_back_otherwise_are_refused(array: object) -> None:
    with pytest.raises(Unstorable):
        PACKER.pack(array)


@pytest.mark.parametrize(
    "number",
    [np.float32(0.1), np.float64("nan"), np.int8(-3), np.uint64(2**64 - 1), np.bool_(True),
     np.complex64(1 + 2j), np.datetime64("2020-01-01", "ns"), np.timedelta64("NaT", "s"),
     np.longlong(3), np.str_("a\0"), np.bytes_(b"a\0")],
    ids=lambda number: type(number).__name__,
)  # fmt: skip
def test_numbers_of_numpy_stay_what_they_are(number: object) -> None:
    back = there_and_back(number)
    assert type(back) is type(number)
    assert np.asarray(back).tobytes() == np.asarray(number).tobytes()
    assert back == number or number != number


def test_too_few_or_too_many_bytes_are_noticed() -> None:
    head = PACKER.pack(np.arange(3.0)).head
    for length in (0, 23, 25, 32):
        with pytest.raises(Unreadable, match="24 bytes"):
            PACKER.unpack(head, [bytes(length)])


@pytest.mark.parametrize(
    "parts",
    [
        ["|O", [3]],
        ["|V8", [3]],
        ["<f8,<f8", [3]],
        ["(3,)<f8", [1]],
        ["float64", [3]],
        [None, [3]],
        ["<f8", [2]],
        ["<f8", [3, 2**64]],
        ["<f8", [-1, -3]],
        ["<f8", [True, 3]],
        ["<f8", [3.0]],
        ["<f8", [3] + [1] * 64],
        ["<f8", {}],
        ["<f8", [3], [1]],
        ["<f8", [3], ["0"]],
        ["<f8", [3], [0], []],
        ["<f8", [3], [0], [2**40]],
        ["<f8", [3], [0], [-(2**40)]],
        ["<f8", [3], [0], [8.0]],
        ["<f8", [3], None, [16]],
        ["<f8", [3], [0], [8], 0],
        ["<U6", [1]],
        ["<f8"],
        [],
    ],
    ids=str,
)
def test_what_describes_no_array_of_these_bytes_is_unreadable(parts: list[object]) -> None:
    with pytest.raises(Unreadable):
        PACKER.unpack(json.dumps(["array", 0, *parts]), [b"\xff" * 24])


@pytest.mark.parametrize("shape", [[2**40, 0], [0, 2**20, 2**20]], ids=str)
def test_no_array_without_numbers_is_as_long_as_one_likes(shape: list[int]) -> None:
    with pytest.raises(Unreadable, match="shape"):
        PACKER.unpack(json.dumps(["array", 0, "<f8", shape]), [b""])
    with pytest.raises(Unstorable, match="too long"):
        PACKER.pack(np.empty(shape))
    assert there_and_back(np.empty((10**6, 0, 3))).shape == (10**6, 0, 3)


def test_bytes_that_have_several_places_are_copied_once() -> None:
    same = memoryview(bytes(5000))
    back = PACKER.unpack('["tuple",["bytes",0],["bytes",1]]', [same, same])
    assert back[0] is back[1]


def test_numpy_is_not_imported_for_plain_values() -> None:
    program = (
        "import sys; from nodegraph.store import Packer; p = Packer()"
        "; k = p.pack([1.5, {'a': b''}]); p.unpack(k.head, k.buffers); p.travels(float)"
        "; sys.exit('numpy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
