"""Recordings as datasets of movement: what survives, what is read, and what is refused."""

from __future__ import annotations

import gc
import sys
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path

import h5netcdf
import h5py
import numpy as np
import pytest
import xarray

from nodegraph import NodegraphError, get_node
from nodegraph_files import npz_bytes
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.specimens import recordings
from nodegraph_xarray import from_xarray, to_xarray

RECORDINGS = {name: each for name, each in recordings().items() if name != "another memory order"}


@pytest.fixture
def processed() -> Trajectories:
    return RECORDINGS["filled, repaired and with sigma"]


def poses(*, rate: float | None = 50.0, **other: object) -> xarray.Dataset:
    """Return a dataset as movement makes it, in millimetres."""
    positions = np.random.default_rng(0).normal(size=(6, 3, 4, 2)) * 50
    attributes = {"source_software": "DeepLabCut", "ds_type": "poses", "time_unit": "frames"}
    if rate is not None:
        attributes |= {"fps": rate, "time_unit": "seconds"}  # type: ignore[dict-item]
    return xarray.Dataset(
        {
            "position": (("time", "space", "keypoint", "individual"), positions, {"units": "mm"}),
            "confidence": (("time", "keypoint", "individual"), np.full((6, 4, 2), np.nan)),
        },
        {
            "time": np.arange(6) / (rate or 1),
            "space": ["x", "y", "z"],
            "keypoint": list("abcd"),
            "individual": ["left", "right"],
        },
        attributes | other,
    )


@pytest.mark.filterwarnings("ignore:.*every sample of the recording is missing")
@pytest.mark.parametrize("recording", RECORDINGS.values(), ids=RECORDINGS)
def test_a_recording_reads_back_equal_from_a_dataset_and_from_netcdf(
    recording: Trajectories, tmp_path: Path
) -> None:
    dataset = to_xarray(recording)
    assert npz_bytes(from_xarray(dataset)) == npz_bytes(recording)
    path = tmp_path / "it.nc"
    path.write_bytes(get_node("write.nc")(recording).content["recording.nc"])
    assert npz_bytes(get_node("read.recording")(path=path)) == npz_bytes(recording)


def test_netcdf_4_of_other_programs_is_read(processed: Trajectories, tmp_path: Path) -> None:
    dataset = to_xarray(processed).assign_attrs(count=3, weights=[0.5, 2.0])
    dataset["speed"] = dataset["position"].sum("space")
    dataset = dataset.assign_coords(view=("individual", ["left"]))
    encoding = {"position": {"compression": "gzip", "dtype": ">f8"}}
    dataset.to_netcdf(tmp_path / "it.nc", engine="h5netcdf", encoding=encoding)
    with pytest.warns(UserWarning, match="variables that a recording cannot keep: speed"):
        read = get_node("read.recording")(path=tmp_path / "it.nc")
    assert npz_bytes(read) == npz_bytes(processed)


def test_a_dataset_has_the_layout_of_movement(processed: Trajectories) -> None:
    dataset = to_xarray(processed)
    assert dataset["position"].dims == ("time", "space", "keypoint", "individual")
    assert dataset["confidence"].dims == ("time", "keypoint", "individual")
    assert tuple(dataset["keypoint"].values) == processed.markers
    assert list(dataset["space"].values) == ["x", "y", "z"]
    known = {"ds_type": "poses", "fps": 60.0, "time_unit": "seconds"}
    assert known.items() <= dict(dataset.attrs).items()
    assert dataset["time"].values[30] == 0.5


@pytest.mark.parametrize("older", [False, True], ids=["0.17", "before 0.17"])
def test_an_individual_is_read_whatever_the_order_and_the_unit(older: bool) -> None:
    dataset = poses()
    expected = dataset["position"].sel(individual="right").transpose("time", "keypoint", "space")
    dataset = dataset.transpose("individual", ...).isel(space=[2, 0, 1])
    dataset["position"] = (dataset["position"] / 10).assign_attrs(units="cm")
    if older:
        dataset = dataset.rename(keypoint="keypoints", individual="individuals")
    recording = from_xarray(dataset, individual="right")
    np.testing.assert_allclose(recording.positions, expected, rtol=1e-14)
    assert (recording.markers, recording.rate) == (("a", "b", "c", "d"), 50.0)


def test_what_was_done_to_a_dataset_is_marked_and_counted() -> None:
    gappy = RECORDINGS["gaps"]
    dataset = to_xarray(gappy)
    dataset["position"] = dataset["position"].interpolate_na("time")
    frame, marker = np.argwhere(gappy.present)[7]
    dataset["position"][frame, :, marker] = np.nan
    dataset["confidence"][1, 0] = 0.4
    dataset["speed"] = dataset["position"].sum("space")
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        recording = from_xarray(dataset)
    assert recording.origin[frame, marker] == Origin.MISSING
    filled = recording.origin == Origin.FILLED
    assert filled.any()
    np.testing.assert_array_equal(filled, ~gappy.present & recording.present)
    messages = [str(each.message) for each in warned]
    assert len(messages) == 4
    assert "speed" in messages[0]
    assert messages[1].startswith("1 confidences")
    assert messages[2].startswith("1 samples are missing")
    assert messages[3].startswith(f"{np.count_nonzero(filled)} samples are filled")


def without_a_frame(dataset: xarray.Dataset) -> xarray.Dataset:
    return dataset.drop_isel(time=3)


