from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph_files import read_trc, trc_bytes
from nodegraph_files.text import table
from nodegraph_mocap import Trajectories
from tests.studies import DATA

REAL = DATA / "vicon" / "comma_separated_truncated.trc"
Write = Callable[..., Path]


def trc(
    rows: Sequence[str] = ("1 0.00 1 2 3 4 5 6", "2 0.01 7 8 9 10 11 12"),
    names: str = "Frame# Time lip   nose  ",
    axes: str = "  X1 Y1 Z1 X2 Y2 Z2",
    **facts: str | None,
) -> str:
    """Return a TRC file whose tabs are written as spaces; a fact that is None is left out."""
    defaults = {"DataRate": "100", "CameraRate": "100", "NumFrames": str(len(rows))}
    defaults |= {"NumMarkers": "2", "Units": "mm"}
    written = {key: value for key, value in {**defaults, **facts}.items() if value is not None}
    header = ["PathFileType 4 (X/Y/Z) it.trc", " ".join(written), " ".join(written.values())]
    return "\n".join([*header, names, axes, "", *rows, ""]).replace(" ", "\t")


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def written(text: str) -> Path:
        path = tmp_path / "take.trc"
        path.write_text(text, encoding="utf-8")
        return path

    return written


@pytest.mark.parametrize("separator", ["\t", ",", ", "])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\n\n"])
def test_what_stands_in_the_cells_is_read(write: Write, separator: str, end: str) -> None:
    read = read_trc(write(trc().replace("\t", separator).replace("\n", end)))
    assert read.markers == ("lip", "nose")
    assert read.positions.tolist() == [[[1, 2, 3], [4, 5, 6]], [[7, 8, 9], [10, 11, 12]]]
    assert read.rate == 100


@pytest.mark.parametrize(
    ("unit", "millimetres"),
    [("mm", 1), ("m", 1000), ("cm", 10), ("in", 25.4), ("Meters", 1000), ("inches", 25.4)],
)
def test_units_become_millimetres(write: Write, unit: str, millimetres: float) -> None:
    read = read_trc(write(trc(Units=unit)))
    np.testing.assert_allclose(read.positions[0, 0], np.array([1, 2, 3]) * millimetres)


@pytest.mark.parametrize(
    ("cell", "column"), [("one", 1), ("1_000", 2), ("0x1", 3), ("1,5,2", 8), ("#N/A", 3)]
)
def test_text_for_a_number_is_reported_with_its_place(write: Write, cell: str, column: int) -> None:
    row = ["2", "0.01", "7", "8", "9", "10", "11", "12"]
    row[column - 1] = cell
    with pytest.raises(ValueError, match=rf"take\.trc:8:{column}: '{cell}' is not a number"):
        read_trc(write(trc(["1 0.00 1 2 3 4 5 6", " ".join(row)])))


def test_a_lone_quote_above_the_frames_does_no_harm(
    write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(table, "_cell_by_cell", None)  # which would read them in any case
    read = read_trc(write(trc(names='Frame# Time "lip   nose  ')))
    assert (read.markers, read.frames) == (('"lip', "nose"), 2)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        *(
            ({"NumFrames": written}, f"says {said} frames, the file holds 2")
            for written, said in (("652", "652"), ("9" * 18, "9{18}"), ("-1", "-1"),
                                  ("many", "many"), ("", "no number of"))
        ),
        ({"NumMarkers": "0"}, "says 0 markers, the file holds 2"),
        ({"NumMarkers": "9" * 12}, "says 9{12} markers, the file holds 2"),
        ({"Units": None}, "no unit.*mm is assumed"),
        ({"Units": ""}, "no unit.*mm is assumed"),
        ({"Units": "px"}, "'px'.*mm is assumed"),
        ({"names": "Frame# Time lip nose"}, "names do not stand over X columns"),
        ({"names": "Frame# Time  lip  nose"}, "names do not stand over X columns"),
        ({"names": "Frame# Time lip   nose   chin  "}, "1 labels beyond the 2 markers .*: chin"),
        ({"axes": "1 0.00 1 2 3 4 5 6", "rows": ["2 0.01 7 8 9 10 11 12"]}, "no row X1, Y1, Z1"),
        ({"rows": ["1 0 1 2 3 4 5 6 7 8", "2 0.01 7 8 9 10 11 12 0 0"]}, "2 columns follow"),
    ],
)  # fmt: skip
def test_what_is_clear_is_read_with_a_warning(write: Write, changed: Any, message: str) -> None:
    with pytest.warns(UserWarning, match=message):
        read = read_trc(write(trc(**{"NumFrames": "2", **changed})))
    assert read.markers == ("lip", "nose")
    assert read.positions.tolist() == [[[1, 2, 3], [4, 5, 6]], [[7, 8, 9], [10, 11, 12]]]


