from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_files import c3d_bytes, read_c3d, write_c3d
from nodegraph_mocap import Trajectories
from tests.plugins.nodegraph_files.conftest import Build

Samples = NDArray[np.float64]


def read_by_the_library(path: Path) -> tuple[Samples, list[str]]:
    import ezc3d

    file = ezc3d.c3d(str(path))
    labels: list[str] = file["parameters"]["POINT"]["LABELS"]["value"]
    return file["data"]["points"][:3].transpose(2, 1, 0), labels


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
    file = ezc3d.c3d(str(tmp_path / "gappy.c3d"))
    residuals = file["data"]["meta_points"]["residuals"][0].T
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


@pytest.mark.parametrize(
    ("value", "message"),
    [(np.nan, "2 samples lack a coordinate"), (np.inf, "2 samples are infinite")],
)
def test_broken_samples_are_missing_and_counted(
    build_c3d: Build, samples: Samples, value: float, message: str
) -> None:
    samples[3, 1, 0] = samples[4, 2, 2] = value
    with pytest.warns(UserWarning, match=message):
        read = read_c3d(build_c3d(samples))
    assert np.count_nonzero(~read.present) == 2


def test_a_nan_that_gives_an_alarm_is_counted_like_another(
    build_c3d: Build, samples: Samples
) -> None:
    path = build_c3d(samples)
    content = bytearray(path.read_bytes())
    start = len(content) - samples.size * 4
    content[start : start + 4] = struct.pack("<I", 0x7F80_0001)
    path.write_bytes(content)
    with pytest.warns(UserWarning, match="1 samples lack a coordinate") as caught:
        assert not read_c3d(path).present[0, 0]
    assert len(caught) == 1


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1), ("m", 1000), ("cm", 10), ("INCHES", 25.4)])
def test_units_become_millimetres(
    build_c3d: Build, samples: Samples, unit: str, factor: float
) -> None:
    read = read_c3d(build_c3d(samples, UNITS=unit))
    np.testing.assert_array_equal(read.positions, samples[..., :3] * factor)


@pytest.mark.parametrize(
    ("unit", "message"), [("furlong", "'furlong' is unknown"), (None, "no unit")]
)
def test_an_unknown_unit_is_reported_and_taken_as_millimetres(
    build_c3d: Build, samples: Samples, unit: str | None, message: str
) -> None:
    with pytest.warns(UserWarning, match=message):
        read = read_c3d(build_c3d(samples, UNITS=unit))
    np.testing.assert_array_equal(read.positions, samples[..., :3])


def test_labels_go_on_in_further_parameters(build_c3d: Build, samples: Samples) -> None:
    read = read_c3d(build_c3d(samples, ["x"], LABELS2=["y"], LABELS3=["z"]))
    assert read.markers == ("x", "y", "z")


LISTS: dict[str, dict[str, object]] = {
    "by name": {"ANGLES": ["y"], "FORCES": ["w"]},
    "continued": {"ANGLES": ["y"], "ANGLES2": ["w"]},
    "declared": {"TYPE_GROUPS": ["CURLS", "CURL"], "CURLS": ["w", "y"]},
    "of parts": {"LABELS": ["S:y", "S:x"], "LABELS2": ["S:w", "S:z"], "POWERS": ["S:w", "S:y"]},
}


@pytest.mark.parametrize("lists", LISTS.values(), ids=LISTS)
def test_results_of_a_model_are_left_out_and_counted(
    build_c3d: Build, lists: dict[str, object]
) -> None:
    samples = np.arange(80.0).reshape(5, 4, 4)
    path = build_c3d(samples, **{"LABELS": ["y", "x", "w", "z"], **lists})
    with pytest.warns(UserWarning, match="2 of 4 points are results of a model") as caught:
        read = read_c3d(path)
    assert len(caught) == 1
    assert read.markers == ("x", "z")
    np.testing.assert_array_equal(read.positions, samples[:, [1, 3], :3])


def test_a_file_of_nothing_but_results_is_refused(build_c3d: Build, samples: Samples) -> None:
    path = build_c3d(samples, ["x", "y", "z"], SCALARS=["x", "y"], MOMENTS=["z"])
    with pytest.raises(ValueError, match="3 points, none of them a marker: 2 SCALARS, 1 MOMENTS"):
        read_c3d(path)


@pytest.mark.parametrize(
    ("labels", "names", "message"),
    [
        (["a", "b", "a"], ("a", "b", "a_3"), "1 markers had no label, or another's: 'a' is now"),
        (["a", "", "b"], ("a", "unnamed_2", "b"), "1 markers had no label"),
        (["a"], ("a", "unnamed_2", "unnamed_3"), "2 markers had no label"),
        ([], ("unnamed_1", "unnamed_2", "unnamed_3"), "3 markers had no label"),
        (["a", "b", "c", "d"], ("a", "b", "c"), "1 labels beyond the 3 markers were left out: d"),
    ],
)
def test_labels_that_do_not_fit_the_points_are_reported(
    build_c3d: Build, samples: Samples, labels: list[str], names: tuple[str, ...], message: str
) -> None:
    with pytest.warns(UserWarning, match=message) as caught:
        assert read_c3d(build_c3d(samples, labels)).markers == names
    assert len(caught) == 1


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


