from __future__ import annotations

import pytest

from nodegraph_files.text.table import filled_width, read_table
from tests.plugins.nodegraph_files.conftest import Write


def test_the_first_line_with_a_separator_tells_it(write: Write) -> None:
    table = read_table(write("Trajectories\n\n# note: a,b\na;b\n1,5;2,5\n"))
    assert table.separator == ";"
    assert [row.cells for row in table.opening] == [["Trajectories"], ["a", "b"], ["1,5", "2,5"]]
    assert [row.line for row in table.opening] == [1, 4, 5]
    assert table.comments["note"] == ("a,b", 3)


def test_the_rows_below_begin_right_after_the_header(write: Write) -> None:
    table = read_table(write("a,b\n,\n1,2\n"))
    header = table.opening[0]
    assert [line.number for line in table.below(header, 2, [0, 1]).lines()] == [2, 3]
    assert [line.number for line in table.below(header, 2, [0, 1], lenient=True).lines()] == [3]


def test_a_place_counts_columns_from_one(write: Write) -> None:
    table = read_table(write("\na,b\n"))
    assert table.place(table.opening[0], 1) == f"{table.path}:2:2"


@pytest.mark.parametrize("text", ["", "\n\n", "# only: this\n", ",,,\n"])
def test_a_table_without_a_row_is_refused(write: Write, text: str) -> None:
    with pytest.raises(ValueError, match=r"take\.csv: no frames: the file is empty"):
        read_table(write(text))


def test_empty_cells_at_the_end_do_not_count() -> None:
    assert [filled_width(cells) for cells in (["", "a", ""], ["", ""], [])] == [2, 0, 0]
