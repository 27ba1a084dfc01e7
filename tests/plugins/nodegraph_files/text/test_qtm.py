from __future__ import annotations

import numpy as np
import pytest

from nodegraph_files import read_csv
from tests.plugins.nodegraph_files.conftest import Write

ROWS = ("1 2 3 4 5 6", "7 8 9 10 11 12")


def qtm(*rows: str, extra: tuple[str, ...] = (), **facts: object) -> str:
    """Return an export whose tabs are written as spaces; a fact that is None is left out."""
    header: dict[str, object] = {
        "NO_OF_FRAMES": str(len(rows)),
        "NO_OF_CAMERAS": "8",
        "NO_OF_MARKERS": "2",
    }
    header |= {
        "FREQUENCY": "100",
        "DESCRIPTION": "--",
        "TIME_STAMP": "2022-06-03,",
        "DATA_INCLUDED": "3D",
    }
    header |= {"MARKER_NAMES": "lip nose"}
    expected = [
        f"{name} {value}" for name, value in {**header, **facts}.items() if value is not None
    ]
    return "\n".join([*expected, *extra, *rows, ""]).replace(" ", "\t")


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "extra",
    [
        (),
        ("TRAJECTORY_TYPES Measured Measured",),
        ("lip~X lip~Y lip~Z nose~X nose~Y nose~Z",),
        ("TRAJECTORY_TYPES Measured Measured", "lip~X lip~Y lip~Z nose~X nose~Y nose~Z"),
    ],
)
@pytest.mark.parametrize("end", ["", "\t"])
def test_what_stands_in_the_cells_is_read(write: Write, extra: tuple[str, ...], end: str) -> None:
    text = qtm(*(row + end for row in ROWS), extra=extra).replace("~", " ")
    read = read_csv(write(text))
    assert read.markers == ("lip", "nose")
    assert read.rate == 100
    assert read.positions.tolist() == [[[1, 2, 3], [4, 5, 6]], [[7, 8, 9], [10, 11, 12]]]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("extra", [(), ("Frame Time lip~X lip~Y lip~Z nose~X nose~Y nose~Z",)])
def test_frames_may_begin_with_their_number_and_time(write: Write, extra: tuple[str, ...]) -> None:
    rows = [f"{frame} {frame / 100} {row}" for frame, row in enumerate(ROWS, 1)]
    read = read_csv(write(qtm(*rows, extra=extra).replace("~", " ")))
    assert read.positions[1].tolist() == [[7, 8, 9], [10, 11, 12]]


def test_numbers_and_times_that_contradict_the_header_are_reported(write: Write) -> None:
    text = qtm(*(f"{2 * frame} {frame / 60} {ROWS[0]}" for frame in range(300)))
    with (
        pytest.warns(UserWarning, match="299 of 299 steps of the frame number are not 1"),
        pytest.warns(UserWarning, match=r"lasts 4\.98333 s, by FREQUENCY 2\.99 s"),
    ):
        assert read_csv(write(text)).rate == 100


def test_events_and_facts_of_other_versions_do_no_harm(write: Write) -> None:
    text = qtm(*ROWS, FILE_VERSION="2.0.0", EVENT="start 1 0.01").split("\n")
    text.insert(0, text.pop(next(i for i, line in enumerate(text) if "FILE_V" in line)))
    text.insert(3, "EVENT\tstop\t2\t0.02")
    assert read_csv(write("\n".join(text))).frames == 2


def test_zeros_empty_cells_and_null_are_missing(write: Write) -> None:
    path = write(qtm("0.000 0.000 0.000 1 2 3", "1 2 3   ", "NULL NULL NULL NaN NaN NaN"))
    with pytest.warns(UserWarning, match=r"1 samples are at exactly \(0, 0, 0\)"):
        read = read_csv(path)
    assert read.present.tolist() == [[False, True], [True, False], [False, False]]
    assert read_csv(path, zeros_missing=False).present[0].all()


@pytest.mark.filterwarnings("error")
def test_counts_may_lack(write: Write) -> None:
    assert read_csv(write(qtm(*ROWS, NO_OF_FRAMES="2.0", NO_OF_MARKERS=None))).frames == 2


def test_a_rate_may_be_added(write: Write) -> None:
    assert read_csv(write("# rate: 60\n" + qtm(*ROWS, FREQUENCY="EXT"))).rate == 60


def test_a_row_that_ends_early_is_reported(write: Write) -> None:
    with pytest.warns(UserWarning, match="1 rows end before the last of 6 columns"):
        read = read_csv(write(qtm("1 2 3 4 5 6", "1 2 3")))
    np.testing.assert_array_equal(read.present, [[True, True], [True, False]])


@pytest.mark.parametrize(
    ("text", "message", "markers"),
    [
        (
            qtm(*ROWS, extra=("TRAJECTORY_TYPES Mixed Gap-filled",)),
            r"2 trajectories .*: lip \(Mixed\), nose \(Gap-filled\)",
            ("lip", "nose"),
        ),
        (
            qtm(*ROWS, NO_OF_FRAMES="1000000000000"),
            "says 1000000000000 frames, the file holds 2",
            ("lip", "nose"),
        ),
        (
            qtm(*ROWS, NO_OF_MARKERS="22"),
            "says 22 markers, the file holds 2",
            ("lip", "nose"),
        ),
        (qtm(*ROWS, MARKER_NAMES="lip"), "1 markers had no label", ("lip", "unnamed_2")),
        (
            qtm(*ROWS, MARKER_NAMES="lip nose chin"),
            "1 labels beyond the 2 markers were left out: chin",
            ("lip", "nose"),
        ),
        (qtm(*ROWS, MARKER_NAMES="lip lip"), "'lip' is now 'lip_2'", ("lip", "lip_2")),
    ],
)
def test_what_is_odd_is_read_with_a_warning(
    write: Write, text: str, message: str, markers: tuple[str, ...]
) -> None:
    with pytest.warns(UserWarning, match=message):
        read = read_csv(write(text))
    assert read.markers == markers
    assert read.positions.tolist() == [[[1, 2, 3], [4, 5, 6]], [[7, 8, 9], [10, 11, 12]]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (qtm(*ROWS, DATA_INCLUDED="2D"), ":7:2: DATA_INCLUDED is '2D'; only 3D data"),
        (qtm(*ROWS, FREQUENCY="EXT"), ":4:2: FREQUENCY must be a positive .* 'EXT'; set `rate`"),
        (qtm(*ROWS, FREQUENCY="0"), ":4:2: FREQUENCY must be .* says '0'"),
        (qtm(*ROWS, FREQUENCY=None), ": FREQUENCY must be .* says none; set `rate`"),
        (qtm(*ROWS, MARKER_NAMES=None), ": no names follow MARKER_NAMES"),
        (qtm(*ROWS, MARKER_NAMES=""), ": no names follow MARKER_NAMES"),
        (qtm(), ": no frames follow line 8"),
        (qtm("1 2 3 4"), ":9: 4 coordinates make no whole number of markers; MARKER_NAMES has 2"),
        (qtm("1 2 3 4 5 6", "1 2 3 4 5 x"), ":10:6: 'x' is not a number"),
    ],
)
def test_what_is_wrong_is_refused_with_its_place(write: Write, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=rf"take\.csv{message}"):
        read_csv(write(text))
