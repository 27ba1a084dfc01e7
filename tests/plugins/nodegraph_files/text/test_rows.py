from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_files.text import table as reading
from nodegraph_files.text.table import Rows, filled, read_rows
from nodegraph_files.text.text_file import TextFile

PATH = Path("take.csv")


def rows(text: str, width: int = 3, *, separator: str = ",", lenient: bool = False) -> Rows:
    return Rows(
        text=TextFile(PATH, text.encode()),
        start=0,
        line=1,
        separator=separator,
        width=width,
        wanted=range(width),
        lenient=lenient,
    )


def slowly(reader: Rows) -> object:
    """Return what reading cell by cell gives: numbers, or the message."""
    try:
        return reading._cell_by_cell(reader)
    except ValueError as error:
        return str(error)


CELLS = st.one_of(
    st.floats().map(repr),
    st.sampled_from(["", " ", "nan", "NaN", "NA", "null", "NULL", "nUll", "+5", " 5 ", "1e400"]),
    st.sampled_from(
        ["1_0", "0x1", "1.2.3", "--1", "#", "True", "1 2", "1'000", ".", "-", "1e", "٣"]
    ),
    st.text("0123456789+-.eEinfaN_xX\x00 ", max_size=5),
)


@given(st.lists(st.lists(CELLS, min_size=1, max_size=4), min_size=1, max_size=4), st.data())
def test_the_fast_way_reads_what_the_slow_one_does(
    table: list[list[str]], data: st.DataObject
) -> None:
    width = data.draw(st.sampled_from([len(table[0]), 3]))
    lenient = data.draw(st.booleans())
    text = "\n".join(",".join(cells) for cells in table) + "\n"
    reader = rows(text, width, lenient=lenient)
    fast = reading._at_once(reader)
    if fast is not None:
        np.testing.assert_array_equal(fast, slowly(reader))


@given(st.lists(st.tuples(*[st.floats()] * 3), min_size=1, max_size=20))
def test_every_number_reads_back_equal(numbers: list[tuple[float, ...]]) -> None:
    text = "".join(",".join(map(repr, row)) + "\n" for row in numbers)
    fast = reading._at_once(rows(text))
    np.testing.assert_array_equal(fast, numbers)


def test_a_table_of_plain_numbers_is_read_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading, "_cell_by_cell", None)
    assert read_rows(rows("1,2,3\n\n4,,6\n7,8,\n")).shape == (3, 3)
    for beyond in ("", "nan", "NULL\t"):
        wider = rows(f"1\t2\t3\t{beyond}\n", separator="\t", lenient=True)
        assert read_rows(wider).tolist() == [[1, 2, 3]]


@pytest.mark.parametrize("change", ["long", "short", "both", "text"])
def test_a_large_file_is_no_less_checked(tmp_path: Path, change: str) -> None:
    """Pandas reads it in parts, side by side, and fills rows that are too short."""
    path = tmp_path / "take.csv"
    lines = ["1.25,2.5,-3.125,4,5,6,7,8,9"] * 20_000
    chance = random.Random(change)
    for _ in range(3):
        wrong = list(lines)
        first, second = sorted(chance.sample(range(1, len(lines)), 2))
        if change in ("long", "both"):
            wrong[first] += ",10"
        if change in ("short", "both"):
            wrong[second] = wrong[second].removesuffix(",9")
        if change == "text":
            wrong[first] = wrong[first].replace("4", "four")
        path.write_text("\n".join(wrong))
        place = (second if change == "short" else first) + 1
        reader = Rows(
            text=TextFile(path, path.read_bytes(), plain=True),
            start=0, line=1, separator=",", width=9, wanted=range(9),
        )  # fmt: skip
        with pytest.raises(ValueError, match=rf"take\.csv:{place}:"):
            read_rows(reader)


@pytest.mark.parametrize("text", ["1,x,3\n4,y,6\n", "1,x,3\n4,,6\n", '1,"a,b",3\n4,c,6\n'])
def test_columns_that_are_not_wanted_may_hold_anything(text: str) -> None:
    reader = rows(text)
    some = Rows(**{**vars(reader), "wanted": (0, 2)})
    assert read_rows(some).tolist() == [[1, 3], [4, 6]]


@pytest.mark.parametrize(("text", "line"), [("1,x,3\n4,y,6,7\n", 2), ("1,x,3\n4,y\n", 2)])
def test_rows_are_of_one_length_even_if_not_all_columns_are_wanted(text: str, line: int) -> None:
    some = Rows(**{**vars(rows(text)), "wanted": (0, 1)})
    with pytest.raises(ValueError, match=rf"take\.csv:{line}: \d cells, but 3 columns have names"):
        read_rows(some)


def test_a_lenient_table_may_end_early_and_have_empty_cells_beyond() -> None:
    with pytest.warns(UserWarning, match="1 rows end before the last of 3 columns.* line 2"):
        read = read_rows(rows("1,2,3,,\n4,5\n6,7,8\n", lenient=True))
    np.testing.assert_array_equal(read, [[1, 2, 3], [4, 5, np.nan], [6, 7, 8]])
    with pytest.raises(ValueError, match=r"take\.csv:1: 4 cells, but 3 columns"):
        read_rows(rows("1,2,3,4\n", lenient=True))


def test_a_number_in_which_the_file_ends_is_not_believed() -> None:
    with pytest.warns(UserWarning, match="1 rows end before"):
        read = read_rows(rows("1,2,3\n4,5.2", lenient=True))
    np.testing.assert_array_equal(read[1], [4, np.nan, np.nan])


def test_decimal_commas_are_read_with_a_warning() -> None:
    with pytest.warns(UserWarning, match=r"commas count as decimal points, in 2 cells.*'1,5'"):
        read = read_rows(rows("1,5;2;3\n4;,25;6\n", separator=";"))
    assert read.tolist() == [[1.5, 2, 3], [4, 0.25, 6]]


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        ("1,500;2;3", r"1:1: '1,500' may be 1\.500 or 1500"),
        ("1,5;2.5;3", r"1:2: '2\.5' has a dot, but '1,5' \(take\.csv:1:1\) a comma"),
        ("1.000,5;2;3", r"1:1: '1\.000,5' is not a number"),
        ("1,000,000;2;3", r"1:1: '1,000,000' is not a number"),
        ("1 000,5;2;3", r"1:1: '1 000,5' is not a number"),
        ("1'000;2;3", r"1:1: \"1'000\" is not a number"),
        ("2;1.000.000;3", r"1:2: '1\.000\.000' is not a number"),
    ],
)
def test_commas_and_dots_that_may_mean_two_things_are_refused(cells: str, message: str) -> None:
    with pytest.raises(ValueError, match=rf"take\.csv:{message}"):
        read_rows(rows(f"{cells}\n", separator=";"))


def test_very_wide_tables_are_read() -> None:
    numbers = np.arange(20_000.0)
    text = ",".join(map(repr, numbers.tolist())) + "\n"
    np.testing.assert_array_equal(read_rows(rows(text, len(numbers))), [numbers])


def test_rows_of_nothing_are_no_frames() -> None:
    table = np.array([[1, np.nan], [np.nan, np.nan], [np.nan, 2]])
    np.testing.assert_array_equal(filled(table), table[[0, 2]])
    assert filled(table[:1]) is not None
