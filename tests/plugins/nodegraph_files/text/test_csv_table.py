from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph_files import read_csv
from tests.plugins.nodegraph_files.conftest import Write

pytestmark = pytest.mark.filterwarnings("ignore:no unit of length")


@pytest.mark.parametrize("separator", [",", ";", "\t", ", "])
@pytest.mark.parametrize("form", ["{}.{}", "{}_{}", "{}:{}", "{} {}", "{}.{} (mm)", "{}.{} [mm]"])
@pytest.mark.parametrize("axes", ["XYZ", "xyz", "ZYX"])
def test_the_ways_to_name_columns(write: Write, separator: str, form: str, axes: str) -> None:
    names = [form.format(marker, axis) for marker in ("lip.l", "a_b") for axis in axes]
    numbers = {"x": (1, 4), "y": (2, 5), "z": (3, 6)}
    cells = [str(numbers[axis.lower()][marker]) for marker in range(2) for axis in axes]
    read = read_csv(write(f"# rate: 60\n{separator.join(names)}\n{separator.join(cells)}\n"))
    assert read.markers == ("lip.l", "a_b")
    assert read.positions.tolist() == [[[1, 2, 3], [4, 5, 6]]]
    assert read.rate == 60


def timed(name: str, *times: float) -> str:
    """Return a table of one marker, with a column of these times."""
    return f"{name},a.x,a.y,a.z\n" + "".join(f"{time},1,2,3\n" for time in times)


@pytest.mark.parametrize("comment", ["# rate: 59.94", "#Rate=59.94", "# rate: 59.94 Hz"])
def test_the_rate_of_a_comment(write: Write, comment: str) -> None:
    assert read_csv(write(f"a.x,a.y,a.z\n{comment}\n1,2,3\n")).rate == 59.94


def test_the_rate_of_a_time_column(write: Write) -> None:
    times = [frame / 60 for frame in range(50)]
    assert read_csv(write(timed("Time (s)", *times))).rate == 60
    with pytest.warns(UserWarning, match=r"lasts 0\.816667 s, by the line '# rate' 1\.63333 s"):
        assert read_csv(write(f"# rate: 30\n{timed('time', *times)}")).rate == 30


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1), ("m", 1000), ("cm", 10), ("inch", 25.4)])
def test_units_become_millimetres(write: Write, unit: str, factor: float) -> None:
    read = read_csv(write(f"# rate: 60\n# unit: {unit}\na.x,a.y,a.z\n1,2,3\n"))
    assert read.positions.tolist() == [[[factor, 2 * factor, 3 * factor]]]


@pytest.mark.parametrize("cell", ["", " ", "nan", "NaN", "NA", "null"])
def test_an_empty_cell_is_missing(write: Write, cell: str) -> None:
    read = read_csv(write(f"# rate: 60\na.x,a.y,a.z\n{cell},{cell},{cell}\n1,2,3\n"))
    assert read.present.tolist() == [[False], [True]]


def test_partly_missing_infinite_and_zero_samples_are_reported(write: Write) -> None:
    path = write("# rate: 60\n# unit: mm\na.x,a.y,a.z\n1,,3\n1,2,3\ninf,2,3\n0,0,0\n")
    with pytest.warns(UserWarning, match="count as missing") as caught:
        read = read_csv(path)
    assert len(caught) == 3
    assert read.present[:, 0].tolist() == [False, True, False, False]


@pytest.mark.parametrize("suffix", ["csv", "tsv", "txt", "dat"])
@pytest.mark.parametrize(
    "text",
    [
        "NO_OF_FRAMES\t1\nFREQUENCY\t60\nMARKER_NAMES\ta\n1\t2\t3\n",
        "Format Version,1.23,Export Frame Rate,60,Length Units,Millimeters\n\n"
        ",,Marker,Marker,Marker\n,,a,a,a\n,,1,1,1\n,,Position,Position,Position\nFrame,Time,X,Y,Z\n0,0,1,2,3\n",
        "Trajectories\n60\n,,a,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n1,0,1,2,3\n",
        "# rate: 60\nframe,marker,x,y,z\n0,a,1,2,3\n",
        "# rate: 60\n,a,a,a\n,x,y,z\n0,1,2,3\n",
        "# rate: 60\na.x,a.y,a.z\n1,2,3\n",
    ],
)
def test_the_content_tells_the_form_whatever_the_suffix(
    tmp_path: Path, suffix: str, text: str
) -> None:
    path = tmp_path / f"take.{suffix}"
    path.write_text(text)
    read = read_csv(path)
    assert (read.markers, read.rate) == (("a",), 60)
    assert read.positions.tolist() == [[[1, 2, 3]]]


