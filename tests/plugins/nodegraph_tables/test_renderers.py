from __future__ import annotations

import csv
import re
import xml.etree.ElementTree as ET
from html.parser import HTMLParser
from io import StringIO
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from nodegraph_tables.cells import shown
from nodegraph_tables.renderers import render_figure, render_table, renderers

UGLY = '<b>&amp; "it\'s" 100 % #1_$x^2 {~} \\ [mm] *12'


def table(**columns: Any) -> pd.DataFrame:
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
        if tag == "wbr":  # has no end
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
        (True, "True"),
        ("text", "text"),
        (None, ""),
        (float("nan"), ""),
        (pd.NA, ""),
        (pd.NaT, ""),
        (float("inf"), "inf"),
        (np.float64(1.23456), "1.235"),
    ],
)
def test_a_cell_is_shown_with_the_digits_that_count(value: Any, text: str) -> None:
    assert shown(value) == text


def test_what_came_from_users_is_escaped_everywhere() -> None:
    made = table(**{UGLY: [UGLY]})
    made.attrs = {"title": UGLY, "notes": [UGLY], "units": {UGLY: "<mm>"}}
    rendered = render_table(made, "unused")
    page = Page(rendered.html)
    assert page.rows == [[f"{UGLY} [<mm>]"], [UGLY]]
    assert not page.open
    assert set(page.tags) <= {
        "figure", "table", "caption", "thead", "tbody", "tr", "th", "td", "ul", "li", "span", "wbr",
    }  # fmt: skip
    latex = rendered.files[".tex"].decode()
    body = latex[latex.index(r"\caption") :]
    for plain in ("&", "%", "$", "#", "_", "^", "~"):
        assert not re.search(rf"(?<!\\){re.escape(plain)}", body), plain
    assert "<" not in body
    assert not re.search(r"\\\\\s*[\[*]", body)


def test_numbers_stand_right_and_have_their_unit() -> None:
    made = table(method=["a", "bb"], rmse=[1.23456, 22.0], count=[1, 20])
    made.attrs["units"] = {"rmse": "mm"}
    rendered = render_table(made, "Errors")
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
    made = table(fill=["a", "b"], mean=[0.5, 1.5])
    assert "*" not in render_table(made, "t").text
    made.attrs["best"] = {"mean": [0]}
    assert render_table(made, "t").text.splitlines()[1:] == [
        "a     0.500*",
        "b      1.500",
        "* the best of its group",
    ]


def test_the_csv_file_has_every_digit() -> None:
    made = table(name=["a,b", "c\nd"], value=[0.1 + 0.2, float("nan")], whole=[1, 2])
    text = render_table(made, "t").files[".csv"].decode()
    assert list(csv.reader(StringIO(text))) == [
        ["name", "value", "whole"],
        ["a,b", "0.30000000000000004", "1"],
        ["c\nd", "", "2"],
    ]


def test_notes_follow() -> None:
    made = table(a=[1])
    made.attrs["notes"] = ["one", "two"]
    rendered = render_table(made, "t")
    assert rendered.html.endswith("<li>one</li><li>two</li></ul>")
    assert rendered.text.endswith("\none\ntwo")


@pytest.mark.parametrize(("rows", "folded"), [(200, False), (201, True)])
def test_a_long_table_is_folded_but_whole(rows: int, folded: bool) -> None:
    rendered = render_table(table(a=range(rows)), "t")
    page = Page(rendered.html)
    assert ("details" in page.tags) == folded
    assert len(page.rows) == rows + 1
    assert ("1 more rows in the CSV file" in rendered.text) == folded


def test_an_empty_table_is_shown_as_one() -> None:
    rendered = render_table(table(a=[], b=[]), "t")
    assert Page(rendered.html).rows == [["a", "b"]]
    assert rendered.text == "a  b"


def test_names_of_rows_become_columns() -> None:
    made = table(a=[1, 2]).set_index(pd.Index(["x", "y"], name="method"))
    made.attrs["title"] = "Kept"
    rendered = render_table(made, "t")
    assert Page(rendered.html).rows == [["method", "a"], ["x", "1"], ["y", "2"]]
    assert rendered.files[".csv"] == b"method,a\nx,1\ny,2\n"
    assert "Kept" in rendered.html


def test_a_blank_line_in_a_title_does_not_break_latex() -> None:
    assert r"\caption{a b}" in render_table(table(a=[1]), "a\n\nb").files[".tex"].decode()


@pytest.fixture
def figure() -> Figure:
    made = Figure(figsize=(3, 2))
    axes = made.subplots()
    axes.plot([1, 2], [3, 5], marker="o", label='a > id="x"')
    axes.fill_between([1, 2], [3, 5], hatch="/")
    axes.set_title("<b> url(#q)")
    axes.legend()
    return made


def ids(html: str) -> set[str]:
    return {found.get("id", "") for found in drawing(html).iter()} - {""}


def drawing(html: str) -> ET.Element:
    return ET.fromstring(html[html.index("<svg") : html.index("</figure>")])


def test_a_drawing_is_told_to_those_who_do_not_see_it(figure: Figure) -> None:
    svg = drawing(render_figure(figure, 'Errors "in" <gaps>').html)
    assert svg.get("role") == "img"
    assert svg.get("aria-label") == 'Errors "in" <gaps>'


def test_a_drawing_is_the_same_every_time(figure: Figure) -> None:
    once, again = render_figure(figure, "t"), render_figure(figure, "t")
    assert once == again
    assert set(once.files) == {".svg", ".pdf"}
    assert once.files[".pdf"].startswith(b"%PDF")
    assert b"CreationDate" not in once.files[".pdf"]
    assert b"dc:date" not in once.files[".svg"]


def test_two_drawings_of_a_page_share_no_id(figure: Figure) -> None:
    first = render_figure(figure, "t").html
    figure.axes[0].set_xlabel("other")
    second = render_figure(figure, "t").html
    assert ids(first)
    assert not ids(first) & ids(second)


def test_every_reference_of_a_drawing_has_its_target(figure: Figure) -> None:
    html = render_figure(figure, "t").html
    inside = re.findall(r"<[a-z][^>]*>", html)
    targets = {
        name for tag in inside for name in re.findall(r"""(?:href="#|url\(#)([^")]+)""", tag)
    }
    assert targets
    assert targets <= ids(html)


def test_texts_of_a_drawing_stay_as_they_are(figure: Figure) -> None:
    texts = {"".join(one.itertext()) for one in drawing(render_figure(figure, "t").html).iter()}
    assert {'a > id="x"', "<b> url(#q)"} <= texts


def test_drawing_leaves_pyplot_alone(figure: Figure) -> None:
    import matplotlib.pyplot as plt

    render_figure(figure, "t")
    assert plt.get_fignums() == []


def test_both_types_have_a_renderer(figure: Figure) -> None:
    for value in (figure, table(a=[1])):
        fitting = [one for one in renderers() if isinstance(value, one.type)]
        assert len(fitting) == 1
        assert fitting[0].render(value, "t").html
