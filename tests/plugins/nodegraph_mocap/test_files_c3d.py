from __future__ import annotations

import random
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from nodegraph_mocap import Trajectories, c3d_bytes, read_c3d, write_c3d

DATA = Path(__file__).parents[3] / ".." / "shared" / "data"
TAKES = {
    "animface/jaw": (1590, 41, 60.0, 0),
    "animface/cheeks": (1499, 41, 60.0, 0),
    "facecap/take001": (335, 60, 30.0, 0),
    "vicon/shoulder": (580, 51, 100.0, 305),
}
Build = Callable[..., Path]
Samples = NDArray[np.float64]


def read_by_the_library(path: Path) -> tuple[Samples, list[str]]:
    import ezc3d

    found = ezc3d.c3d(str(path))
    labels: list[str] = found["parameters"]["POINT"]["LABELS"]["value"]
    return found["data"]["points"][:3].transpose(2, 1, 0), labels


@pytest.mark.skipif(not DATA.is_dir(), reason="the recordings are not here")
@pytest.mark.parametrize("name", TAKES)
def test_a_real_take_reads_as_the_library_reads_it(name: str) -> None:
    path = DATA / f"{name}.c3d"
    frames, markers, rate, missing = TAKES[name]
    recording = read_c3d(path)
    positions, labels = read_by_the_library(path)
    np.testing.assert_array_equal(recording.positions, positions)
    assert list(recording.markers) == labels
    assert recording.positions.shape == (frames, markers, 3)
    assert recording.rate == rate
    assert np.count_nonzero(~recording.present) == missing


@pytest.mark.skipif(not DATA.is_dir(), reason="the recordings are not here")
@pytest.mark.parametrize("name", TAKES)
def test_a_real_take_survives_writing(name: str, tmp_path: Path) -> None:
    recording = read_c3d(DATA / f"{name}.c3d")
    write_c3d(recording, tmp_path / "again")
    again = read_c3d(tmp_path / "again")
    np.testing.assert_array_equal(again.positions, recording.positions)
    assert (again.markers, again.rate) == (recording.markers, recording.rate)


@pytest.mark.parametrize("processor", [84, 85, 86], ids=["Intel", "DEC", "MIPS"])
@pytest.mark.parametrize("scale", [-1.0, 0.125], ids=["floats", "integers"])
@pytest.mark.parametrize("analog", [0, 5])
def test_every_kind_of_number_is_read(
    build_c3d: Build, samples: Samples, processor: int, scale: float, analog: int
) -> None:
    samples[4, 1, 3] = -1
    stored = samples if scale < 0 else samples / np.array([scale, scale, scale, 1])
    path = build_c3d(stored, processor=processor, scale=scale, analog=analog)
    recording = read_c3d(path)
    expected = np.where(samples[..., 3:] < 0, np.nan, samples[..., :3])
    np.testing.assert_array_equal(recording.positions, expected)
    assert recording.rate == 60.0


@pytest.mark.parametrize("processor", [84, 85], ids=["Intel", "DEC"])
def test_integers_read_as_the_library_reads_them(
    build_c3d: Build, samples: Samples, processor: int
) -> None:
    samples[4, 1, 3] = -1
    path = build_c3d(np.round(samples), processor=processor, scale=0.1)
    expected, _ = read_by_the_library(path)
    np.testing.assert_allclose(read_c3d(path).positions, expected, rtol=1e-6)


def test_a_negative_residual_is_missing_and_a_missing_sample_gets_one(
    gappy: Trajectories, tmp_path: Path
) -> None:
    import ezc3d

    write_c3d(gappy, tmp_path / "gappy.c3d")
    found = ezc3d.c3d(str(tmp_path / "gappy.c3d"))
    residuals = found["data"]["meta_points"]["residuals"][0].T
    np.testing.assert_array_equal(residuals == -1, ~gappy.present)
    content = (tmp_path / "gappy.c3d").read_bytes()
    start = (struct.unpack("<H", content[16:18])[0] - 1) * 512
    raw = np.frombuffer(content, "<f4", count=6 * 3 * 4, offset=start).reshape(6, 3, 4)
    assert (raw[~gappy.present] == [0, 0, 0, -1]).all()


@pytest.mark.parametrize(
    ("residual", "missing"), [(-1, True), (-0.5, True), (0, False), (9, False)]
)
def test_a_residual_tells_whether_a_sample_is_missing(
    build_c3d: Build, samples: Samples, residual: float, missing: bool
) -> None:
    samples[7, 2, 3] = residual
    assert read_c3d(build_c3d(samples)).present[7, 2] != missing