@pytest.mark.parametrize(
    ("names", "markers"),
    [
        ("Frame# Time lip  ", ("lip", "unnamed_2")),
        ("Frame# Time lip   lip  ", ("lip", "lip_2")),
    ],
)
def test_labels_that_lack_or_repeat_get_their_own(
    write: Write, names: str, markers: tuple[str, ...]
) -> None:
    with pytest.warns(UserWarning, match="1 markers had no label, or another's"):
        assert read_trc(write(trc(names=names))).markers == markers


@pytest.mark.parametrize(
    ("rows", "present", "message"),
    [
        (("1 0.00    4 5 6", "2 0.01 7 8 9   "), [[False, True], [True, False]], ""),
        (("1 0.00      ", "2 0.01 7 8 9 1 2 3"), [[False, False], [True, True]], ""),
        (("1 0.00 1 2 3", "2 0.01 7 8 9 1 2 3"), [[True, False], [True, True]], "1 rows end bef"),
    ],
)
def test_empty_cells_and_those_that_a_row_lacks_are_missing(
    write: Write, rows: tuple[str, ...], present: list[list[bool]], message: str
) -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert read_trc(write(trc(rows))).present.tolist() == present
    assert [message in str(each.message) for each in caught] == [True] * bool(message)


@pytest.mark.filterwarnings("error")
def test_what_is_written_otherwise_means_the_same(write: Write, tmp_path: Path) -> None:
    plain = read_trc(write(trc()))
    for text in (trc(NumFrames="2.0", NumMarkers="2.0"), trc().rstrip("\n")):
        assert trc_bytes(read_trc(write(text))) == trc_bytes(plain)
    path = tmp_path / "utf-16.trc"
    path.write_bytes(trc().encode("utf-16"))
    assert trc_bytes(read_trc(path)) == trc_bytes(plain)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", ": no TRC file: it begins with ''"),
        ("a.x,a.y,a.z\n1,2,3\n", ": no TRC file: it begins with 'a.x,a.y,a.z'"),
        ("PathFileType 4\n", ":1: neither tabs nor commas"),
        ("PathFileType\t4\n\n\n\n\n\n", ": the header ends after 1 of 5 lines"),
        (trc([], NumFrames="652"), ": no frames .* NumFrames says 652"),
        (trc(names="Frame# Time lip nose chin"), ":4:4: the name 'nose' is out of place"),
        (trc(axes="  X1 Y1 Z1 X2 Z2 Y2"), ":5:7: 'Z2' where Y2 is expected"),
        (trc(axes="  X1 Y1 Z1 X2 Y2"), ":5: 5 columns X1, Y1, Z1, ... make no whole number"),
        (trc(axes="  X1 Y1 Z1  Y2 Z2"), ":5:6: '' where X2 is expected"),
        (trc(axes="1 0.00 1 2 3 4 5 6 7"), ":5: no columns X1, Y1, Z1, ... and 7 coordinates"),
        *(
            (trc(DataRate=rate), ": DataRate must be a positive number")
            for rate in (None, "", "0", "0.0", "-60", "nan", "inf", "fast", "1_0")
        ),
    ],
)
def test_what_is_wrong_is_refused_with_its_place(write: Write, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=rf"take\.trc{message}"):
        read_trc(write(text))


@pytest.mark.filterwarnings("error")
def test_headers_that_are_shifted_or_padded_by_tabs(write: Write) -> None:
    text = trc(axes="   X1 Y1 Z1 X2 Y2 Z2").replace(
        "100\t100\t2\t2\tmm", "100\t\t100\t\t2\t\t2\tmm"
    )
    assert read_trc(write(text)).markers == ("lip", "nose")


@pytest.mark.parametrize("end", ["", "\t"])
@pytest.mark.parametrize("more", [(3, 6), (0, 3), (3, 3), (6, 0)])
def test_trajectories_without_columns_in_the_header_are_left_out_and_counted(
    write: Write, end: str, more: tuple[int, int]
) -> None:
    named = ["1 0.00 1 2 3 4 5 6", "2 0.01 7 8 9 10 11 12"]
    rows = [row + " 77" * cells + end for row, cells in zip(named, more, strict=True)]
    with pytest.warns(UserWarning, match="columns follow the 8 that have names") as caught:
        read = read_trc(write(trc(rows)))
    assert f"{max(more)} columns" in str(caught[0].message)
    assert f"in {2 - more.count(0)} rows" in str(caught[0].message)
    assert read.positions.tolist() == [[[1, 2, 3], [4, 5, 6]], [[7, 8, 9], [10, 11, 12]]]


