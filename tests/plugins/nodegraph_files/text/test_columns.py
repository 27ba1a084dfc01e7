from __future__ import annotations

import pytest

from nodegraph_files.text.csv import is_frame, seconds_in


@pytest.mark.parametrize("name", ["frame", "Frame", "frames", "Frame #", "frame_number", "index"])
def test_columns_of_frame_numbers(name: str) -> None:
    assert is_frame(name)


@pytest.mark.parametrize("name", ["framework", "time", "x", ""])
def test_other_columns(name: str) -> None:
    assert not is_frame(name)


@pytest.mark.parametrize(
    ("name", "seconds"),
    [
        ("time", 1),
        ("Time (s)", 1),
        ("Time (Seconds)", 1),
        ("time_s", 1),
        ("time [ms]", 0.001),
        ("time_ms", 0.001),
        ("time (min)", None),
        ("time of day", None),
        ("timecode", None),
        ("frame", None),
    ],
)
def test_the_unit_of_times(name: str, seconds: float | None) -> None:
    assert seconds_in(name) == seconds
