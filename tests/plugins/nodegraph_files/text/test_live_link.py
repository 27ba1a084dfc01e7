from __future__ import annotations

import tempfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from nodegraph_files import read_live_link
from tests.plugins.nodegraph_files.conftest import Write

HEADER = "Timecode,BlendShapeCount,JawOpen,EyeBlinkLeft"
ROTATIONS = [
    f"{what}{axis}" for what in ("Head", "LeftEye", "RightEye") for axis in ("Yaw", "Pitch", "Roll")
]


def timecode(count: float, per_second: int = 60) -> str:
    """Return the timecode of a count since midnight."""
    seconds, rest = divmod(count, per_second)
    minutes, second = divmod(int(seconds), 60)
    hour, minute = divmod(minutes, 60)
    return f"{hour % 24:02}:{minute:02}:{second:02}:{rest:06.3f}"


def table(counts: Iterable[float], per_second: int = 60) -> str:
    """Return a file with a frame at each count; its first weight says which row it is."""
    rows = [f"{timecode(at, per_second)},2,{row / 1e4},0.5" for row, at in enumerate(counts)]
    return "\n".join([HEADER, *rows, ""])


@pytest.mark.parametrize("end", ["\n", "\r\n", ",,\n", "\n\n"])
def test_weights_have_the_names_of_their_columns(write: Write, end: str) -> None:
    read = read_live_link(write(table([10, 11]).replace("\n", end)))
    assert read.names == ("JawOpen", "EyeBlinkLeft")
    assert read.values.tolist() == [[0, 0.5], [0.0001, 0.5]]
    assert read.rate == 60


def test_rotations_are_no_weights(write: Write) -> None:
    header = ",".join([HEADER, *ROTATIONS[:4], "TongueOut", *ROTATIONS[4:]])
    numbers = ",".join(["0.1", "0.2", *["9"] * 4, "0.3", *["9"] * 5])
    rows = "".join(f"{timecode(at)},12,{numbers}\n" for at in (1, 2))
    read = read_live_link(write(f"{header}\n{rows}"))
    assert read.names == ("JawOpen", "EyeBlinkLeft", "TongueOut")
    assert read.values.tolist() == [[0.1, 0.2, 0.3]] * 2


@pytest.mark.parametrize(
    ("step", "per_second", "rate"),
    [(1, 60, 60), (2, 60, 30), (2.5, 60, 24), (1, 30, 30), (1, 24, 24), (1, 25, 25), (2, 120, 60)],
)
@pytest.mark.parametrize("first", [0.0, 37.867])
def test_the_step_of_the_timecode_is_the_rate(
    write: Write, step: float, per_second: int, rate: float, first: float
) -> None:
    counts = [first % per_second + step * row for row in range(3 * per_second)]
    read = read_live_link(write(table(counts, per_second)))
    assert read.rate == rate
    assert read.frames == len(counts)


def test_sixty_counts_make_a_second_where_the_take_does_not_tell(write: Write) -> None:
    assert read_live_link(write(table([3, 4, 5]))).rate == 60
    assert read_live_link(write(table([3, 5, 7]))).rate == 30
    with pytest.warns(UserWarning, match="skips 14 frames in 1 gaps"):
        assert read_live_link(write(table([44, 45, 60, 61]))).rate == 60


@pytest.mark.parametrize("step", [1, 2])
@pytest.mark.filterwarnings("error")
def test_a_clock_that_drifts_drops_nothing(write: Write, step: int) -> None:
    counts = [7.867 + 0.9998 * step * row for row in range(12000)]
    read = read_live_link(write(table(counts)))
    assert (read.frames, read.rate) == (12000, 60 / step)


@pytest.mark.filterwarnings("error")
def test_midnight_is_no_step_back(write: Write) -> None:
    last = 24 * 3600 * 60
    read = read_live_link(write(table([last - 2, last - 1, 0, 1])))
    assert (read.frames, read.rate) == (4, 60)


def test_frames_that_the_timecode_skips_are_missing(write: Write) -> None:
    path = write(table([57, 58, 59, 61, 62, 66, 67]))
    message = r"skips 4 frames in 2 gaps, the first after 00:00:00:59\.000"
    with pytest.warns(UserWarning, match=message):
        read = read_live_link(path)
    assert read.frames == 11
    assert np.flatnonzero(np.isnan(read.values).all(axis=1)).tolist() == [3, 6, 7, 8]
    assert (read.values[[0, 1, 2, 4, 5, 9, 10], 0] * 1e4).tolist() == pytest.approx(range(7))


