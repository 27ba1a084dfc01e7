from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_files import read_c3d
from nodegraph_files.c3d_header import read_description

Build = Callable[..., Path]
Samples = NDArray[np.float64]


def test_a_description_tells_what_was_written(build_c3d: Build, samples: Samples) -> None:
    found = read_description(build_c3d(samples, rate=50.0, analog=3, scale=0.25))
    layout = found.layout
    assert (layout.frames, layout.points, layout.values, layout.width) == (20, 3, 3, 2)
    assert (layout.start, found.rate, found.scale) == (21 * 512, 50.0, 0.25)
    assert layout.frame_bytes == (4 * 3 + 3) * 2
    assert layout.end == layout.start + 20 * layout.frame_bytes


WRONG: dict[str, dict[str, Any]] = {
    "frames in the header": {"header": {8: struct.pack("<H", 7)}},
    "frames in the parameters": {"FRAMES": 7},
    "more frames in the parameters": {"FRAMES": 300},
    "points in the header": {"header": {2: struct.pack("<H", 5)}},
    "points in the parameters": {"USED": 2},
    "analog values in the header": {"header": {4: struct.pack("<H", 9)}},
    "start in the header": {"header": {16: struct.pack("<H", 6)}},
    "start in the parameters": {"DATA_START": 9},
    "kind of numbers in the header": {"header": {12: struct.pack("<f", 1.0)}},
    "kind of numbers in the parameters": {"SCALE": 1.0},
    "frames of the trial": {"trial": (1, 7)},
}


@pytest.mark.parametrize("wrong", WRONG.values(), ids=WRONG)
def test_the_size_settles_what_header_and_parameters_dispute(
    build_c3d: Build, samples: Samples, wrong: dict[str, Any]
) -> None:
    with pytest.warns(UserWarning, match="disagree; by its size it holds 20 frames x .3 points"):
        read = read_c3d(build_c3d(samples, **wrong))
    np.testing.assert_array_equal(read.positions, samples[..., :3])


@pytest.mark.parametrize("wrong", WRONG.values(), ids=WRONG)
def test_a_dispute_that_the_size_does_not_settle_is_refused(
    build_c3d: Build, samples: Samples, wrong: dict[str, Any]
) -> None:
    path = build_c3d(samples, **wrong)
    path.write_bytes(path.read_bytes() + bytes(100_000))
    with pytest.raises(ValueError, match=r"disagree .*do not show which is right"):
        read_c3d(path)


@pytest.mark.parametrize("lacking", ["USED", "SCALE", "RATE", "DATA_START", "FRAMES"])
def test_the_header_stands_in_for_a_parameter(
    build_c3d: Build, samples: Samples, lacking: str
) -> None:
    read = read_c3d(build_c3d(samples, **{lacking: None}))
    np.testing.assert_array_equal(read.positions, samples[..., :3])
    assert read.rate == 60.0


@pytest.mark.parametrize(
    ("place", "changed", "told"),
    [
        (20, {"RATE": 50.0}, "a rate of 50, its header 60; the parameters count"),
        (12, {"SCALE": 0.5}, "a scale of 0.5, its header 0.25; the parameters count"),
    ],
)
def test_of_rate_and_scale_the_parameters_count(
    build_c3d: Build, samples: Samples, place: int, changed: dict[str, float], told: str
) -> None:
    header = {20: struct.pack("<f", 60.0), 12: struct.pack("<f", 0.25)}
    path = build_c3d(samples, scale=0.25, header=header, **changed)
    with pytest.warns(UserWarning, match=told):
        found = read_description(path)
    assert (found.rate, found.scale) == (changed.get("RATE", 60.0), changed.get("SCALE", 0.25))
    # what the header does not say is no disagreement
    path = build_c3d(samples, scale=0.25, header={place: bytes(4)}, **changed)
    assert read_description(path) == found


@pytest.mark.parametrize("bits", [0, 0x7F80_0000, 0x7FC0_0000], ids=["zero", "infinite", "NaN"])
def test_integers_without_a_scale_are_refused(
    build_c3d: Build, samples: Samples, bits: int
) -> None:
    header = {12: struct.pack("<I", bits)}
    with pytest.raises(ValueError, match="its samples are integers, and their scale is"):
        read_description(build_c3d(samples, scale=0.0, header=header))


@pytest.mark.parametrize("wrong", [{"USED": -1.0}, {"FRAMES": -20.0}])
def test_fewer_than_none_is_no_count(
    build_c3d: Build, samples: Samples, wrong: dict[str, float]
) -> None:
    assert read_c3d(build_c3d(samples, **wrong)).positions.shape == (20, 3, 3)


def test_a_take_cut_from_a_longer_one_starts_late(build_c3d: Build, samples: Samples) -> None:
    path = build_c3d(samples, header={6: struct.pack("<HH", 101, 120)}, trial=(101, 120))
    assert read_c3d(path).frames == 20


def test_padding_to_whole_blocks_is_no_data(build_c3d: Build, samples: Samples) -> None:
    path = build_c3d(samples)
    content = path.read_bytes()
    path.write_bytes(content + bytes(-len(content) % 512))
    assert read_c3d(path).frames == 20


@pytest.mark.parametrize("section", [0, 1, 200])
def test_a_section_that_lies_elsewhere_is_refused(
    build_c3d: Build, samples: Samples, section: int
) -> None:
    with pytest.raises(ValueError, match="not where it says"):
        read_c3d(build_c3d(samples, header={0: bytes([section])}))