def test_zeros_are_missing_unless_told_otherwise(build_c3d: Build, samples: Samples) -> None:
    samples[3, 1] = samples[5, 1] = 0
    path = build_c3d(samples)
    with pytest.warns(UserWarning, match=r"^2 samples are at exactly.*frame 3, marker number 2"):
        read = read_c3d(path)
    assert not read.present[[3, 5], 1].any()
    assert read_c3d(path, zeros_missing=False).present.all()


@pytest.mark.parametrize(
    ("value", "told"), [(np.nan, "2 samples lack a coordinate"), (np.inf, "2 samples are infinite")]
)
def test_broken_samples_are_missing_and_counted(
    build_c3d: Build, samples: Samples, value: float, told: str
) -> None:
    samples[3, 1, 0] = samples[4, 2, 2] = value
    with pytest.warns(UserWarning, match=told):
        read = read_c3d(build_c3d(samples))
    assert np.count_nonzero(~read.present) == 2


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1), ("m", 1000), ("cm", 10), ("INCHES", 25.4)])
def test_units_become_millimetres(
    build_c3d: Build, samples: Samples, unit: str, factor: float
) -> None:
    read = read_c3d(build_c3d(samples, UNITS=unit))
    np.testing.assert_array_equal(read.positions, samples[..., :3] * factor)


@pytest.mark.parametrize(("unit", "told"), [("furlong", "'furlong' is unknown"), (None, "no unit")])
def test_an_unknown_unit_is_told_and_taken_as_millimetres(
    build_c3d: Build, samples: Samples, unit: str | None, told: str
) -> None:
    with pytest.warns(UserWarning, match=told):
        read = read_c3d(build_c3d(samples, UNITS=unit))
    np.testing.assert_array_equal(read.positions, samples[..., :3])


def test_labels_go_on_in_further_parameters(build_c3d: Build, samples: Samples) -> None:
    read = read_c3d(build_c3d(samples, ["x"], LABELS2=["y"], LABELS3=["z"]))
    assert read.markers == ("x", "y", "z")


def test_labels_of_old_programs_are_latin(build_c3d: Build, samples: Samples) -> None:
    read = read_c3d(build_c3d(samples, ["né".encode("latin-1"), "ñ", "b"]))
    assert read.markers == ("né", "ñ", "b")


def test_a_rate_reads_as_it_was_meant(build_c3d: Build, samples: Samples) -> None:
    assert read_c3d(build_c3d(samples, rate=59.94)).rate == 59.94


@pytest.mark.parametrize("rate", [0.0, -60.0, float("inf"), float("nan")])
def test_a_rate_that_is_none_is_refused(build_c3d: Build, samples: Samples, rate: float) -> None:
    with pytest.raises(ValueError, match=r"built\.c3d.*rate"):
        read_c3d(build_c3d(samples, rate=rate))


@pytest.mark.parametrize("shape", [(0, 3, 4), (20, 0, 4)])
def test_a_file_without_samples_is_refused(build_c3d: Build, shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=r"built\.c3d.*it holds 0 frames|of 0 points"):
        read_c3d(build_c3d(np.zeros(shape)))


def test_a_huge_announcement_takes_no_memory(build_c3d: Build, samples: Samples) -> None:
    huge = struct.pack("<HHHH", 0xFFFF, 0, 1, 0xFFFE)
    path = build_c3d(samples, USED=0xFFFF, FRAMES=0xFFFE, header={2: huge})
    with pytest.raises(ValueError, match=r"65534 frames.*65535 points.*cut short"):
        read_c3d(path)


def test_more_frames_than_sixteen_bits_count(build_c3d: Build) -> None:
    long = np.zeros((70_000, 1, 4))
    long[:, 0, 0] = np.arange(1, 70_001)
    for told in ({"LONG_FRAMES": 70_000.0}, {"FRAMES": 70_000.0}, {"trial": (1, 70_000)}):
        read = read_c3d(build_c3d(long, **told))
        assert read.frames == 70_000
        assert read.positions[-1, 0, 0] == 70_000
    with pytest.raises(ValueError, match="65535 frames, the most that its counter can hold"):
        read_c3d(build_c3d(long))


@pytest.mark.parametrize("content", [b"", b"\2", b"\2\x50", b"hello, this is text", bytes(5000)])
def test_what_is_no_c3d_file_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "no.c3d"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"no\.c3d: not a readable C3D"):
        read_c3d(path)


