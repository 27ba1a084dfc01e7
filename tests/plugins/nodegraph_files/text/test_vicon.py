from __future__ import annotations

import pytest

from nodegraph_files import read_csv
from tests.plugins.nodegraph_files.conftest import Write

HEADER = (
    "Trajectories",
    "100",
    ",,Ann:lip,,,Ann:nose,,",
    "Frame,Sub Frame,X,Y,Z,X,Y,Z",
    ",,mm,mm,mm,mm,mm,mm",
)
ROWS = ("101,0,1,2,3,4,5,6", "102,0,7,8,9,,,")


def vicon(*rows: str, **changed: str) -> str:
    """Return a section; `changed` replaces lines of its header, by the words line_1 to line_5."""
    header = [changed.get(f"line_{number}", line) for number, line in enumerate(HEADER, 1)]
    return "\n".join([*header, *(rows or ROWS), ""])


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "text",
    [
        vicon(),
        "\n\n" + vicon(),
        "Devices\n1000\n,,Force\nFrame,Sub Frame,Fx\n,,N\n1,0,5\n1,1,5\n\n" + vicon(),
        vicon() + "\nModel Outputs\n100\n,,Ann:angle\nFrame,Sub Frame,X\n,,deg\n101,0,5\n",
        vicon() + ",,,,,,,\nModel Outputs,,,,,,,\n100,,,,,,,\n",
        "\n".join(line + "," * (7 - line.count(",")) for line in vicon().split("\n")),
    ],
)
def test_the_section_of_trajectories_is_read(write: Write, text: str) -> None:
    read = read_csv(write(text))
    assert read.markers == ("lip", "nose")
    assert read.rate == 100
    assert read.positions[0].tolist() == [[1, 2, 3], [4, 5, 6]]
    assert read.present.tolist() == [[True, True], [True, False]]


def test_semicolons_and_decimal_commas(write: Write) -> None:
    text = vicon("1,0,-391.888,-6180.01,1734.4,1,2,3").replace(",", ";").replace(".", ",")
    with pytest.warns(UserWarning, match="commas count as decimal points, in 3 cells"):
        read = read_csv(write(text))
    assert read.positions[0, 0].tolist() == [-391.888, -6180.01, 1734.4]


def test_units_become_millimetres(write: Write) -> None:
    assert read_csv(write(vicon(line_5=",,m,m,m,m,m,m"))).positions[0, 0, 0] == 1000


def test_rows_that_end_early_and_frames_that_skip_are_reported(write: Write) -> None:
    with (
        pytest.warns(UserWarning, match="1 rows end before the last of 8 columns"),
        pytest.warns(UserWarning, match="1 of 1 steps of Frame are not 1"),
    ):
        read = read_csv(write(vicon("1,0,1,2,3,4,5,6", "5,0,1,2,3")))
    assert read.present.tolist() == [[True, True], [True, False]]


@pytest.mark.parametrize(
    ("names", "message", "markers"),
    [
        (",,lip,,,,,", "'' is now 'unnamed_2'", ("lip", "unnamed_2")),
        (",,lip,,,lip,,", "'lip' is now 'lip_2'", ("lip", "lip_2")),
        (",,lip,,,nose,,,chin,,", "1 labels beyond the 2 markers .*: chin", ("lip", "nose")),
    ],
)
def test_names_that_lack_or_repeat_are_reported(
    write: Write, names: str, message: str, markers: tuple[str, ...]
) -> None:
    with pytest.warns(UserWarning, match=message):
        assert read_csv(write(vicon(line_3=names))).markers == markers


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (vicon(line_1="Model Outputs"), ": no section Trajectories; there is Model Outputs"),
        ("Trajectories\n100\n", ": the section Trajectories ends within its header"),
        (vicon(line_2="0"), ":2:1: the rate must be .* says '0'"),
        (vicon(line_2="fast"), ":2:1: the rate must be .* says 'fast'"),
        (vicon(line_3=",,lip,nose"), ":3:4: the name 'nose' is out of place"),
        (vicon(line_4="Frame,Sub Frame,X,Y,Z,X,Y"), ":4: 5 columns X1, Y1, Z1, ... make no whole"),
        (vicon(line_4="Frame,Sub Frame,X,Y,Z,RX,RY,RZ"), ":4:6: 'RX' where X2 is expected"),
        (vicon(line_5=",,mm,mm,mm,deg,deg,deg"), ":5:6: unit 'deg', where one unit"),
        (vicon(line_5=",,mm,mm,mm,m,m,m"), ":5:6: unit 'm', where one unit"),
        (vicon(line_5=",,deg,deg,deg,deg,deg,deg"), ":5:3: unit 'deg', where one unit"),
        (vicon(line_5=",frames,,,,,,"), ":5:3: unit '', where one unit"),
        (vicon("1,0,1,2,3,4,x,6"), ":6:7: 'x' is not a number"),
        ("\n".join([*HEADER, "", "Devices", ""]), ": no frames follow line 5"),
    ],
)
def test_what_is_wrong_is_reported_with_its_place(write: Write, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=rf"take\.csv{message}"):
        read_csv(write(text))
