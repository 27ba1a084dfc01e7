"""Recordings as Maya ASCII scenes."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
import pytest

from nodegraph_files.readers import read_recording

HEAD = (
    '//Maya ASCII 2017ff05 scene\n//Name: a; "b.ma\nrequires maya "2017";\n'
    "currentUnit -l {length} -a degree -t {time};\n"
    'createNode transform -n "Take";\n'
    'createNode transform -n "chin" -p "Take";\n\tsetAttr ".note" -type "string" "a; \\"b\\"";\n'
)


def curve(name: str, keys: dict[float, float], kind: str = "animCurveTL") -> str:
    """A curve as Maya writes it, its keys in two statements of several lines."""
    parts, text = list(keys.items()), f'createNode {kind} -n "{name}";\n\tsetAttr ".tan" 18;\n'
    text += f'\tsetAttr -s {len(keys)} ".ktv";\n'
    for start, some in ((0, parts[:2]), (2, parts[2:])):
        if some:
            last = f":{start + len(some) - 1}" if len(some) > 1 else ""
            numbers = "\n\t\t".join(f" {time} {value}" for time, value in some)
            text += f'\tsetAttr ".ktv[{start}{last}]" {numbers};\n'
    return text


def marker(name: str, *keys: dict[float, float], attributes: str = "xyz") -> str:
    axes = dict(zip(attributes, keys, strict=True))
    curves = "".join(curve(f"{name}_t{axis}", its) for axis, its in axes.items())
    return curves + "".join(f'connectAttr "{name}_t{a}.o" "{name}.t{a}";\n' for a in axes)


KEYS = {0.0: 1.5, 0.4: 2.0, 0.8: -3.25, 1.2: 4e-1}
MOVES = {time: value + 1 for time, value in KEYS.items()}


def written(folder: Path, body: str, length: str = "centimeter", time: str = "film") -> Path:
    path = folder / "take.ma"
    path.write_text(HEAD.format(length=length, time=time) + body)
    return path


def test_the_keys_of_three_curves_are_a_marker(tmp_path: Path) -> None:
    path = written(tmp_path, marker("chin", KEYS, MOVES, {0.0: 7.0}) + marker("nose", *[KEYS] * 3))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        recording = read_recording(path=path)
    assert not [each for each in caught if "span" not in str(each.message)]
    assert recording.markers == ("chin", "nose")
    assert recording.rate == 60.0
    values = 10.0 * np.array(list(KEYS.values()))
    expected = np.stack([values, values + 10.0, np.full(4, 70.0)], axis=1)
    np.testing.assert_allclose(recording.positions[:, 0], expected)
    np.testing.assert_allclose(recording.positions[:, 1], values[:, None] * np.ones(3))


@pytest.mark.parametrize(
    ("time", "rate"), [("ntscf", 150.0), ("100fps", 250.0), ("29.97fps", 74.925), ("sec", 2.5)]
)
def test_times_are_in_the_unit_of_the_scene(tmp_path: Path, time: str, rate: float) -> None:
    path = written(tmp_path, marker("chin", *[KEYS] * 3), length="mm", time=time)
    recording = read_recording(path=path)
    assert recording.rate == pytest.approx(rate)
    assert recording.positions[0, 0, 0] == 1.5


LACKING = {0.0: 1.0, 0.4: 2.0, 1.2: 3.0}


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (marker("cheek", KEYS, MOVES, LACKING), "1 samples lack a coordinate"),
        (curve("spin", KEYS, "animCurveTA"), "1 curves translate no marker"),
        (curve("loose", KEYS), "1 curves translate no marker"),
        (
            'createNode transform -n "Take";\nsetAttr ".t" -type "double3" 1 0 0 ;\n',
            "markers are in a group that is moved",
        ),
        ('file -r -ns "head" "head.ma";\n', "1 references to other files are not followed"),
    ],
)
def test_what_is_left_out_is_counted(tmp_path: Path, body: str, message: str) -> None:
    path = written(tmp_path, body + marker("nose", *[KEYS] * 3) + marker("chin", *[KEYS] * 3))
    with pytest.warns(UserWarning, match=re.escape(message)):
        recording = read_recording(path=path)
    if "lack" in message:
        np.testing.assert_array_equal(recording.present[:, 0], [True, True, False, True])


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("", "no node that animation curves translate in x, y and z"),
        ("createNode animCurveTA -n a;\n", "1 other curves, from line 8 on"),
        ('\nfile -r "other.ma";\n', "1 references to other files, from line 9 on"),
        (marker("chin", KEYS, MOVES, attributes="xy"), "no node that animation curves translate"),
        (marker("chin", *[{0.0: 1.0, 0.4: 2.0, 0.9: 3.0}] * 3), "line 8: a key at"),
        (marker("chin", *[{0.0: 1.0, 0.4: 2.0, 0.2: 3.0}] * 3), "line 8: the times"),
        (marker("chin", *[{0.0: 1.0, 1.0: 2.0, 1e9: 3.0}] * 3), "an animation by hand"),
        (marker("chin", *[KEYS] * 3).replace("2.0", "two"), "line 11: a key that is no number"),
        (marker("chin", *[KEYS] * 3).replace(" 2.0", ""), "line 11: 3 numbers for a time and"),
        ('setAttr ".a" "open;\n', "line 8: a statement begins here and does not end"),
    ],
)
def test_a_scene_that_is_no_recording_is_refused_with_the_line(
    tmp_path: Path, body: str, message: str
) -> None:
    with pytest.raises(ValueError, match=re.escape(message)) as caught:
        read_recording(path=written(tmp_path, body))
    assert "take.ma" in str(caught.value)


def test_an_unknown_unit_of_time_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="unit of time 'fortnight' is unknown"):
        read_recording(path=written(tmp_path, marker("chin", *[KEYS] * 3), time="fortnight"))