@given(st.data())
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_every_row_comes_to_the_frame_of_its_timecode(data: st.DataObject) -> None:
    step = data.draw(st.sampled_from([1, 2]))
    frames = data.draw(st.integers(80, 200))
    dropped = data.draw(st.sets(st.integers(1, frames - 2), max_size=12))
    kept = [frame for frame in range(frames) if frame not in dropped]
    first = data.draw(st.integers(0, 24 * 3600 * 60))
    shake = data.draw(arrays.arrays(np.float64, len(kept), elements=st.floats(0, 0.2)))
    counts = [first + step * frame + more for frame, more in zip(kept, shake, strict=True)]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "take.csv"
        path.write_text(table([at % (24 * 3600 * 60) for at in counts]))
        read = read_live_link(path)
    assert read.frames == frames
    assert np.flatnonzero(~np.isnan(read.values[:, 0])).tolist() == kept


@pytest.mark.parametrize(
    ("text", "missing", "message"),
    [
        (
            f"{HEADER}\n00:00:00:01.000,2,0.1,0.2\n00:00:00:02.000,0\n00:00:00:03.000,0,,\n",
            [[False] * 2, [True] * 2, [True] * 2],
            "2 frames have no weights, as no face.* is line 3",
        ),
        (
            f"{HEADER}\n00:00:00:01.000,2,,0.2\n00:00:00:02.000,2,0.1,NaN\n",
            [[True, False], [False, True]],
            "2 single weights are missing",
        ),
        (
            table([1, 2]).replace(",2,", ",61,"),
            [[False] * 2] * 2,
            "BlendShapeCount says 61, but 2 columns follow it",
        ),
        (
            table([1, 2, 2, 3, 4]),
            [[False] * 2] * 5,
            "1 frames follow less than half a frame after",
        ),
        (table([5]), [[False] * 2], "a single frame has no rate; 60 Hz is assumed"),
    ],
)
def test_what_is_odd_is_read_with_a_warning(
    write: Write, text: str, missing: list[list[bool]], message: str
) -> None:
    with pytest.warns(UserWarning, match=message):
        read = read_live_link(write(text))
    assert np.isnan(read.values).tolist() == missing
    assert read.rate == 60


def test_a_last_line_within_which_the_file_ends_is_left_out(tmp_path: Path) -> None:
    whole = f"{HEADER}\n00:00:00:01.000,2,0.1,0.2\n00:00:00:02.000,2,0.3,0.4\n"
    (tmp_path / "it.csv").write_text(f"{whole}00:00:00:03.000,2,0.")
    with pytest.warns(UserWarning, match="ends within line 4, after 3 of 4 cells"):
        read = read_live_link(tmp_path / "it.csv")
    np.testing.assert_allclose(read.values, [[0.1, 0.2], [0.3, 0.4]])


def row(*cells: str) -> str:
    return f"{HEADER}\n{','.join(cells)}\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", ": no Live Link Face file: it begins with ''"),
        ("frame,a.x\n", ": no Live Link Face file: it begins with 'frame,a.x'"),
        (f"{HEADER}\n", ": no frames follow"),
        ("Timecode,BlendShapeCount\n00:00:00:01,0\n", ": no columns of weights"),
        ("Timecode,BlendShapeCount,HeadYaw\n00:00:00:01,1,0\n", ": no columns of weights"),
        ("Timecode,BlendShapeCount,,a\n00:00:00:01,1,0,0\n", ": a column has no name"),
        ("Timecode,BlendShapeCount,a,a\n00:00:00:01,2,0,0\n", ": columns: named twice: a"),
        (row("00:00:00:01.000", "2", "0.1", "inf"), ":2:4: the weight EyeBlinkLeft is infinite"),
        (row("00:00:00:01.000", "2", "0.1"), ":2: 3 cells, but 4 columns"),
        (row("00:00:00:01.000", "2", "0.1", "0.2", "0.3"), ":2: 5 cells, but 4 columns"),
        *(
            (row("00:00:00:01.000", *cells), f":2:{column}: '{wrong}' is not a number")
            for column, wrong, cells in (
                (2, "one", ("one", "0.1", "0.2")), (3, "0x1", ("2", "0x1", "0.2")),
                (4, "#N/A", ("2", "0.1", "#N/A")),
            )
        ),
        *(
            (row(written, "2", "0.1", "0.2"), f":2:1: '{written}' is not a timecode")
            for written in ("", "1", "00:00:01.000", "00:00:00:x", "-1:00:00:01", "1e5")
        ),
        *(
            (row(f"00:00:00:{count}", "2", "0.1", "0.2"), f": the timecode counts to {count}, and")
            for count in ("60", "72.5", "500")
        ),
        (
            table([10, 12, 11, 13]),
            r":4:1: the timecode goes back from 00:00:00:12\.000 to 00:00:00:11\.000",
        ),
        (table([10, 10, 10]), ": the timecode stands still"),
        (
            # refused before it takes memory
            table([0, 1, 2, 2 + 6 * 3600 * 60, 3 + 6 * 3600 * 60]),
            ":5:1: the timecode skips 1295999 frames, but",
        ),
    ],
)  # fmt: skip
def test_what_is_wrong_is_refused_with_its_place(write: Write, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=rf"take\.csv{message}"):
        read_live_link(write(text))
