from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph_files import csv_bytes, npz_bytes
from nodegraph_files.readers import read_recording
from nodegraph_files.units import MILLIMETRES, unit_from, unit_named
from nodegraph_mocap import Trajectories

FACE = np.random.default_rng(2).uniform(-1, 1, (5, 8, 3)) * [70.0, 100.0, 50.0]


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        ("mm", 1), ("MM ", 1), ("millimeters", 1), ("cm", 10), ("centimetre", 10), ("dm", 100),
        ("m", 1000), ("Metres", 1000), ("meter", 1000), ("in", 25.4), ("inches", 25.4),
        ("ft", 304.8), ("feet", 304.8), ("µm", 0.001), ("mete", 1000), ("mill", 1),
    ],
)  # fmt: skip
def test_a_known_unit(unit: str, factor: float) -> None:
    assert MILLIMETRES[unit_named(unit) or ""] == factor


@pytest.mark.parametrize(("unit", "message"), [("px", "'px' is unknown"), (" ", "no unit")])
def test_an_unknown_unit_is_reported(unit: str, message: str) -> None:
    assert unit_named(unit) is None
    positions = np.ones((1, 1, 3))
    with pytest.warns(UserWarning, match=f"{message}.*mm is assumed$"):
        unit_from("auto", unit).convert(positions)
    assert (positions == 1).all()


def table(path: Path, unit: str, header: str = "{}.{}", form: str = "wide") -> Path:
    """Write the face as a table in that unit, which only the header may state."""
    numbers = FACE / MILLIMETRES[unit]
    if form == "wide":
        names = [header.format(f"m{marker}", axis) for marker in range(8) for axis in "xyz"]
        rows = [",".join(map(repr, frame)) for frame in numbers.reshape(5, -1).tolist()]
    else:
        names = ["frame", "marker", *(header.format("", axis)[1:] for axis in "xyz")]
        rows = [
            f"{frame},m{marker},{','.join(map(repr, numbers[frame, marker].tolist()))}"
            for frame in range(5)
            for marker in range(8)
        ]
    path.write_text("\n".join(["# rate: 60", ",".join(names), *rows]))
    return path


@pytest.mark.parametrize("unit", ["mm", "cm", "m"])
def test_a_face_without_a_unit_is_read_in_the_one_that_makes_it_a_face(
    tmp_path: Path, unit: str
) -> None:
    with pytest.warns(UserWarning, match=f"no unit .*; {unit} is assumed, by which .* span 1.* mm"):
        read = read_recording(path=table(tmp_path / "it.csv", unit))
    np.testing.assert_allclose(read.positions, FACE)


@pytest.mark.parametrize("form", ["wide", "long"])
@pytest.mark.parametrize("header", ["{}.{} [cm]", "{} {} (cm)"])
def test_the_unit_of_a_header(tmp_path: Path, header: str, form: str) -> None:
    read = read_recording(path=table(tmp_path / "it.csv", "cm", header, form))
    np.testing.assert_allclose(read.positions, FACE)


def test_columns_in_two_units_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "it.csv"
    path.write_text("# rate: 60\na.x [cm],a.y [mm],a.z\n1,2,3\n")
    with pytest.raises(ValueError, match=r"it\.csv:2:2: .*'mm', but others are in 'cm'"):
        read_recording(path=path)


@pytest.mark.parametrize("write", [npz_bytes, csv_bytes])
def test_a_size_that_nothing_has_is_reported_and_the_user_decides(
    tmp_path: Path, write: Any
) -> None:
    path = tmp_path / "it"
    small = Trajectories(positions=FACE / 1000, markers=tuple("abcdefgh"), rate=60)
    path.with_suffix(".csv").write_bytes(write(small))
    with pytest.warns(UserWarning, match="span 0.1.* mm, which no face or body does; set `unit`"):
        read_recording(path=path.with_suffix(".csv"))
    read = read_recording(path=path.with_suffix(".csv"), unit="m")
    np.testing.assert_allclose(read.positions, FACE)


def test_lengths_out_of_range_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "it.npz"
    positions = np.full((2, 1, 3), 1e100)
    path.write_bytes(npz_bytes(Trajectories(positions=positions, markers=("a",), rate=60)))
    with pytest.raises(ValueError, match=r"position at 1e\+100 mm; up to"):
        read_recording(path=path)
