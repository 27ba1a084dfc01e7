from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from nodegraph_files import read_csv
from tests.plugins.nodegraph_files.conftest import Write

FACTS = {
    "Format Version": "1.23",
    "Take Name": "Take 1",
    "Capture Frame Rate": "240.000000",
    "Export Frame Rate": "120.000000",
    "Total Exported Frames": "2",
    "Length Units": "Meters",
    "Coordinate Space": "Global",
}
MARKER = ("Marker", "Face:lip", "Position", "XYZ")
LOOSE = ("Marker", "Unlabeled 1189", "Position", "XYZ")
EXPECTED = ("Rigid Body Marker", "Face:lip", "Position", "XYZ")
TURNED = ("Rigid Body", "Head", "Rotation", "XYZW")
MOVED = ("Rigid Body", "Head", "Position", "XYZ")
ERROR = ("Rigid Body", "Head", "Mean Marker Error", " ")


def motive(
    *groups: tuple[str, str, str, str],
    words: bool = False,
    without: tuple[str, ...] = (),
    lead: str = "Frame,Time (Seconds)",
    rows: tuple[str, ...] | None = None,
    **facts: object,
) -> str:
    """Return an export in which the columns of these groups count from 1 in the first frame."""
    columns = [(*group[:3], axis.strip()) for group in groups for axis in group[3]]
    header = {**FACTS, **{name.replace("_", " "): value for name, value in facts.items()}}
    blanks = "," * lead.count(",")
    lines = [",".join(f"{name},{value}" for name, value in header.items() if value is not None), ""]
    for place, word in enumerate(("Type", "Name", "", "Axis")):
        if word == "Axis":
            lines.append(",".join([lead, *(column[3] for column in columns)]))
        elif word not in without:
            first = f",{word}{blanks[1:]}" if words and word else blanks
            lines.append(",".join([first, *(column[place] for column in columns)]))
        if word == "Name":
            lines.append(
                ",".join([f",ID{blanks[1:]}" if words else blanks, *["A1"] * len(columns)])
            )
    numbers = [str(number) for number in range(1, len(columns) + 1)]
    times = "0.008333,10:00:00:00" if "TimeCode" in lead else "0.008333"
    result = (
        ",".join(["0", times.replace("8333", "0000"), *numbers]),
        ",".join(["1", times, *numbers]),
    )
    return "\n".join([*lines, *(result if rows is None else rows), ""])


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("words", [False, True])
@pytest.mark.parametrize(
    ("unit", "millimetres"), [("Meters", 1000), ("Centimeters", 10), ("Millimeters", 1)]
)
def test_markers_are_read(write: Write, words: bool, unit: str, millimetres: float) -> None:
    read = read_csv(write(motive(MARKER, LOOSE, words=words, Length_Units=unit)))
    assert read.markers == ("Face:lip", "Unlabeled 1189")
    assert read.rate == 120
    np.testing.assert_allclose(read.positions[1], np.array([[1, 2, 3], [4, 5, 6]]) * millimetres)


@pytest.mark.parametrize(
    ("text", "first", "message"),
    [
        (
            motive(TURNED, MOVED, ERROR, EXPECTED, MARKER),
            12000, "11 columns .*: 8 of Rigid Body, 3 of Rigid Body Marker",
        ),
        (
            motive(TURNED, MOVED, MARKER, without=("Type",)),
            8000, "7 columns hold no measured marker",
        ),
        (
            motive(MARKER, words=True, lead="Frame,Time (Seconds),TimeCode"),
            1000, "1 columns .*: 1 of TimeCode",
        ),
        (motive(MARKER, MARKER), 1000, "'lip' is now 'lip_2'"),
        (motive(MARKER, Length_Units=None), 1000, "no unit of length; m is assumed"),
        (
            motive(MARKER, Total_Exported_Frames="1" + "0" * 12),
            1000, "says 1000000000000 frames, the file holds 2",
        ),
    ],
)  # fmt: skip
def test_what_is_odd_is_read_with_a_warning(
    write: Write, text: str, first: float, message: str
) -> None:
    with pytest.warns(UserWarning, match=message):
        read = read_csv(write(text))
    assert (read.markers[0], read.frames) == ("lip", 2)
    assert read.positions[0, 0].tolist() == [first, first + 1000, first + 2000]


def test_empty_cells_are_missing(write: Write) -> None:
    read = read_csv(write(motive(MARKER, rows=("0,0,,,", "1,0.008333,1,2,3"))))
    assert read.present.tolist() == [[False], [True]]


def test_an_export_in_utf_16(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_bytes(motive(MARKER).replace("\n", "\r\n").encode("utf-16"))
    assert read_csv(path).markers == ("lip",)


def test_an_export_saved_again_with_semicolons_and_decimal_commas(write: Write) -> None:
    text = motive(
        MARKER, Export_Frame_Rate="120", rows=("0,0.000000,0.25,0.5,1",), Total_Exported_Frames="1"
    )
    with pytest.warns(UserWarning, match="commas count as decimal points, in 3 cells"):
        read = read_csv(write(text.replace(",", ";").replace(".", ",")))
    assert read.positions.tolist() == [[[250, 500, 1000]]]


def test_the_rate_of_capture_where_there_is_no_other(write: Write) -> None:
    rows = ("0,0,1,2,3", "1,0.004167,1,2,3")
    assert read_csv(write(motive(MARKER, rows=rows, Export_Frame_Rate=None))).rate == 240


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (motive(MARKER, rows=()), ": no frames follow line 7"),
        (motive(TURNED, MOVED), ":7: no columns of type Marker; there is Rigid Body$"),
        (motive(MARKER, Export_Frame_Rate="fast"), ":1:8: Export Frame Rate must be .* 'fast'"),
        (motive(MARKER, Export_Frame_Rate="0"), ":1:8: Export Frame Rate must be .* says '0'"),
        (
            motive(MARKER, Export_Frame_Rate=None, Capture_Frame_Rate=None),
            ":1: Export Frame Rate or Capture Frame Rate must be .* says none; set `rate`",
        ),
        (motive(MARKER, Length_Units="Furlongs"), ":1:12: Length Units 'Furlongs'; there is um, m"),
        (motive(MARKER).replace("Frame,Time", "Picture,Time"), ": no row 'Frame, Time"),
        (
            motive(("Marker", "lip", "Position", "XZ")),
            ":7:3: the columns of marker 'lip' are not X, Y",
        ),
        (
            motive(MARKER, rows=("0,0,1,two,3",)),
            r":8:4: 'two' is not a number \(column Face:lip Y\)",
        ),
        (motive(MARKER, without=("Name",)).replace(",,A1,A1,A1\n", ""), ":5: no row of names"),
    ],
)
def test_what_is_wrong_is_reported_with_its_place(write: Write, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=rf"take\.csv{message}"):
        read_csv(write(text))
