"""A text that only looks like a formula costs no figure; a formula stays one."""

from __future__ import annotations

import warnings

import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from nodegraph_tables.renderers import render_figure, saved

BROKEN = r"$\frac$"


def figure(*, title: str = "", legend: str = "", tick: str = "", label: str = "") -> Figure:
    """Return the figure of a stranger who passes names on as they are."""
    made = Figure(layout="constrained")
    axis = made.subplots()
    axis.plot([0, 1], [1, 1000])
    axis.set(title=title, ylabel=label, yscale="log")
    axis.set_xticks([0, 1], [tick, "b"])
    if legend:
        made.legend(handles=[Line2D([], [], label=legend)])
    return made


@pytest.mark.parametrize("place", ["title", "legend", "tick", "label"])
def test_what_is_no_formula_is_drawn_as_text_and_told(place: str) -> None:
    with pytest.warns(UserWarning, match=r"drawn as text, as no formula: \$\\frac\$"):
        shown = render_figure(figure(**{place: BROKEN}), "t")
    assert f">{BROKEN}<" in shown.html
    assert shown.files[".pdf"].startswith(b"%PDF")


def test_it_is_told_once_for_the_same_text() -> None:
    with pytest.warns(UserWarning, match="formula") as told:
        render_figure(figure(title=BROKEN, legend=BROKEN), "t")
    assert [str(one.message).count("frac") for one in told] == [1]


def test_one_line_of_a_text_may_be_broken() -> None:
    with pytest.warns(UserWarning, match="drawn as text"):
        drawn = saved(figure(title=f"one\n{BROKEN}"), "svg").decode()
    assert f">{BROKEN}<" in drawn


def test_a_formula_stays_one() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        drawn = saved(figure(label="power (mm$^2$/Hz)"), "svg").decode()
    assert "$" not in drawn.replace("<!-- power (mm$^2$/Hz) -->", "").replace(
        r"<!-- $\mathdefault{10^{", ""
    ).replace("}}$ -->", "")
