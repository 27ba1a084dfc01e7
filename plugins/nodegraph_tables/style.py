"""One look for all figures: colours by role, and colours that the colour-blind can distinguish.

Where methods are compared, colour is a role: the best, what stands out, the rest. Where recordings
lie on top of each other, each has a colour of its own, of those of Okabe and Ito, "Color universal
design" (2008), and a marker; black is kept for the truth. Nothing here needs matplotlib to be
imported; the names are those that it understands.
"""

from __future__ import annotations

from dataclasses import dataclass
from textwrap import wrap
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Iterable

Line = Literal["-", "--", ":", "-."]

BEST = "#1a5fb4"
STANDS_OUT = "#b8480a"
SUSPECT = "#8a2f7d"
REST = "#8a939f"
QUIET = "#57606b"
LINE = "#dfe4ea"

ROLES = {
    BEST: "--best",
    STANDS_OUT: "--selected",
    SUSPECT: "--suspect",
    REST: "--rest",
    QUIET: "--quiet",
    LINE: "--line",
}
"""The custom properties of a page's style sheet that stand for these colours, light and dark."""

BLUE = "#0072B2"
VERMILLION = "#D55E00"
ORANGE = "#E69F00"
GREY = "#9A9A9A"
LIGHT = "#C8C8C8"
PALE = "#ECECEC"
BLACK = "#000000"

COLOURS = (BLUE, VERMILLION, "#009E73", "#CC79A7", ORANGE, "#56B4E9", "#B8A800")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p")
LINES: tuple[Line, ...] = ("-", "--", ":", "-.")

SHARE = "share"
"""The unit of a number from 0 to 1 that people read in percent."""

CHANCE = "chance"
"""The unit of a p, which has none in print."""

SMALLEST_CHANCE = 1e-4
"""A smaller p is shown as such: no test of some ten units says how much smaller it is."""

_PRINTED = {SHARE: "%", CHANCE: ""}

_HIDDEN = "_"
"""The legends of matplotlib leave out labels that begin with it."""

_NOTHING = "\N{ZERO WIDTH SPACE}"
_LEFT_OUT = "\N{HORIZONTAL ELLIPSIS}"


@dataclass(frozen=True, slots=True)
class Look:
    """The appearance of one method.

    Attributes
    ----------
    colour : str
    marker : str
    line : str
        As matplotlib names them.
    """

    colour: str
    marker: str
    line: Line


def looks(labels: Iterable[object]) -> dict[str, Look]:
    """Return a look for each label, by its text; the first 70 differ in colour or in marker.

    Looks are dealt in the order of the sorted texts: the same labels look the same in every
    figure, in whatever order, and whichever of them a figure happens to lack. Figures that are to
    agree must name the same labels here, those that were refused included.

    Examples
    --------
    >>> looks(["muscle", "guenter"])["guenter"]
    Look(colour='#0072B2', marker='o', line='-')
    """
    texts = sorted({str(label) for label in labels})
    return {text: _look(place) for place, text in enumerate(texts)}


def unit_text(unit: str) -> str:
    """Return a unit as it is printed: ``mm²`` for ``mm^2``, ``%`` for a share, none for a p."""
    if unit in _PRINTED:
        return _PRINTED[unit]
    return unit.replace("^2", "\N{SUPERSCRIPT TWO}").replace("^3", "\N{SUPERSCRIPT THREE}")


def bare_unit(unit: str) -> str:
    """Return the unit of a number that stands without it: shares have theirs all the same."""
    return unit if unit == SHARE else ""


def scale_of(unit: str) -> float:
    """Return by what a number is multiplied where it is printed with `unit_text`."""
    return 100.0 if unit == SHARE else 1.0


def _look(place: int) -> Look:
    cycle = place // len(COLOURS)
    return Look(
        colour=COLOURS[place % len(COLOURS)],
        marker=MARKERS[place % len(MARKERS)],
        line=LINES[cycle % len(LINES)],
    )


def figure_text(label: object, *, across: int = 40, lines: int = 1) -> str:
    r"""Return a label as text that matplotlib draws as it stands.

    Whatever a user may write goes through here on its way into a figure: between two ``$`` signs
    matplotlib finds a formula, and a broken one costs the figure; its legends hide a name that
    begins with ``_``. White space becomes one space, and a character that cannot be printed its
    escape, as Python writes it.

    Parameters
    ----------
    label
        A name, a label, any text.
    across
        The most characters of a line. What is longer is broken into lines, between words if it
        can be.
    lines
        The most lines. What is longer still is shortened in its middle: names of takes often
        differ at their ends.

    Examples
    --------
    >>> figure_text("costs $1 or $2")
    'costs \\$1 or \\$2'
    >>> figure_text("subject 12, take 3, butterworth", across=21)
    'subject 12…utterworth'
    """
    text = " ".join("".join(map(_printable, " ".join(str(label).split()))).split())
    drawn = "\n".join(_broken(text, across, lines)).replace("$", r"\$")
    return f"{_NOTHING}{drawn}" if drawn.startswith(_HIDDEN) else drawn


def _printable(character: str) -> str:
    if character.isprintable():
        return character
    return character.encode("unicode_escape").decode("ascii")


def _broken(text: str, across: int, lines: int) -> list[str]:
    """Return text in a limited number of lines, without its middle where it does not fit."""
    length = across * lines
    broken = wrap(_shortened(text, length), across)
    # words are not cut where a line can end before them, so that lines may have room left
    while len(broken) > lines:
        length -= 1
        broken = wrap(_shortened(text, length), across)
    return broken


def _shortened(text: str, length: int) -> str:
    if len(text) <= length:
        return text
    after = (length - 1) // 2
    before = length - 1 - after
    return f"{text[:before].rstrip()}{_LEFT_OUT}{text[-after:].lstrip() if after else ''}"
