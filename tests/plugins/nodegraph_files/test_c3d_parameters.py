from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_files.c3d_header import TEXT, Parameter, Processor, read_parameters
from tests.plugins.nodegraph_files.conftest import Build

INTEL = Processor(84)


def test_dec_numbers_are_what_the_vax_manual_calls_them() -> None:
    # VAX F_floating: 1.0 is the words 4080 0000 (hexadecimal), each with its low byte first.
    assert Processor(85).floats(bytes([0x80, 0x40, 0, 0, 0x80, 0xC0, 0, 0])).tolist() == [1.0, -1.0]


def test_a_processor_nobody_knows_is_refused() -> None:
    with pytest.raises(ValueError, match="unknown kind 83"):
        Processor(83)


@pytest.mark.parametrize("code", [84, 85, 86])
def test_entries_are_found_by_group_and_name(
    build_c3d: Build, samples: NDArray[np.float64], code: int
) -> None:
    content = build_c3d(samples, ["left", "b"], processor=code, trial=(1, 70_000)).read_bytes()
    parameters = read_parameters(content, 512)
    assert parameters["POINT", "LABELS"].texts == ("left", "b")
    assert parameters["POINT", "LABELS"].numbers == ()
    assert parameters["POINT", "USED"].numbers == (3.0,)
    assert parameters["POINT", "SCALE"].numbers == (-1.0,)
    assert parameters["POINT", "UNITS"].texts == ("mm",)
    assert parameters["TRIAL", "ACTUAL_END_FIELD"].numbers == (70_000 % 65_536, 1)
    assert parameters["POINT", "USED"].texts == ()


@pytest.mark.parametrize(
    ("shape", "data", "texts"),
    [
        ((), b"a", ("a",)),
        ((3,), b"abc", ("abc",)),
        ((2, 2), b"a b ", ("a", "b")),
        ((0, 5), b"", ()),
        ((2, 1, 2), b"a\0b ", ("a", "b")),
    ],
)
def test_texts_of_every_shape(shape: tuple[int, ...], data: bytes, texts: tuple[str, ...]) -> None:
    assert Parameter(TEXT, shape, data, INTEL).texts == texts


def section(*entries: bytes) -> bytes:
    return bytes([1, 0x50, 1, 84]) + b"".join(entries)


GROUP = b"\1\xffG\3\0\0"


def test_an_entry_without_a_step_is_the_last() -> None:
    content = section(GROUP, b"\1\1A\0\0\2\0\7\0\0", b"rubbish")
    assert read_parameters(content, 0)["G", "A"].numbers == (7.0,)


def test_a_locked_entry_has_a_negative_length() -> None:
    content = section(GROUP, b"\xff\1A\7\0\2\0\7\0\0", b"\0\0")
    assert read_parameters(content, 0)["G", "A"].numbers == (7.0,)


def test_an_entry_of_an_unnamed_group_is_left_out() -> None:
    assert read_parameters(section(b"\1\2A\7\0\2\0\7\0\0", b"\0\0"), 0) == {}


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (b"\1\0A\7\0\2\0\7\0\0\0\0", "damaged at byte 10"),
        (b"\1\1A\xff\xff\2\0\7\0\0\0\0", "damaged at byte 10"),
        (b"\1\1A\1\0\2\0\7\0\0\0\0", "damaged at byte 10"),
        (b"\x7f\1A", "damaged at byte 10"),
        (b"\1\1A\7\0\3\0\7\0\0\0\0", "parameter at byte 10 is damaged"),
        (b"\1\1A\7\0\2\1\xff\7\0\0\0", "parameter at byte 10 is damaged"),
        (b"\1\1A\7\0\2\xc8\7\0\0\0\0", "parameter at byte 10 is damaged"),
        (b"\1\1A\7\0\2\0\7\0\0", "no end"),
    ],
)
def test_damage_is_reported_with_its_place(entry: bytes, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        read_parameters(section(GROUP, entry), 0)
