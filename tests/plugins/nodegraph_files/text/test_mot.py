"""Tables of motion by OpenSim: points are read, and what is none is refused with its place."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from nodegraph import get_node
from nodegraph_files import read_mot

HEADER = "markers\nversion=1\nnRows=3\nnColumns=7\nUnits=m\ninDegrees=no\n{more}endheader\n"
ROWS = ("0.00 1 2 3 4 5 6", "0.01 nan nan nan 4 5 7", "0.02 1 2 4 4 5 8")


def mot(names: str, rows: tuple[str, ...] = ROWS, *, more: str = "", drop: str = "") -> str:
    """Return a file whose tabs are written as spaces."""
    body = "\n".join([f"time {names}", *rows, ""]).replace(" ", "\t")
    return HEADER.format(more=more).replace(drop, "") + body


def saved(folder: Path, text: str) -> Path:
    (folder / "take.mot").write_text(text)
    return folder / "take.mot"


@pytest.mark.filterwarnings("ignore:.*no face or body")
@pytest.mark.parametrize(
    "text",
    [
        mot("lip_tx lip_ty lip_tz nose_tx nose_ty nose_tz"),
        mot("lip_X lip_Y lip_Z nose_X nose_Y nose_Z"),
        mot("lip.x lip.y lip.z nose.x nose.y nose.z").replace("\n", "\r\n"),
        mot("lip_1 lip_2 lip_3 nose_1 nose_2 nose_3"),
        mot(
            "lip nose",
            ("0.00 1,2,3 4,5,6", "0.01 nan,nan,nan 4,5,7", "0.02 1,2,4 4,5,8"),
            more="DataType=Vec3\n",
        ),
    ],
)
def test_points_are_read_in_any_form(tmp_path: Path, text: str) -> None:
    recording = get_node("read.recording")(path=saved(tmp_path, text))
    assert (recording.markers, recording.rate) == (("lip", "nose"), 100.0)
    expected = [[[1, 2, 3], [4, 5, 6]], [[np.nan] * 3, [4, 5, 7]], [[1, 2, 4], [4, 5, 8]]]
    np.testing.assert_array_equal(recording.positions, np.array(expected) * 1000)


def test_a_file_without_a_unit_is_in_metres_unless_another_alone_is_plausible(
    tmp_path: Path,
) -> None:
    names = " ".join(f"m{marker}_{axis}" for marker in range(4) for axis in "xyz")
    for size, unit in ((10, "cm"), (1000, "m")):
        corners = np.array([[0, 0, 1], [120, 0, 1], [0, 300, 1], [0, 0, 80]]).ravel() / size
        rows = tuple(f"{time:g} " + " ".join(map(str, corners)) for time in (0, 0.01, 0.02))
        with pytest.warns(UserWarning, match=f"no unit of length; {unit} is assumed.*300 mm"):
            recording = get_node("read.recording")(
                path=saved(tmp_path, mot(names, rows, drop="Units=m\n"))
            )
        np.testing.assert_allclose(recording.positions[0].ravel(), corners * size)


POINTS = "a_x a_y a_z b_x b_y b_z"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (mot("hip_flexion knee pelvis_tx pelvis_ty pelvis_tz x"), ":8: .*angles.*hip_flexion"),
        (mot("f_vx f_vy f_vz f_px f_py f_pz"), ":8: .*forces: f_vx"),
        (mot("a_x a_y a_z b_x b_y b_y"), ":8: columns: named twice: b_y"),
        (mot("a_x a_y a_z b_x  b_z"), ":8:6: a column has no name"),
        (mot(POINTS, ("0.0 1 2 3 4 5",)), ":9: 6 cells, but 7 columns"),
        (mot(POINTS, ("0.0 1 2 3 4 5 6", "0.1 1 2 three 4 5 6")), ":10:4: .*'three'"),
        (mot(POINTS, ()), "no frames follow line 8"),
        (mot(POINTS, ROWS[:1]), "no rate"),
        (mot(POINTS, more="DataType=Quaternion\n"), "DataType=Quaternion, but"),
        (mot(POINTS).replace("time", "frame"), ":8: the first column is 'frame'"),
        (mot(POINTS, drop="endheader\n"), "no line endheader"),
        ("markers\nendheader\n", ": the first column is 'endheader'"),
        ("", "the file is empty"),
    ],
)
@pytest.mark.filterwarnings("ignore:the header says 3 rows")
def test_what_is_no_table_of_points_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=rf"take\.mot.*{message}"):
        get_node("read.recording")(path=saved(tmp_path, text))


@pytest.mark.filterwarnings("ignore:.*no face or body")
def test_a_file_without_a_unit_and_of_no_plausible_size_is_in_metres(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match="no unit of length; m is assumed$"):
        recording = get_node("read.recording")(path=saved(tmp_path, mot(POINTS, drop="Units=m\n")))
    assert recording.positions[0, 0].tolist() == [1000, 2000, 3000]


@pytest.mark.filterwarnings("ignore:.*no face or body")
def test_a_file_that_ends_early_says_so(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match="the header says 3 rows, the file holds 2"):
        get_node("read.recording")(path=saved(tmp_path, mot(POINTS, ROWS[:2])))


@pytest.mark.parametrize("read", [get_node("read.recording"), read_mot])
def test_times_that_give_no_possible_rate_are_refused_with_the_file(
    tmp_path: Path, read: Callable[..., object]
) -> None:
    rows = tuple(f"{time}e9 1 2 3" for time in range(3))
    path = saved(tmp_path, mot("lip_tx lip_ty lip_tz", rows))
    with pytest.raises(ValueError, match=r"take\.mot: rate must be from 0\.001"):
        read(path=path)


def test_a_long_cell_is_quoted_without_its_middle(tmp_path: Path) -> None:
    path = saved(tmp_path, mot("lip_tx lip_ty lip_tz", (f"0 {'z' * 9999} 2 3",)))
    with pytest.raises(ValueError, match=r"take\.mot:9:2: 'z+ … z+' is not a number") as caught:
        read_mot(path)
    assert len(str(caught.value)) < len(str(path)) + 130