def test_trajectories_that_have_no_names_at_all_are_named_and_counted(write: Write) -> None:
    text = trc(
        ["1 0.00 1 2 3 ", "2 0.01 7 8 9 10 11 12 "],
        names="Frame# Time ",
        axes="  ",
        NumMarkers="0",
    )
    with pytest.warns(UserWarning, match=r"header|rows end|no label") as caught:
        read = read_trc(write(text))
    messages = " ".join(str(warning.message) for warning in caught)
    assert "no row X1, Y1, Z1" in messages
    assert "2 markers had no label" in messages
    assert read.markers == ("unnamed_1", "unnamed_2")
    assert read.present.tolist() == [[True, False], [True, True]]


def test_a_row_longer_than_the_columns_is_refused(write: Write) -> None:
    rows = ["1 0 1 2 3 4 5 6", "2 0.01 1 2 3 4 5 6 7"]
    with pytest.raises(ValueError, match=r"take\.trc:8: 9 cells, but 8 columns"):
        read_trc(write(trc(rows)))
    with pytest.raises(ValueError, match=r"take\.trc:7: 9 cells, but 8 columns"):
        read_trc(write(trc(list(reversed(rows))).replace("\t", ",")))
    assert read_trc(write(trc(["1 0 1 2 3 4 5 6  "]))).present.all()


@pytest.mark.parametrize(
    ("numbers", "uneven"), [((1, 2, 4), 1), ((1, 1, 2), 1), ((3, 2, 1), 2), ((90, 91, 92), 0)]
)
@pytest.mark.filterwarnings("error")
def test_frame_numbers_that_skip_are_reported(
    write: Write, numbers: tuple[int, ...], uneven: int
) -> None:
    rows = [f"{number} {row / 100} 1 2 3 4 5 6" for row, number in enumerate(numbers)]
    path = write(trc(rows))
    if uneven:
        with pytest.warns(UserWarning, match=f"{uneven} of 2 steps of Frame# are not 1"):
            assert read_trc(path).frames == 3
    else:
        assert read_trc(path).frames == 3


def test_times_that_contradict_the_rate_are_reported(write: Write) -> None:
    rows = [f"{frame} {frame / 60:.2f} 1 2 3 4 5 6" for frame in range(300)]
    assert read_trc(write(trc(rows, DataRate="60"))).rate == 60
    with pytest.warns(UserWarning, match=r"lasts 4\.98 s, by DataRate 2\.99 s; DataRate counts"):
        assert read_trc(write(trc(rows, DataRate="100"))).rate == 100


def test_what_is_written_is_the_form_that_others_read(gappy: Trajectories) -> None:
    lines = [line.split("\t") for line in trc_bytes(gappy).decode().split("\n")]
    facts = dict(zip(lines[1], lines[2], strict=True))
    assert lines[0][:3] == ["PathFileType", "4", "(X/Y/Z)"]
    assert (facts["DataRate"], facts["NumFrames"], facts["NumMarkers"]) == ("59.94", "6", "3")
    assert facts["Units"] == "mm"
    assert lines[3] == ["Frame#", "Time", "a", "", "", "b c", "", "", "é", "", ""]
    assert lines[4] == ["", "", "X1", "Y1", "Z1", "X2", "Y2", "Z2", "X3", "Y3", "Z3"]
    assert lines[5] == [""]
    assert [row[0] for row in lines[6:12]] == ["1", "2", "3", "4", "5", "6"]
    assert lines[8][5:8] == ["", "", ""]
    assert float(lines[7][1]) == pytest.approx(1 / 59.94)
    assert float(lines[7][4]) == gappy.positions[1, 0, 2]


@pytest.mark.skipif(not REAL.is_file(), reason="the recordings are not here")
def test_a_real_file_with_commas_that_was_cut_short() -> None:
    with pytest.warns(UserWarning, match="the header says 652 frames, the file holds 93") as caught:
        read = read_trc(REAL)
    assert len(caught) == 1
    rows = [line.split(",") for line in REAL.read_text().splitlines()]
    assert read.positions.shape == (93, 51, 3)
    assert read.rate == 100
    assert read.markers == tuple(cell for cell in rows[3][2:] if cell)
    one_by_one = [[float(cell or "nan") for cell in row[2:]] for row in rows[-93:]]
    there = read.present
    np.testing.assert_array_equal(read.positions[there], np.reshape(one_by_one, (93, 51, 3))[there])
    assert there.sum() > 0.9 * there.size
