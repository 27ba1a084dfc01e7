from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_files.text.table import cell_numbers, separator_of, split_cells, text_lines

PATH = Path("take.txt")


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_whatever_ends_them(tmp_path: Path, end: str) -> None:
    path = tmp_path / "take.txt"
    path.write_bytes(f"\ufeffa{end}{end}é".encode())
    assert text_lines(path) == ["a", "", "é"]


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_the_separator_is_the_most_frequent_one(separator: str) -> None:
    assert separator_of(separator.join(["a b", "c.x", '"d,;,;\t,;"', "e"])) == separator


def test_quotes_keep_separators_within_a_cell() -> None:
    assert split_cells('"a,b",1, "2"', ",") == ["a,b", "1", "2"]


def test_a_cell_without_an_end_stays_whole() -> None:
    line = '"' + "1," * 100_000
    assert split_cells(line, ",") == line.split(",")


@given(st.lists(st.floats(allow_nan=False)))
def test_numbers_read_back_equal(numbers: list[float]) -> None:
    assert cell_numbers(PATH, 1, [repr(number) for number in numbers]) == numbers


@pytest.mark.parametrize("cell", ["", " ", "nan", "NaN", "NA", "null"])
def test_what_is_missing(cell: str) -> None:
    assert np.isnan(cell_numbers(PATH, 1, ["1", cell])).tolist() == [False, True]


@pytest.mark.parametrize("cell", ["one", "1_000", "1e", "0x1"])
def test_text_is_reported_with_its_place(cell: str) -> None:
    with pytest.raises(ValueError, match=rf"take\.txt:7:2: '{cell}' is not a number"):
        cell_numbers(PATH, 7, ["1", cell])
    with pytest.raises(ValueError, match=r"take\.txt:7:4: "):
        cell_numbers(PATH, 7, ["1", "", cell], columns=(2, 3, 4))
