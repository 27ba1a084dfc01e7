from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from nodegraph_files import read_csv
from nodegraph_mocap import Trajectories
from tests.plugins.nodegraph_files.conftest import Write

pytestmark = pytest.mark.filterwarnings("ignore:no unit of length")
RATE = "# rate: 60\n"


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("marker", ["marker", "label", "name", "keypoint", "Marker"])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_row_per_frame_and_marker(write: Write, marker: str, separator: str) -> None:
    text = f"{marker},z,frame,x,y\nlip,3,5,1,2\nnose,6,5,4,5\nnose,9,6,7,8\n"
    read = read_csv(write(RATE + text.replace(",", separator)))
    assert read.markers == ("lip", "nose")
    assert read.positions[0].tolist() == [[1, 2, 3], [4, 5, 6]]
    assert read.present.tolist() == [[True, True], [False, True]]


def test_any_order_of_rows_gives_the_same(write: Write, gappy: Trajectories) -> None:
    table = pd.DataFrame(
        [
            (frame, marker, *gappy.positions[frame, place])
            for frame in range(gappy.frames)
            for place, marker in enumerate(gappy.markers)
        ],
        columns=["frame", "marker", "x", "y", "z"],
    )
    shuffled = table.sample(frac=1, random_state=3)
    read = read_csv(write(RATE + shuffled.to_csv(index=False))).keep(gappy.markers)
    np.testing.assert_array_equal(read.positions, gappy.positions)
    present = table.dropna()
    read = read_csv(write(RATE + present.to_csv(index=False))).keep(gappy.markers)
    np.testing.assert_array_equal(read.positions, gappy.positions)


def test_times_tell_frames_and_rate(write: Write) -> None:
    rows = "".join(f"{frame / 60:.3f},a,1,2,3\n" for frame in range(100) if frame != 40)
    with pytest.warns(
        UserWarning, match="1 frames have no row, by the column 'time'; they are mis"
    ):
        read = read_csv(write(f"time,marker,x,y,z\n{rows}"))
    assert (read.rate, read.frames) == (60, 100)
    assert np.flatnonzero(~read.present[:, 0]).tolist() == [40]


def test_frames_count_where_there_are_times_as_well(write: Write) -> None:
    text = "frame,time (ms),marker,x,y,z\n1,0,a,1,2,3\n2,10,a,1,2,3\n2,10,b,1,2,3\n"
    read = read_csv(write(text))
    assert (read.rate, read.frames) == (100, 2)


def test_uneven_times_are_reported(write: Write) -> None:
    rows = "".join(f"{time},a,1,2,3\n" for time in (0, 1, 2, 3.5, 4.5))
    with pytest.warns(UserWarning, match="5 values of the column 'time' are not whole steps apart"):
        assert read_csv(write(f"# rate: 1\ntime,marker,x,y,z\n{rows}")).frames == 5


def test_a_single_frame(write: Write) -> None:
    assert read_csv(write(f"{RATE}frame,marker,x,y,z\n9,a,1,2,3\n")).frames == 1


def test_other_columns_are_left_out_with_a_warning(write: Write) -> None:
    text = f"{RATE}frame,marker,x,y,z,note,score\n0,a,1,2,3,good,0.5\n"
    with pytest.warns(UserWarning, match="2 columns .* left out: note, score"):
        assert read_csv(write(text)).positions.tolist() == [[[1, 2, 3]]]


def test_units_become_millimetres(write: Write) -> None:
    text = f"{RATE}# unit: m\nframe,marker,x,y,z\n0,a,1,2,3\n"
    assert read_csv(write(text)).positions.tolist() == [[[1000, 2000, 3000]]]


def test_quoted_names_may_hold_separators(write: Write) -> None:
    text = f'{RATE}frame,marker,x,y,z\n0,"lip, left",1,2,3\n'
    assert read_csv(write(text)).markers == ("lip, left",)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("frame,marker,x,y\n0,a,1,2\n", r":1: no column z; a recording has three dimensions"),
        ("frame,marker,x,y,z,X\n0,a,1,2,3,4\n", r":1:6: the column 'X' is there twice"),
        ("frame,marker,x,y,z\n", r": no frames follow line 1"),
        ("frame,marker,x,y,z\n0,a,1,2,3\n0,a,1,2,3\n", r":3: marker 'a' is in this frame already"),
        ("frame,marker,x,y,z\n0,a,1,2,3\n\n1,b,1,2,3\n0,a,4,5,6\n", r":5: marker 'a' is in this"),
        ("frame,marker,x,y,z\n0,a,1,2,3\n,a,1,2,3\n", r":3: the row has no frame"),
        ("frame,marker,x,y,z\n0,a,1,2,3\n1,,1,2,3\n", r":3: the row has no marker"),
        ("frame,marker,x,y,z\n0,a,1,two,3\n", r":2:4: 'two' is not a number \(column y\)"),
        ("frame,marker,x,y,z\n0,a,1,2\n", r":2: 4 cells, but 5 columns have names"),
        ("frame,marker,x,y,z\n0,a,1,2,3\n", r": no rate; set `rate` in Hz"),
        (
            "frame,marker,x,y,z\n0,a,1,2,3\n1,a,1,2,3\n1000000000000,a,1,2,3\n",
            r": the column 'frame' goes from 0 to 1e\+12, but only 3 frames have rows",
        ),
    ],
)
def test_what_is_wrong_is_reported_with_its_place(write: Write, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=rf"take\.csv{message}"):
        read_csv(write(text))


def test_rows_that_each_name_another_marker_are_refused(write: Write) -> None:
    rows = "".join(f"{row},m{row},1,2,3\n" for row in range(5000))
    with pytest.raises(ValueError, match=r"5000 rows cannot be 25000000 samples of 5000 markers"):
        read_csv(write(f"{RATE}frame,marker,x,y,z\n{rows}"))