def in_words(dataset: xarray.Dataset) -> xarray.Dataset:
    return dataset.assign(position=dataset["position"].astype(str))


def renamed_half(dataset: xarray.Dataset) -> xarray.Dataset:
    return dataset.assign(other=("keypoints", [1.0]))


WRONG: Mapping[str, tuple[Callable[[xarray.Dataset], xarray.Dataset], str]] = {
    "boxes": (lambda it: it.assign_attrs(ds_type="bboxes"), "a dataset of bboxes"),
    "no position": (lambda it: it.drop_vars("position"), "no variable position; there is conf"),
    "a view": (lambda it: it.expand_dims("view"), "position has the dimensions view, time"),
    "flat": (lambda it: it.isel(space=[0, 1]), "of space are x, y; .* three dimensions"),
    "both names": (renamed_half, "dimensions keypoints and keypoint: only one"),
    "words": (in_words, "position is of type <U.*, and not of numbers"),
    "a frame lacks": (without_a_frame, r"0\.04 to 0\.08 in frame 3, and so 1 of 4 steps"),
    "no rate": (lambda it: poses(rate=None), "the attribute fps is None"),
    "a negative rate": (lambda it: it.assign_attrs(fps=-50.0), r"the attribute fps is -50\.0"),
    "another rate": (lambda it: it.assign_attrs(fps=25.0), "not evenly spaced at 25 Hz"),
    "the same name": (
        lambda it: it.assign_coords(keypoint=["a", "a", "b", "c"]),
        "markers: named twice: a",
    ),
    "no set": (lambda it: it.assign_attrs(marker_set="[1]"), "it must be a mapping"),
}


@pytest.mark.parametrize(("change", "message"), WRONG.values(), ids=WRONG)
def test_what_is_no_recording_is_refused(
    change: Callable[[xarray.Dataset], xarray.Dataset], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        from_xarray(change(poses()), individual="left")


def test_several_individuals_are_listed_to_choose_from() -> None:
    with pytest.raises(ValueError, match=r"2 individuals.*left, right"):
        from_xarray(poses())
    with pytest.raises(ValueError, match="no individual 'both'; there is left, right"):
        from_xarray(poses(), individual="both")


def test_a_hostile_file_is_refused_with_its_name(
    tmp_path: Path, processed: Trajectories, monkeypatch: pytest.MonkeyPatch
) -> None:
    printed: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", printed.append)
    good = get_node("write.nc")(processed).content["recording.nc"]
    dataset = to_xarray(processed)
    dataset.to_netcdf(tmp_path / "good.nc", engine="h5netcdf")
    hdf = (tmp_path / "good.nc").read_bytes()
    with h5netcdf.File(tmp_path / "huge.nc", "w") as huge:
        huge.dimensions = {"time": 10**11}
        huge.create_variable("position", ("time",), float, chunks=(1000,))
    endless = good[:8] + b"\0\0\0\x0a\0\0\0\x01\x7f\xff\xff\xff"  # the name of a dimension
    torn = hdf.replace(b"OHDR", b"ODHR")
    begun = b"CDF\x01" + b"\xff" * 60
    encoding = good.replace(b"utf-8", b"utx-8")
    begin = hdf.index(b"GCOL") + 16
    looped = hdf[:begin] + bytes(16) + hdf[begin + 16 :]  # a text of no length follows itself
    for content in (looped, good[:400], good[:-9000], endless, encoding, hdf[:3000], torn, begun):
        (tmp_path / "it.nc").write_bytes(content)
        with pytest.raises(ValueError, match=r"it\.nc: (not a readable netCDF file|no recording)"):
            get_node("read.recording")(path=tmp_path / "it.nc")
    with pytest.raises(ValueError, match=r"huge\.nc.*announces 800000000000 bytes"):
        get_node("read.recording")(path=tmp_path / "huge.nc")
    gc.collect()
    assert not printed


def test_an_attribute_that_is_nested_too_deeply_is_refused(
    tmp_path: Path, processed: Trajectories
) -> None:
    dataset = to_xarray(processed).assign_attrs(marker_set="[" * 100_000)
    dataset.to_netcdf(tmp_path / "it.nc", engine="scipy")
    with pytest.raises(ValueError, match=r"it\.nc: no recording: maximum recursion depth"):
        get_node("read.recording")(path=tmp_path / "it.nc")


def stored_outside(file: h5py.File) -> None:
    file.create_dataset("position", (4,), "f8", external=[("other.nc", 0, 32)])


def virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout((4,), "f8")
    layout[:] = h5py.VirtualSource("other.nc", "time", (4,))
    file.create_group("deep").create_virtual_dataset("position", layout)


def linked(file: h5py.File) -> None:
    file["position"] = h5py.ExternalLink("other.nc", "/position")


@pytest.mark.parametrize("refer", [stored_outside, virtual, linked])
def test_a_file_that_refers_to_others_is_refused(
    tmp_path: Path, processed: Trajectories, refer: Callable[[h5py.File], None]
) -> None:
    to_xarray(processed).to_netcdf(tmp_path / "other.nc", engine="h5netcdf")
    with h5py.File(tmp_path / "it.nc", "w") as file:
        refer(file)
    with pytest.raises(ValueError, match=r"it\.nc: .*/(deep/)?(position)? refers to other files"):
        get_node("read.recording")(path=tmp_path / "it.nc")


def test_without_xarray_the_message_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, processed: Trajectories
) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(NodegraphError, match=r"pip install 'nodegraph\[xarray\]'"):
        to_xarray(processed)
