from __future__ import annotations

import struct

import pytest

from nodegraph_files.c3d import c3d_head
from nodegraph_files.c3d_header import BLOCK, Parameters, read_parameters


def parameters_of(head: bytes) -> Parameters:
    return read_parameters(head, BLOCK)


@pytest.mark.parametrize("frames", [1, 65_534, 65_535, 2**24])
def test_header_and_parameters_tell_the_same(frames: int) -> None:
    head = c3d_head(["a", "b"], frames, 59.94)
    parameters = parameters_of(head)
    section, key, points, analog, first, last = struct.unpack("<BBHHHH", head[:10])
    scale, start, per_frame, rate = struct.unpack("<fHHf", head[12:24])
    assert (section, key, analog, first, per_frame) == (2, 0x50, 0, 1, 0)
    assert head[BLOCK + 2] == start - 2 == len(head) // BLOCK - 1
    assert len(head) % BLOCK == 0
    assert parameters["POINT", "USED"].numbers == (points,) == (2,)
    assert parameters["POINT", "DATA_START"].numbers == (start,)
    assert parameters["POINT", "SCALE"].numbers == (scale,) == (-1,)
    assert parameters["POINT", "RATE"].numbers == (rate,) == (pytest.approx(59.94),)
    assert parameters["POINT", "FRAMES"].numbers == (last,) == (min(frames, 65_535),)
    assert parameters["POINT", "UNITS"].texts == ("mm",)


@pytest.mark.parametrize("frames", [65_535, 65_536, 100_000, 2**24])
def test_a_count_beyond_sixteen_bits_is_reported_in_two_ways(frames: int) -> None:
    parameters = parameters_of(c3d_head(["a"], frames, 60))
    assert parameters["POINT", "LONG_FRAMES"].numbers == (frames,)
    assert parameters["TRIAL", "ACTUAL_START_FIELD"].numbers == (1, 0)
    assert parameters["TRIAL", "ACTUAL_END_FIELD"].numbers == (frames % 65_536, frames // 65_536)


def test_a_short_take_says_nothing_of_a_trial() -> None:
    parameters = parameters_of(c3d_head(["a"], 65_534, 60))
    assert not {("POINT", "LONG_FRAMES"), ("TRIAL", "ACTUAL_END_FIELD")} & set(parameters)


def test_names_are_split_where_an_entry_is_full() -> None:
    names = [f"é{number}" for number in range(600)]
    parameters = parameters_of(c3d_head(names, 1, 60))
    lists = [parameters["POINT", name].texts for name in ("LABELS", "LABELS2", "LABELS3")]
    assert [len(names) for names in lists] == [255, 255, 90]
    assert [name for names in lists for name in names] == names
    assert len(parameters["POINT", "DESCRIPTIONS3"].texts) == 90


def test_names_fill_255_blocks_and_no_more() -> None:
    def head(count: int) -> bytes:
        return c3d_head([f"{number:0100}" for number in range(count)], 1, 60)

    assert head(1288)[BLOCK + 2] == 255
    assert parameters_of(head(1288))["POINT", "USED"].numbers == (1288,)
    with pytest.raises(ValueError, match="C3D cannot hold the names of 1289 markers"):
        head(1289)
