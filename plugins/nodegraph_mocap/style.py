"""One look for all figures: colours that the colour-blind can tell apart, and a marker for each.

The colours are those of Okabe and Ito, "Color universal design" (2008). Black is kept for the
truth. Nothing here needs matplotlib to be imported; the names are those that it understands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Iterable

Line = Literal["-", "--", ":", "-."]

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


@dataclass(frozen=True, slots=True)
class Look:
    """How one method appears.

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
    """Return a unit as it is printed: ``mm²`` for ``mm^2``."""
    return unit.replace("^2", "\N{SUPERSCRIPT TWO}").replace("^3", "\N{SUPERSCRIPT THREE}")


def _look(place: int) -> Look:
    cycle = place // len(COLOURS)
    return Look(
        colour=COLOURS[place % len(COLOURS)],
        marker=MARKERS[place % len(MARKERS)],
        line=LINES[cycle % len(LINES)],
    )