def test_points_without_end_and_no_frames_are_refused_at_once(build_c3d: Build) -> None:
    path = build_c3d(np.zeros((0, 3, 4)), USED=1e30)
    with (
        pytest.warns(UserWarning, match="disagree"),
        pytest.raises(ValueError, match="it holds 0 frames of 10000000"),
    ):
        read_c3d(path)


def test_a_huge_announcement_takes_no_memory(
    build_c3d: Build, samples: Samples, peak_memory: Callable[[], int]
) -> None:
    huge = struct.pack("<HHHH", 0xFFFF, 0, 1, 0xFFFE)
    path = build_c3d(samples, USED=0xFFFF, FRAMES=0xFFFE, header={2: huge})
    with pytest.raises(ValueError, match=r"65534 frames.*65535 points.*cut short"):
        read_c3d(path)
    full = {8: b"\xff\xff"}
    path = build_c3d(samples, LONG_FRAMES=2.0**30, trial=(1, 2**30), FRAMES=0xFFFF, header=full)
    with pytest.warns(UserWarning, match=r"cut short: it announces 1073741824 frames"):
        assert read_c3d(path).frames == len(samples)
    assert peak_memory() < 2_000_000


def test_whole_frames_of_a_file_that_was_cut_short_are_read(
    build_c3d: Build, samples: Samples
) -> None:
    whole = read_c3d(build_c3d(samples))
    frame = samples[0].size * 4
    for cut in (1, frame, frame + 1):
        kept = len(samples) - -(-cut // frame)
        with pytest.warns(UserWarning, match=f"cut short: .* its first {kept} frames are read"):
            read = read_c3d(build_c3d(samples, cut=-cut))
        np.testing.assert_array_equal(read.positions, whole.positions[:kept])
    with pytest.raises(ValueError, match="it was cut short"):
        read_c3d(build_c3d(samples, cut=-frame * len(samples)))


def test_more_frames_than_sixteen_bits_count(build_c3d: Build) -> None:
    long = np.zeros((70_000, 1, 4))
    long[:, 0, 0] = np.arange(1, 70_001)
    for facts in ({"LONG_FRAMES": 70_000.0}, {"FRAMES": 70_000.0}, {"trial": (1, 70_000)}):
        read = read_c3d(build_c3d(long, **facts))
        assert read.frames == 70_000
        assert read.positions[-1, 0, 0] == 70_000
    with pytest.raises(ValueError, match="65535 frames, the most that its counter can hold"):
        read_c3d(build_c3d(long))


def test_many_and_long_names_survive_or_are_refused(tmp_path: Path) -> None:
    def named(count: int, width: int) -> Trajectories:
        names = tuple(f"{index:0{width}d}" for index in range(count))
        return Trajectories(positions=np.ones((1, count, 3)), markers=names, rate=60)

    for count, width in ((255, 8), (256, 8), (600, 20), (1288, 100), (2, 127)):
        write_c3d(named(count, width), tmp_path / "names.c3d")
        assert read_c3d(tmp_path / "names.c3d").markers == named(count, width).markers
    for count, width in ((1, 128), (1289, 100)):
        with pytest.raises(ValueError, match="C3D cannot"):
            c3d_bytes(named(count, width))
    with pytest.raises(ValueError, match="C3D cannot keep the marker name"):
        c3d_bytes(Trajectories(positions=np.ones((1, 1, 3)), markers=("\ud800",), rate=60))


def test_what_32_bits_cannot_hold_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    for value in (1e39, -1e39):
        positions = np.full((2, 1, 3), np.nan)
        positions[1] = value
        recording = Trajectories(positions=positions, markers=("m",), rate=60)
        with pytest.raises(ValueError, match="32-bit"):
            write_c3d(recording, tmp_path / "it.c3d")
        assert not (tmp_path / "it.c3d").exists()


def test_reading_prints_nothing(
    build_c3d: Build, samples: Samples, capfd: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(ValueError, match="samples start"):
        read_c3d(build_c3d(samples, DATA_START=0, header={16: b"\0\0"}))
    read_c3d(build_c3d(samples))
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"version https://git-lfs.github.com/spec/v1\n", "a pointer of Git LFS"),
        (b"<!DOCTYPE html><html>", "it is a web page"),
        (b"PK\3\4" + bytes(600), "it is a ZIP archive"),
        (b"Trajectories\n100\n", "it is text, and begins with 'Trajectories'"),
        (b"\2\x51\7\0" + bytes(600), "it begins with the bytes 02 51 07 00"),
        (b"\2\x50\7\0", "it ends before its header"),
    ],
)
def test_what_is_no_c3d_is_named(tmp_path: Path, content: bytes, message: str) -> None:
    (tmp_path / "take.c3d").write_bytes(content)
    with pytest.raises(ValueError, match=rf"take\.c3d: .*{message}"):
        read_c3d(tmp_path / "take.c3d")
