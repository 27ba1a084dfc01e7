"""Tables as HTML, text, CSV and LaTeX."""

from __future__ import annotations

import csv
import re
from dataclasses import replace
from html.parser import HTMLParser
from io import StringIO

import numpy as np
import pandas as pd
import pytest

from nodegraph_tables.cells import columns_of, shown
from nodegraph_tables.info import Part, TableInfo, with_info
from nodegraph_tables.rendering import render_table

UGLY = '<b>&amp; "it\'s" 100 % #1_$x^2 {~} \\ [mm] *12'


def table(**columns: object) -> pd.DataFrame:
    return pd.DataFrame(columns)


class Page(HTMLParser):
    """Collects rows, texts and what is open, so that a fragment can be seen to be whole."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.classes: list[list[str | None]] = []
        self.tags: list[str] = []
        self.open: list[str] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if tag in ("wbr", "br"):  # have no end
            return
        self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
            self.classes.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self.classes[-1].append(dict(attrs).get("class"))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if {"td", "th"} & set(self.open):
            self.rows[-1][-1] += data


def test_shares_are_read_in_percent_and_exported_as_they_are() -> None:
    errors = table(
        share=[0.02, 0.1], fill=["a", "b"], missed=[0.07, 0.005], low=[0.06, 0.001], high=[0.5, 0.2]
    )
    info = TableInfo(
        labels=("share", "fill"),
        units={"share": "share", "missed": "share"},
        cells={"missed": {"low": "low", "high": "high"}},
    )
    rendered = render_table(with_info(errors, info), "Shares")
    lines = [line.split() for line in rendered.text.splitlines()]
    assert lines == [
        ["share", "[%]", "fill", "missed", "[%]"],
        ["2", "a", "7.000", "[6.000,", "50.000]"],
        ["10", "b", "0.500", "[0.100,", "20.000]"],
    ]
    assert ["2", "a", "7.000 [6.000, 50.000]"] in Page(rendered.html).rows
    assert "Percentages are shares in the CSV file" in rendered.html
    assert "0.02,a,0.07,0.06,0.5" in rendered.files[".csv"].decode()


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.23456, "1.235"),
        (12.3456, "12.35"),
        (123.456, "123.5"),
        (1234.56, "1235"),
        (0.123456, "0.1235"),
        (0.0123456, "0.0123"),
        (-0.5, "-0.5000"),
        (1e-5, "1.00e-05"),
        (2.5e9, "2.50e+09"),
        (0.0, "0"),
        (12.0, "12"),
        (7, "7"),
        (123_456_789, "123456789"),
        (True, "yes"),
        (False, "no"),
        ("text", "text"),
        (None, ""),
        (float("nan"), ""),
        (pd.NA, ""),
        (pd.NaT, ""),
        (float("inf"), "inf"),
        (np.float64(1.23456), "1.235"),
    ],
)
def test_a_cell_is_shown_with_the_digits_that_count(value: object, text: str) -> None:
    assert shown(value) == text


def test_what_came_from_users_is_escaped_everywhere() -> None:
    frame = table(**{UGLY: [UGLY]})
    frame = with_info(frame, TableInfo(title=UGLY, notes=(UGLY,), units={UGLY: "<mm>"}))
    rendered = render_table(frame, "unused")
    page = Page(rendered.html)
    assert page.rows == [[f"{UGLY} [<mm>]"], [UGLY]]
    assert not page.open
    assert set(page.tags) <= {
        "figure", "div", "table", "caption", "thead", "tbody", "tr", "th", "td", "template", "ul",
        "li", "span", "wbr",
    }  # fmt: skip
    latex = rendered.files[".tex"].decode()
    body = latex[latex.index(r"\caption") :]
    for plain in ("&", "%", "$", "#", "_", "^", "~"):
        assert not re.search(rf"(?<!\\){re.escape(plain)}", body), plain
    assert "<" not in body
    assert not re.search(r"\\\\\s*[\[*]", body)


def test_numbers_stand_right_and_have_their_unit() -> None:
    frame = table(method=["a", "bb"], rmse=[1.23456, 22.0], count=[1, 20])
    frame = with_info(frame, TableInfo(units={"rmse": "mm"}))
    rendered = render_table(frame, "Errors")
    page = Page(rendered.html)
    assert page.rows == [
        ["method", "rmse [mm]", "count"], ["a", "1.23", "1"], ["bb", "22.00", "20"],
    ]  # fmt: skip
    head, *rows = page.classes
    assert head == ["name", "number", "number"]
    assert rows == [["name short", "number", "number"]] * 2
    assert "<caption>Errors</caption>" in rendered.html
    assert rendered.text.splitlines() == [
        "method  rmse [mm]  count",
        "a            1.23      1",
        "bb          22.00     20",
    ]
    assert r"\begin{tabular}{lrr}" in rendered.files[".tex"].decode()


def test_the_star_of_the_best_is_explained_where_there_is_one() -> None:
    frame = table(fill=["a", "b"], mean=[0.5, 1.5])
    assert "*" not in render_table(frame, "t").text
    frame = with_info(frame, TableInfo(best={"mean": (0,)}))
    assert render_table(frame, "t").text.splitlines()[1:] == [
        "a     0.500*",
        "b      1.500",
        "* the best of its group",
    ]


def test_texts_that_a_spreadsheet_would_compute_are_guarded_in_the_csv_file() -> None:
    texts = ["=1+1", "+x", "-x", "@sum", "-1.5", "a=b", None]
    frame = pd.DataFrame({"=name": texts, "value": range(-3, 4)})
    rows = list(csv.reader(StringIO(render_table(frame, "t").files[".csv"].decode())))
    assert rows[0] == ["'=name", "value"]
    assert [row[0] for row in rows[1:]] == ["'=1+1", "'+x", "'-x", "'@sum", "-1.5", "a=b", ""]
    assert rows[1][1] == "-3"


def test_the_csv_file_has_every_digit() -> None:
    frame = table(name=["a,b", "c\nd"], value=[0.1 + 0.2, float("nan")], whole=[1, 2])
    text = render_table(frame, "t").files[".csv"].decode()
    assert list(csv.reader(StringIO(text))) == [
        ["name", "value", "whole"],
        ["a,b", "0.30000000000000004", "1"],
        ["c\nd", "", "2"],
    ]


def rest(html: str) -> list[int]:
    """Return the rows that a folded table leaves out."""
    return [at for at, row in enumerate(re.findall("<tr[^>]*>", html)[1:]) if "rest" in row]


@pytest.mark.parametrize(("rows", "left_out"), [(14, []), (15, [14])])
def test_a_long_table_is_folded_but_whole(rows: int, left_out: list[int]) -> None:
    rendered = render_table(table(a=range(rows)), "t")
    assert len(Page(rendered.html).rows) == rows + 1
    assert rest(rendered.html) == left_out
    assert ('class="table folded"' in rendered.html) == bool(left_out)


def test_a_folded_table_shows_the_marked_rows_of_each_group() -> None:
    frame = table(length=["a"] * 10 + ["b"] * 10, fill=list("abcdefghij") * 2, x=np.arange(20.0))
    info = TableInfo(
        labels=("length", "fill"), best={"x": (0,)}, tied={"x": (1, 2)}, highlights=(7,)
    )
    html = render_table(with_info(frame, replace(info, compared="fill")), "t").html
    assert rest(html) == [3, 4, 5, 6, 8, 9, *range(13, 20)]
    rows = re.findall("<tr([^>]*)>", html)[1:]
    assert [at for at, row in enumerate(rows) if "tied" in row] == [0, 1, 2]
    assert rows[10] == ' class="group" data-method="a"'


def test_a_page_holds_so_many_rows_and_says_so() -> None:
    rendered = render_table(table(a=range(5_001)), "t")
    assert len(Page(rendered.html).rows) == 5_001
    assert "The first 5000 of 5001 rows; the CSV file has all." in rendered.html
    assert "4801 more rows in the CSV file" in rendered.text
    assert rendered.files[".csv"].count(b"\n") == 5_002


def test_numbers_that_are_the_same_throughout_are_stated_once() -> None:
    frame = table(fill=["a", "b"], x=[0.5, 1.5], refused=[0, 0], lost=[0.0, 0.0], n=[np.nan] * 2)
    rendered = render_table(frame, "t")
    assert Page(rendered.html).rows == [["fill", "x"], ["a", "0.500"], ["b", "1.500"]]
    for text in (rendered.html, rendered.text, rendered.files[".tex"].decode()):
        assert "refused, lost are 0; n is empty throughout." in text
    assert r"\caption{t. refused, lost are 0;" in rendered.files[".tex"].decode()
    assert rendered.files[".csv"].startswith(b"fill,x,refused,lost,n\na,0.5,0,0.0,\n")
    assert Page(render_table(frame.iloc[:1], "t").html).rows[0] == list(frame.columns)
    assert Page(render_table(frame[["fill", "lost"]], "t").html).rows[0] == ["fill", "lost"]


def test_names_of_rows_become_columns() -> None:
    frame = table(a=[1, 2]).set_index(pd.Index(["x", "y"], name="method"))
    frame = with_info(frame, TableInfo(title="Kept"))
    rendered = render_table(frame, "t")
    assert Page(rendered.html).rows == [["method", "a"], ["x", "1"], ["y", "2"]]
    assert rendered.files[".csv"] == b"method,a\nx,1\ny,2\n"
    assert "Kept" in rendered.html


def test_an_interval_and_a_p_stand_in_the_cell_of_their_mean_and_the_best_is_marked() -> None:
    table = pd.DataFrame(
        {
            "marker": ["a", "b"],
            "x": [0.5, 2.0],
            "x low": [0.25, np.nan],
            "x high": [0.75, np.nan],
            "x p": [0.01, 0.5],
        }
    )
    cells: dict[str, dict[Part, str]] = {"x": {"low": "x low", "high": "x high", "p": "x p"}}
    table = with_info(table, TableInfo(best={"x": (0,)}, cells=cells))
    rendered = render_table(table, "t")
    assert "<strong>0.500</strong> <br><small>[0.250, 0.750] \N{DAGGER}</small>" in rendered.html
    assert '<td class="number">2.000</td>' in rendered.html
    assert rendered.text.splitlines()[1].split() == [
        "a",
        "0.500",
        "[0.250,",
        "0.750]",
        "\N{DAGGER}*",
    ]
    assert r"\textbf{0.500} & {[}0.250, 0.750] \textdagger{}" in rendered.files[".tex"].decode()
    assert Page(rendered.html).rows[0] == ["marker", "x"]
    assert rendered.files[".csv"].decode().splitlines()[:2] == [
        "marker,x,x low,x high,x p",
        "a,0.5,0.25,0.75,0.01",
    ]


def test_points_meet_tiny_numbers_have_a_power_of_ten_and_what_is_left_by_rounding_is_zero() -> (
    None
):
    table = pd.DataFrame(
        {
            "small": [0.0359, 1.134, 0.0],
            "wide": [213.0, 30.0, 3.5e-10],
            "rounded": [213.0, 30.5, 3.5e-31],
            "whole": [2.0, 5.0, 1e5],
        }
    )
    columns = {column.name: [str(cell) for cell in column.cells] for column in columns_of(table)}
    assert columns == {
        "small": ["0.0359", "1.1340", "0"],
        "wide": ["213.0", "30.0", "3.50e-10"],
        "rounded": ["213.0", "30.5", "0"],
        "whole": ["2", "5", "100000"],
    }


def test_labels_stand_as_the_graph_has_them_head_their_rows_and_part_the_groups() -> None:
    table = pd.DataFrame({"share": [0.02, 0.02, 0.1], "method": ["a", "b", "a"], "x": [1.5, 2, 3]})
    table = with_info(table, TableInfo(labels=("share", "method"), units={"x": "mm^2"}))
    html = render_table(table, "t").html
    assert html.count('<th scope="row" class="number">0.02</th>') == 2
    assert '<tr class="group"><th scope="row" class="number">0.1</th>' in html
    assert html.count('class="group"') == 1
    assert '<th scope="row" class="name short">b</th>' in html
    assert '<span class="unit"> [mm\N{SUPERSCRIPT TWO}]</span>' in html
    latex = render_table(table, "t").files[".tex"].decode()
    assert r"\shortstack[r]{x\\{[}mm\textsuperscript{2}]}" in latex


def test_what_is_not_finite_is_said_and_what_is_missing_left_empty() -> None:
    table = pd.DataFrame({"x": [np.inf, -np.inf, np.nan, 0.5], "y": [np.nan] * 4})
    x, y = columns_of(table)
    assert [str(cell) for cell in x.cells] == ["inf", "-inf", "", "0.500"]
    assert [str(cell) for cell in y.cells] == [""] * 4


def test_a_small_p_is_shown_as_below_what_can_be_said() -> None:
    table = pd.DataFrame({"method": ["a", "b", "c"], "p": [1.46e-104, 0.0312, np.nan]})
    rendered = render_table(with_info(table, TableInfo(units={"p": "chance"})), "tests")
    assert "< 0.0001" in rendered.text
    assert "&lt; 0.0001" in rendered.html.partition("<template")[0]
    assert r"\textless{} 0.0001" in rendered.files[".tex"].decode()
    assert "1.46e-104" in rendered.files[".csv"].decode()
    assert "e-104" not in rendered.text + rendered.files[".tex"].decode()
    assert "0.0312" in rendered.text
