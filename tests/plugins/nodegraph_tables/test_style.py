"""Labels in figures: how each looks, and that its text is drawn literally."""

from __future__ import annotations

import io
from xml.etree import ElementTree as ET

from hypothesis import example, given
from hypothesis import strategies as st
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from nodegraph_tables.style import figure_text, looks


def test_a_label_looks_the_same_in_every_order() -> None:
    assert looks(["b", "a", "c"]) == looks(["c", "b", "a"])


def test_the_first_seventy_differ_in_colour_or_marker() -> None:
    dealt = looks(range(70)).values()
    assert len({(look.colour, look.marker) for look in dealt}) == 70


PRINTABLE = st.text(st.characters(min_codepoint=32, max_codepoint=126), min_size=1, max_size=30)


def drawn(text: str) -> list[str]:
    """Return the texts of a figure with a title and a legend."""
    figure = Figure()
    figure.suptitle(text)
    figure.legend(handles=[Line2D([], [], label=text)])
    file = io.BytesIO()
    with rc_context({"svg.fonttype": "none"}):
        figure.savefig(file, format="svg")
    root = ET.fromstring(file.getvalue())
    return [
        "".join(element.itertext()) for element in root.iter("{http://www.w3.org/2000/svg}text")
    ]


@given(PRINTABLE)
@example(r"$\frac$")
@example("$x_1$")
@example("pay $1 or $2")
@example(r"\$\\$ $")
@example("_hidden")
@example("_$_")
def test_every_name_stands_in_title_and_legend_as_it_is(name: str) -> None:
    shown = " ".join(name.split())
    assert [figure.replace("\u200b", "") for figure in drawn(figure_text(name))] == [
        shown
    ] * 2 * bool(shown)


def test_white_space_and_line_ends_are_one_space() -> None:
    assert figure_text(" two\r\n lines\u2028\tand\u00a0more ") == "two lines and more"


def test_what_cannot_be_printed_is_its_escape() -> None:
    assert figure_text("a\x00b\x1b[0m\udc80\u202e") == r"a\x00b\x1b[0m\udc80\u202e"


def test_a_long_name_keeps_its_beginning_and_its_end() -> None:
    names = [f"{'subject_12_' * 5}take_{number}" for number in (1, 2)]
    first, second = (figure_text(name) for name in names)
    assert first != second
    assert len(first) == 40
    assert first.startswith("subject_12_")
    assert first.endswith("take_1")
    assert first.count("\N{HORIZONTAL ELLIPSIS}") == 1


def test_signs_are_escaped_after_the_name_is_shortened() -> None:
    assert figure_text("$" * 50) == r"\$" * 20 + "\N{HORIZONTAL ELLIPSIS}" + r"\$" * 19


def test_lines_end_between_words() -> None:
    assert figure_text("butterworth 6 Hz, seed 3", across=16, lines=2) == (
        "butterworth 6\nHz, seed 3"
    )


@given(
    st.text(st.sampled_from("ab $_\n"), max_size=60),
    st.integers(min_value=1, max_value=12),
    st.integers(min_value=1, max_value=3),
)
def test_there_are_never_more_nor_longer_lines(name: str, across: int, lines: int) -> None:
    broken = figure_text(name, across=across, lines=lines).replace("\u200b", "").split("\n")
    assert len(broken) <= lines
    assert max(map(len, (line.replace(r"\$", "$") for line in broken))) <= across
