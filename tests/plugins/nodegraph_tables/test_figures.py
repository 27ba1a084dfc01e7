"""Drawings of figures: equal every time, readable in a page, with texts drawn literally."""

from __future__ import annotations

import re
import warnings
import xml.etree.ElementTree as ET
from itertools import pairwise
from typing import Any

import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from nodegraph_tables.axes import SMALL, name_lines
from nodegraph_tables.figures import StoredFigure, render_figure, store_figure
from nodegraph_tables.style import BEST


@pytest.fixture
def figure() -> Figure:
    drawing = Figure(figsize=(3, 2))
    axes = drawing.subplots()
    axes.plot([1, 2], [3, 5], marker="o", label='a > id="x"')
    axes.fill_between([1, 2], [3, 5], hatch="/")
    axes.set_title("<b> url(#q)")
    axes.legend()
    return drawing


def ids(html: str) -> set[str]:
    return {element.get("id", "") for element in drawing(html).iter()} - {""}


def drawing(html: str) -> ET.Element:
    return ET.fromstring(html[html.index("<svg") : html.index("</figure>")])


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
    texts = {
        "".join(element.itertext()) for element in drawing(render_figure(figure, "t").html).iter()
    }
    assert {'a > id="x"', "<b> url(#q)"} <= texts


@pytest.mark.parametrize(
    "drawing", [(b"", b""), (b"\xff<svg", b""), ("<svg>", b""), (b"<svg>", "")]
)
def test_what_is_no_drawing_is_refused(drawing: Any) -> None:
    with pytest.raises(ValueError, match=r"svg|pdf|utf-8"):
        StoredFigure(*drawing)


def test_a_notebook_shows_a_stored_drawing(figure: Figure) -> None:
    shown = ET.fromstring(store_figure(figure)._repr_html_())
    assert shown.tag == "figure"
    assert "<b> url(#q)" in "".join(shown.itertext())


BROKEN = r"$\frac$"


def labelled(*, title: str = "", legend: str = "", tick: str = "", label: str = "") -> Figure:
    """Return the figure of a node that does not escape names."""
    drawing = Figure(layout="constrained")
    axis = drawing.subplots()
    axis.plot([0, 1], [1, 1000])
    axis.set(title=title, ylabel=label, yscale="log")
    axis.set_xticks([0, 1], [tick, "b"])
    if legend:
        drawing.legend(handles=[Line2D([], [], label=legend)])
    return drawing


@pytest.mark.parametrize("place", ["title", "legend", "tick", "label"])
def test_what_is_no_formula_is_drawn_as_text_and_reported(place: str) -> None:
    with pytest.warns(UserWarning, match=r"drawn as text, as no formula: \$\\frac\$"):
        shown = render_figure(labelled(**{place: BROKEN}), "t")
    assert f">{BROKEN}<" in shown.html
    assert shown.files[".pdf"].startswith(b"%PDF")


def test_it_is_reported_once_for_the_same_text() -> None:
    with pytest.warns(UserWarning, match="formula") as caught:
        render_figure(labelled(title=BROKEN, legend=BROKEN), "t")
    assert [str(warning.message).count("frac") for warning in caught] == [1]


def test_a_formula_stays_one() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        drawn = store_figure(labelled(label="power (mm$^2$/Hz)")).svg.decode()
    assert "$" not in drawn.replace("<!-- power (mm$^2$/Hz) -->", "").replace(
        r"<!-- $\mathdefault{10^{", ""
    ).replace("}}$ -->", "")


def test_colours_follow_the_page_and_files_beside_it_do_not() -> None:
    drawing = Figure(figsize=(3, 2))
    axis = drawing.subplots()
    axis.plot([1, 2], [3, 5], color=BEST)
    axis.plot([1, 2], [5, 3], color="#009e73")
    axis.set_facecolor("#cccccc")
    shown = render_figure(drawing, "t")
    file = shown.files[".svg"].decode()
    assert f"stroke: var(--best, {BEST})" in shown.html
    assert "stroke: #009e73" in shown.html
    assert "color-mix(in srgb, var(--ink, #000) 20%, var(--paper, #fff))" in shown.html
    assert "fill: var(--paper, #ffffff)" in shown.html
    assert "<style" not in shown.html
    assert f"stroke: {BEST}" in file
    assert "var(" not in file


def test_names_of_lines_keep_apart_and_in_order() -> None:
    drawing = Figure(figsize=(3, 3))
    axis = drawing.add_axes((0, 0, 1, 1))
    axis.set(ylim=(1, 1000), yscale="log")
    heights = [10.0, 10.1, 900.0, 5000.0, 10.2]
    name_lines(axis, list("abcde"), heights, ["black"] * 5, 3.0)
    places = {
        text.get_text(): 3 * 72 * text.get_position()[1] for text in axis.texts if text.get_text()
    }
    order = sorted(places, key=places.__getitem__)
    assert order == ["a", "b", "e", "c", "d"]
    assert min(places[b] - places[a] for a, b in pairwise(order)) >= SMALL
    assert abs(places["b"] - 72) < 0.5
