"""Times of rows come from columns of times and of time stamps, in the unit that they have."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest

from nodegraph import get_node
from nodegraph_files.text.counters import is_frame, is_time

POSITIONS, WEIGHTS = "a.x,a.y,a.z", "jawOpen,mouthClose,browDown"
LONG = "marker,x,y,z"


def read(path: Path, name: str, times: list[str], columns: str) -> tuple[float, list[str]]:
    cells = "a,1,2,3" if columns == LONG else "1,2,3"
    rows = "".join(f"{time},{cells}\n" for time in times)
    path.write_text(f"{name},{columns}\n{rows}")
    method = "read.weights" if columns == WEIGHTS else "read.recording"
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rate = get_node(method)(path=path).rate
    return rate, [str(each.message) for each in caught if repr(name) in str(each.message)]


@pytest.mark.parametrize("columns", [POSITIONS, WEIGHTS, LONG])
@pytest.mark.parametrize(
    ("name", "scale", "unit"),
    [
        ("timestamp", 1, "s"),
        ("Timestamp", 1e3, "ms"),
        ("time stamps", 1e6, "us"),
        ("timestamp", 1e9, "ns"),
        ("timestamp_ms", 1e3, ""),
        ("timestampMs", 1e3, ""),
        ("timestamp (ns)", 1e9, ""),
        ("time_us", 1e6, ""),
        ("time", 1, ""),
    ],
)
def test_a_column_of_times(
    tmp_path: Path, columns: str, name: str, scale: float, unit: str
) -> None:
    start = 1_700_000_000  # seconds since 1970
    times = [f"{(start + frame / 25) * scale:.2f}" for frame in range(9)]
    rate, warned = read(tmp_path / "take.csv", name, times, columns)
    assert rate == 25
    expected = (
        f"the column {name!r} states no unit; {unit} is assumed, that is 25 frames per second"
    )
    assert warned == ([expected] if unit else [])


def test_stamps_of_no_usual_rate_do_not_count(tmp_path: Path) -> None:
    times = [f"{frame * 0.7}" for frame in range(9)]
    with pytest.raises(ValueError, match="no rate"):
        read(tmp_path / "take.csv", "timestamp", times, POSITIONS)


def test_times_in_seconds_that_look_like_milliseconds_are_warned_of(tmp_path: Path) -> None:
    times = [f"{frame * 40}" for frame in range(9)]
    rate, (warned,) = read(tmp_path / "take.csv", "time", times, POSITIONS)
    assert rate == 0.025
    assert warned.endswith(
        "s is assumed, that is 0.025 frames per second; if it is in ms, name it 'time (ms)'"
    )


def test_dates_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_text("# rate: 50\n# unit: mm\ntimestamp,a.x,a.y,a.z\n2026-01-02T03:04:05.06,1,2,3\n")
    with pytest.warns(UserWarning, match="1 columns are not coordinates.*: timestamp"):
        assert get_node("read.recording")(path=path).rate == 50


@pytest.mark.parametrize("name", ["frame", "Frame", "frames", "Frame #", "frame_number", "index"])
def test_columns_of_frame_numbers(name: str) -> None:
    assert is_frame(name)
    assert not is_time(name)


@pytest.mark.parametrize("name", ["Time (s)", "Time (Seconds)", "time_s", "time [ms]", "times"])
def test_columns_of_times(name: str) -> None:
    assert is_time(name)
    assert not is_frame(name)


@pytest.mark.parametrize(
    "name", ["framework", "x", "", "time (min)", "time of day", "timecode", "timestamp (min)"]
)
def test_other_columns(name: str) -> None:
    assert not is_frame(name)
    assert not is_time(name)
