from __future__ import annotations

import shutil
from codecs import BOM_UTF8
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph_files import (
    csv_bytes,
    marker_set_text,
    npz_bytes,
    sample_folder,
    trc_bytes,
    write_c3d,
    write_csv,
    write_npz,
    write_trc,
)
from nodegraph_files.readers import read_recording
from nodegraph_mocap import MarkerSet, Trajectories
from tests.studies import DATA, needs_recordings

SET = MarkerSet(markers=("é", "a"), pairs=(("a", "é"),))


@needs_recordings
@pytest.mark.parametrize(
    ("file", "message"),
    [
        ("livelink/actor_a_60fps.csv", "no columns NAME.X.*; read.weights reads weights"),
        ("facecap/model_60_markers.npz", "no array positions; there is"),
        ("facecap/markers.yaml", r"markers\.yaml: .*C3D.*NPZ.*TRC.*\.csv"),
    ],
)
def test_a_real_file_of_another_kind_is_refused(file: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        read_recording(path=DATA / file)


@pytest.mark.parametrize("write", [write_c3d, write_csv, write_npz, write_trc])
@pytest.mark.parametrize("name", ["it.csv", "it.tsv", "it.txt", "it.dat", "it"])
def test_the_content_tells_the_form_then_the_suffix(
    gappy: Trajectories, tmp_path: Path, write: Callable[..., None], name: str
) -> None:
    path = tmp_path / name
    write(gappy, path)
    if write is write_csv and path.suffix not in (".csv", ".tsv", ".txt"):
        with pytest.raises(ValueError, match=r"C3D.*NPZ.*TRC.*\.csv, \.tsv"):
            read_recording(path=path)
        return
    read = read_recording(path=path)
    np.testing.assert_allclose(read.positions, gappy.positions, rtol=1e-6)
    assert (read.markers, read.rate) == (gappy.markers, gappy.rate)


def test_a_table_whose_second_letter_is_that_of_c3d(tmp_path: Path) -> None:
    path = tmp_path / "it.csv"
    path.write_text("aP.x,aP.y,aP.z\n1,2,3\n# rate: 60\n# unit: mm\n")
    assert read_recording(path=path).markers == ("aP",)


@pytest.mark.parametrize("content", [b"x", b"no c3d at all", bytes(600)])
def test_a_bad_c3d_file_is_called_one(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "it.C3D"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"it\.C3D: not a readable C3D recording"):
        read_recording(path=path)


def test_a_bad_trc_file_is_called_one(tmp_path: Path) -> None:
    path = tmp_path / "it.TRC"
    path.write_text("frame,a.x,a.y,a.z")
    with pytest.raises(ValueError, match=r"it\.TRC: no TRC file"):
        read_recording(path=path)


def test_a_trc_file_may_begin_with_a_byte_order_mark(gappy: Trajectories, tmp_path: Path) -> None:
    path = tmp_path / "it.dat"
    path.write_bytes(BOM_UTF8 + trc_bytes(gappy))
    np.testing.assert_array_equal(read_recording(path=path).positions, gappy.positions)


@pytest.mark.parametrize("name", ["face", "actor_a", "actor_b", "actor_c"])
def test_a_sample_comes_with_its_marker_set(name: str) -> None:
    recording = read_recording(path=Path(f"sample:{name}"))
    assert recording.marker_set is not None
    assert recording.marker_set.markers == recording.markers
    assert recording.present.all() == (name != "face")


def test_a_folder_gives_its_recording_and_marker_set(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(sample_folder("actor_a"), folder)
    there = read_recording(path=folder)
    shipped = read_recording(path=Path("sample:actor_a"))
    np.testing.assert_array_equal(there.positions, shipped.positions)
    assert there.marker_set == shipped.marker_set
    (folder / "markers.yaml").unlink()
    assert read_recording(path=folder).marker_set is None


def test_the_set_of_a_sample_can_be_asked_for_by_the_samples_name(tmp_path: Path) -> None:
    path = sample_folder("actor_a") / "recording.c3d"
    given = read_recording(path=path, marker_set=Path("sample:actor_a"))
    assert given.marker_set == read_recording(path=Path("sample:actor_a")).marker_set


def test_a_given_set_comes_before_the_files_own(gappy: Trajectories, tmp_path: Path) -> None:
    own = Trajectories(
        positions=gappy.positions, markers=gappy.markers, rate=60, marker_set=SET.keep(["a"])
    )
    (tmp_path / "it.npz").write_bytes(npz_bytes(own))
    (tmp_path / "set.yaml").write_text(marker_set_text(SET), encoding="utf-8")
    assert read_recording(path=tmp_path / "it.npz").marker_set == SET.keep(["a"])
    read = read_recording(path=tmp_path / "it.npz", marker_set=tmp_path / "set.yaml")
    assert read.marker_set == SET


def test_a_set_that_does_not_fit_is_refused(gappy: Trajectories, tmp_path: Path) -> None:
    (tmp_path / "it.csv").write_bytes(csv_bytes(gappy))
    (tmp_path / "set.yaml").write_text("markers: [a, x, y]", encoding="utf-8")
    with pytest.raises(
        ValueError, match=r"names x, y, which the recording lacks; it has a, b c, é"
    ):
        read_recording(path=tmp_path / "it.csv", marker_set=tmp_path / "set.yaml")


@pytest.mark.parametrize("shape", [(0, 2, 3), (3, 0, 3)])
def test_a_recording_without_samples_is_refused(tmp_path: Path, shape: Any) -> None:
    names = ("a", "b")[: shape[1]]
    path = tmp_path / "it.npz"
    path.write_bytes(npz_bytes(Trajectories(positions=np.ones(shape), markers=names, rate=60)))
    with pytest.raises(ValueError, match=r"it\.npz: the recording holds no samples"):
        read_recording(path=path)


def test_a_position_at_which_nothing_can_be_is_refused_with_its_sample(tmp_path: Path) -> None:
    positions = np.ones((4, 2, 3))
    positions[2, 1, 0] = -1e28
    path = tmp_path / "it.npz"
    path.write_bytes(npz_bytes(Trajectories(positions=positions, markers=("a", "b"), rate=60)))
    with pytest.raises(ValueError, match=r"it\.npz: frame 2, marker 'b': a position at 1e\+28 mm"):
        read_recording(path=path)


@pytest.mark.parametrize("write", [write_c3d, write_csv, write_npz, write_trc])
def test_a_recording_of_nothing_but_gaps_is_read_and_reported(
    tmp_path: Path, write: Callable[..., None]
) -> None:
    positions = np.full((4, 2, 3), np.nan)
    write(Trajectories(positions=positions, markers=("a", "b"), rate=60), tmp_path / "it.csv")
    with pytest.warns(UserWarning, match="every sample of the recording is missing"):
        read = read_recording(path=tmp_path / "it.csv")
    assert read.positions.shape == (4, 2, 3)
    assert not read.present.any()


@pytest.mark.parametrize("write", [write_c3d, write_csv, write_npz, write_trc])
def test_a_rate_that_is_set_counts_and_both_are_named(
    gappy: Trajectories, tmp_path: Path, write: Callable[..., None]
) -> None:
    path = tmp_path / "it.csv"
    write(gappy, path)
    assert read_recording(path=path, rate=59.94).rate == 59.94
    with pytest.warns(UserWarning, match="240 Hz is taken|by `rate`") as caught:
        read = read_recording(path=path, rate=240.0)
    assert "states a rate of 59.94 Hz; 240 Hz is taken" in str(caught[0].message)
    assert read.rate == 240
    np.testing.assert_allclose(read.positions, gappy.positions, rtol=1e-6)


TRC = "PathFileType\t4\nDataRate\tUnits\n\tmm\nFrame#\tTime\ta\n\t\tX1\tY1\tZ1\n1\t0\t1\t2\t3\n"
WITHOUT_RATE = {
    "wide": "# unit: mm\nframe,a.x,a.y,a.z\n7,1,2,3\n8,1,2,3\n",
    "long": "# unit: mm\nframe,marker,x,y,z\n7,a,1,2,3\n",
    "levels": "# unit: mm\n,a,a,a\n,x,y,z\n7,1,2,3\n",
    "QTM": "NO_OF_MARKERS\t1\nMARKER_NAMES\ta\n1\t2\t3\n",
    "Motive": "Format Version,1.23,Length Units,Millimeters\n,,Marker,Marker,Marker\n,,a,a,a\n"
    "Frame,Time,X,Y,Z\n0,0,1,2,3\n",
    "Vicon": "Trajectories\nnone\n,,a\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n1,0,1,2,3\n",
    "TRC": TRC,
    "MOT": "it\nUnits=mm\nendheader\ntime\ta_x\ta_y\ta_z\n0\t1\t2\t3\n",
}


@pytest.mark.parametrize("text", WITHOUT_RATE.values(), ids=WITHOUT_RATE)
def test_a_file_without_a_rate_says_which_setting_gives_it(tmp_path: Path, text: str) -> None:
    path = tmp_path / "it.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=r"it\.csv.*(no rate|a positive number).*set `rate`"):
        read_recording(path=path)
    read = read_recording(path=path, rate=50.0)
    assert (read.rate, read.positions[0].tolist()) == (50, [[1, 2, 3]])


def test_an_archive_without_a_rate_says_which_setting_gives_it(tmp_path: Path) -> None:
    np.savez(tmp_path / "it.npz", positions=np.ones((4, 1, 3)), markers=["a"])
    with pytest.raises(ValueError, match=r"it\.npz.*no array rate; set `rate`"):
        read_recording(path=tmp_path / "it.npz")
    assert read_recording(path=tmp_path / "it.npz", rate=50.0).rate == 50


@pytest.mark.parametrize("write", [write_c3d, write_csv, write_npz, write_trc])
@pytest.mark.parametrize("rate", [0.001, 0.1, 3e5])
def test_a_rate_at_which_nothing_is_captured_is_reported(
    gappy: Trajectories, tmp_path: Path, write: Callable[..., None], rate: float
) -> None:
    write(replace(gappy, rate=rate), tmp_path / "it")
    (tmp_path / "it").rename(tmp_path / "it.csv")
    with pytest.warns(UserWarning, match=f"a rate of {rate:g} Hz, at which no motion is"):
        assert read_recording(path=tmp_path / "it.csv").rate == pytest.approx(rate)