def test_a_file_cut_short_anywhere_is_refused(build_c3d: Build, samples: Samples) -> None:
    whole = len(build_c3d(samples).read_bytes())
    for length in [*range(0, 1200, 7), *range(1200, whole, 331), whole - 1]:
        with pytest.raises(ValueError, match="not a readable C3D recording"):
            read_c3d(build_c3d(samples, cut=length))


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_damaged_bytes_give_a_recording_or_a_value_error(
    build_c3d: Build, samples: Samples
) -> None:
    path = build_c3d(samples)
    good = path.read_bytes()
    told = [place for place in range(1100) if good[place]]
    chance = random.Random(3)
    refused = []
    for _ in range(1500):
        content = bytearray(good)
        for _ in range(chance.choice([1, 3])):
            content[chance.choice(told)] = chance.choice([0, 1, 127, 128, 255])
        path.write_bytes(content)
        try:
            read_c3d(path)
        except ValueError as error:
            refused.append(str(error))
    assert 100 < len(refused) < 1400
    assert all("not a readable C3D recording" in message for message in refused)


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(tail=st.binary(max_size=3000), start=st.integers(0, 5))
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_random_bytes_are_refused(tmp_path: Path, tail: bytes, start: int) -> None:
    path = tmp_path / "random.c3d"
    path.write_bytes(bytes([start, 0x50]) + tail)
    with pytest.raises(ValueError, match="not a readable C3D recording"):
        read_c3d(path)


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_a_written_recording_reads_back(data: Any) -> None:
    import tempfile

    frames, markers = data.draw(st.tuples(st.integers(1, 5), st.integers(1, 4)))
    numbers = st.floats(-1e6, 1e6, width=32).filter(bool)
    positions = data.draw(arrays.arrays(np.float64, (frames, markers, 3), elements=numbers))
    positions[data.draw(arrays.arrays(np.bool_, (frames, markers)))] = np.nan
    recording = Trajectories(
        positions=positions,
        markers=tuple(f"m{index}" for index in range(markers)),
        rate=data.draw(st.sampled_from([24.0, 29.97, 59.94, 120.0, 1000.0])),
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "it.c3d"
        write_c3d(recording, path)
        again = read_c3d(path)
    np.testing.assert_array_equal(again.positions, recording.positions)
    assert (again.markers, again.rate) == (recording.markers, recording.rate)


def test_many_and_long_names_survive_or_are_refused(tmp_path: Path) -> None:
    def named(count: int, width: int) -> Trajectories:
        names = tuple(f"{index:0{width}d}" for index in range(count))
        return Trajectories(positions=np.ones((1, count, 3)), markers=names, rate=60)

    for count, width in ((255, 8), (256, 8), (600, 20), (2, 127)):
        write_c3d(named(count, width), tmp_path / "names.c3d")
        assert read_c3d(tmp_path / "names.c3d").markers == named(count, width).markers
    for count, width in ((1, 128), (2000, 100)):
        with pytest.raises(ValueError, match="C3D cannot"):
            c3d_bytes(named(count, width))


@pytest.mark.parametrize("name", ["", " ", " a", "a "])
def test_a_name_that_padding_would_change_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="cannot keep the marker name"):
        c3d_bytes(Trajectories(positions=np.ones((1, 1, 3)), markers=(name,), rate=60))


@pytest.mark.parametrize("shape", [(0, 1, 3), (1, 0, 3), (65_535, 1, 3)])
def test_what_the_format_cannot_count_is_refused(shape: tuple[int, int, int]) -> None:
    names = tuple("m" * shape[1])
    with pytest.raises(ValueError, match="C3D holds 1 to 65534 frames"):
        c3d_bytes(Trajectories(positions=np.ones(shape), markers=names, rate=60))


def test_what_32_bits_cannot_hold_is_refused() -> None:
    with pytest.raises(ValueError, match="32-bit"):
        c3d_bytes(Trajectories(positions=np.full((1, 1, 3), 1e39), markers=("m",), rate=60))


def test_the_same_recording_gives_the_same_bytes(gappy: Trajectories) -> None:
    assert c3d_bytes(gappy) == c3d_bytes(gappy)


def test_reading_prints_nothing(
    build_c3d: Build, samples: Samples, capfd: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(ValueError, match="cut short"):
        read_c3d(build_c3d(samples, cut=-100))
    read_c3d(build_c3d(samples))
    assert capfd.readouterr() == ("", "")