@pytest.mark.parametrize("encoding", ["utf-16", "utf-8-sig"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_texts_of_other_systems(tmp_path: Path, encoding: str, end: str) -> None:
    path = tmp_path / "take.csv"
    path.write_bytes(end.join(["# rate: 60", "é.x,é.y,é.z", "1,2,3", ""]).encode(encoding))
    assert read_csv(path).positions.tolist() == [[[1, 2, 3]]]


def test_a_comment_may_stand_anywhere(write: Write) -> None:
    read = read_csv(write("a.x,a.y,a.z\n1,2,3\n# unit: m\n4,5,6\n# rate: 60"))
    assert read.positions.tolist() == [[[1000, 2000, 3000]], [[4000, 5000, 6000]]]


def test_a_row_of_nothing_but_gaps_is_a_frame(write: Write) -> None:
    read = read_csv(write("# rate: 60\na.x\ta.y\ta.z\n1\t2\t3\n\t\t\n4\t5\t6\n"))
    assert read.present[:, 0].tolist() == [True, False, True]


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_quotes_keep_separators_within_a_cell(write: Write, separator: str) -> None:
    names = [f'"a,;,;\t,;b.{axis}"' for axis in "xyz"]
    read = read_csv(
        write(f"# rate: 60\n{separator.join(names)}\n{separator.join(['1', '2', '3'])}")
    )
    assert read.markers == ("a,;,;\t,;b",)
    assert read.positions.tolist() == [[[1, 2, 3]]]


@pytest.mark.parametrize(
    ("text", "frames", "rate", "message"),
    [
        (
            "frame,a.x,a.y,a.z,note\n0,1,2,3,4\n# rate: 60",
            1, 60, "1 columns are not coordinates and were left out: note",
        ),
        ("# rate: 60\n,a.x,a.y,a.z\n0,1,2,3\n", 1, 60, "1 columns .* left out: column 1"),
        (
            timed("time", 0, 0.5, 1, 1.5, 2.2),
            5, 2, "not whole steps apart; by the median step .* 2 Hz",
        ),
        *(
            (
                f"# rate: 1\n{timed(column, 0, 1, 2, 5, 6, 7, 7, 8)}",
                8, 1, f"2 of 7 steps of the column '{column}' are irregular",
            )
            for column in ("frame", "time")
        ),
    ],
)  # fmt: skip
def test_what_is_odd_is_read_with_a_warning(
    write: Write, text: str, frames: int, rate: float, message: str
) -> None:
    with pytest.warns(UserWarning, match=message):
        read = read_csv(write(text))
    assert (read.frames, read.rate) == (frames, rate)


@pytest.mark.parametrize("last", ["4", "4,5"])
@pytest.mark.parametrize(
    "text", ["# rate: 60\na.x,a.y,a.z\n1,2,3\n", "time,marker,x,y,z\n0.0,nose,1,2,3\n"]
)
def test_a_last_line_within_which_the_file_ends_is_left_out(
    write: Write, text: str, last: str
) -> None:
    with pytest.warns(UserWarning, match="ends within line"):
        read = read_csv(write(text + last), rate=60)
    assert read.positions.tolist() == [[[1, 2, 3]]]


A = "a.x,a.y,a.z"
NO_RATE = ": no rate; set `rate` in Hz, or add a line '# rate: 60'"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", ": no frames: the file is empty"),
        ("\n \n", ": no frames: the file is empty"),
        (",,,\n", ": no frames: the file is empty"),
        ("# rate: 60\n", ": no frames: the file is empty or holds only comments"),
        (f"# rate: 60\n{A}\n", ": no frames follow line 2"),
        (
            "# rate: 60\nfoo,bar\n1,2\n",
            r":2: no columns NAME\.X, NAME\.Y, NAME\.Z; there is foo, b",
        ),
        ('"' + "1," * 100_000, r":1: no columns NAME\.X"),
        (f"# rate: 60\n{A}\n{',' * 1_000_000}\n", ":3: 1000001 cells, but 3 columns have names"),
        (f"# rate: 60\n{A}\n1,2,3\n1,2\n", ":4: 2 cells, but 3 columns"),
        (f"# rate: 60\n{A}\n1,2,3\n1,2,3,4\n", ":4: 4 cells, but 3 columns"),
        *(
            (
                f"# rate: 60\n\n{A}\n1,2,3\n1,{cell},3\n",
                r":5:2: '.*' is not a number \(column a\.y\)",
            )
            for cell in ("one", "1_000", "1e", "0x1", "#N/A", "1.2.3")
        ),
        (f'# rate: 60\n{A}\n1,"1,500.5",3\n', r":3:2: '1,500\.5' is not a number"),
        (f"{A}\n1,2,3\n", NO_RATE),
        (f"frame,{A}\n1,1,2,3\n", NO_RATE),
        (f"seconds,{A}\n1,1,2,3\n", NO_RATE),
        *(
            (f"# rate: {rate}\n{A}\n1,2,3\n", f":1: rate '{rate}' is not")
            for rate in ("0", "-1", "fast", "nan", "inf")
        ),
        (f"# rate: 60\n# unit: px\n{A}\n1,2,3\n", ":2: unit 'px'; there is um, mm, cm"),
        (
            "# rate: 60\n# unit: cm\na.x [mm],a.y,a.z\n1,2,3\n",
            ":2: unit 'cm'; the columns are in 'mm'",
        ),
        (f"# rate: 60\n{A},lip_x\n1,2,3,4\n", ":2: marker 'lip' has no column for Y, Z"),
        (f"# rate: 60\n{A},a.X\n1,2,3,4\n", r":2:4: the column 'a\.X' is there twice"),
        (f"# rate: 60\n{A},.x,.y,.z\n1,2,3,4,5,6\n", r":2:4: the column '\.x' names no marker"),
        ("# rate: 60\na.x,a.y,b.x,b.y\n1,2,3,4\n", ":2: 2 markers have X and Y and no Z"),
        (f"# rate: 60\n{A}\n1,5,2,5,3,5\n", ":3: 6 cells, but 3 columns have names"),
        ("# rate: 60\na.x;a.y;a.z\n1,500;2,250;3,125\n", r":3:1: '1,500' may be 1\.500 or 1500"),
        ("# rate: 60\na.x;a.y;a.z\n1,5;2;3;4,5\n", ":3: 4 cells, but 3 columns"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*left out. seconds")
def test_what_is_wrong_is_refused_with_its_place(write: Write, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=rf"take\.csv{message}"):
        read_csv(write(text))
