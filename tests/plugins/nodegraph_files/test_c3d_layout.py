from __future__ import annotations

import struct
from contextlib import AbstractContextManager, nullcontext

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_files import read_c3d
from nodegraph_files.c3d_header import read_description
from tests.plugins.nodegraph_files.conftest import Build

Samples = NDArray[np.float64]
QUIET: AbstractContextManager[object] = nullcontext()


def test_a_description_tells_what_was_written(build_c3d: Build, samples: Samples) -> None:
    description = read_description(build_c3d(samples, rate=50.0, analog=3, scale=0.25))
    layout = description.layout
    assert (layout.frames, layout.points, layout.values, layout.width) == (20, 3, 3, 2)
    assert (layout.start, description.rate, description.scales) == (21 * 512, 50.0, (0.25,))
    assert layout.frame_bytes == (4 * 3 + 3) * 2
    assert layout.end == layout.start + 20 * layout.frame_bytes


WRONG: dict[str, dict[str, object]] = {
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
    build_c3d: Build, samples: Samples, wrong: dict[str, object]
) -> None:
    with pytest.warns(UserWarning, match="disagree; by its size it holds 20 frames x .3 points"):
        read = read_c3d(build_c3d(samples, **wrong))
    np.testing.assert_array_equal(read.positions, samples[..., :3])


@pytest.mark.parametrize("wrong", WRONG.values(), ids=WRONG)
def test_a_dispute_that_the_size_does_not_settle_is_refused(
    build_c3d: Build, samples: Samples, wrong: dict[str, object]
) -> None:
    path = build_c3d(samples, **wrong)
    path.write_bytes(path.read_bytes() + bytes(100_000))
    with pytest.raises(ValueError, match=r"disagree .*do not show which is right"):
        read_c3d(path)


@pytest.mark.parametrize("lacking", ["USED", "SCALE", "RATE", "DATA_START", "FRAMES"])
def test_the_header_stands_in_for_a_parameter(
    build_c3d: Build, samples: Samples, lacking: str
) -> None:
    path = build_c3d(samples, **{lacking: None})
    with pytest.warns(UserWarning, match="no rate, its header 60") if lacking == "RATE" else QUIET:
        read = read_c3d(path)
    np.testing.assert_array_equal(read.positions, samples[..., :3])
    assert read.rate == 60.0


def test_of_two_rates_the_parameters_count(build_c3d: Build, samples: Samples) -> None:
    path = build_c3d(samples, header={20: struct.pack("<f", 60.0)}, RATE=50.0)
    with pytest.warns(UserWarning, match="a rate of 50, its header 60; the parameters count"):
        assert read_description(path).rate == 50.0
    with pytest.warns(UserWarning, match=r"a rate of -50, its header 0\.001; the header counts"):
        assert read_description(build_c3d(samples, rate=0.001, RATE=-50.0)).rate == 0.001
    # what the header does not say is not a disagreement
    assert read_description(build_c3d(samples, header={20: bytes(4)}, RATE=50.0)).rate == 50.0


@pytest.mark.parametrize(
    ("stated", "header", "taken"),
    [(0.02, 0.05, 0.05), (0.05, 0.02, 0.05), (0.001, 0.002, 0.001), (0.05, 0.06, 0.05)],
)
def test_of_two_scales_the_one_that_makes_a_body_counts(
    build_c3d: Build, stated: float, header: float, taken: float
) -> None:
    body = np.zeros((5, 4, 4))
    body[..., :3] = [[1, 1, 1], [9000, 8000, 1], [3000, 30_000, 1], [5, 100, 3000]]
    path = build_c3d(body, scale=stated, header={12: struct.pack("<f", header)})
    with pytest.warns(UserWarning, match=f"scale of {stated}, its header {header}; {taken} is"):
        read = read_c3d(path)
    np.testing.assert_allclose(read.positions, body[..., :3] * taken, rtol=1e-6)


def test_the_header_alone_may_give_the_scale(build_c3d: Build, samples: Samples) -> None:
    path = build_c3d(samples, scale=0.25, SCALE=0.0)
    with pytest.warns(UserWarning, match=r"no scale, its header 0\.25; the header counts"):
        assert read_description(path).scales == (0.25,)


def test_two_scales_of_samples_that_need_none_are_reported(
    build_c3d: Build, samples: Samples
) -> None:
    with pytest.warns(UserWarning, match=r"a scale of -0\.5, its header -1; the samples need"):
        read = read_c3d(build_c3d(samples, SCALE=-0.5))
    np.testing.assert_array_equal(read.positions, samples[..., :3])


def test_a_big_endian_file_whose_last_entry_points_beyond_the_section(
    build_c3d: Build, samples: Samples
) -> None:
    path = build_c3d(samples, processor=86)
    content = path.read_bytes()
    name = b"GEN_SCALE"
    step = content.index(name) + len(name)
    path.write_bytes(content[:step] + struct.pack(">H", 16_129) + content[step + 2 :])
    np.testing.assert_array_equal(read_c3d(path).positions, samples[..., :3])


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
