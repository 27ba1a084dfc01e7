"""Formulas in figures that cannot be set: they are drawn as the text that they are."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

from nodegraph import listed

if TYPE_CHECKING:
    from matplotlib.mathtext import MathTextParser, VectorParse
    from matplotlib.text import Text

    from nodegraph_mocap.tables import Figure


def keep_what_is_no_formula(figure: Figure) -> None:
    r"""Have texts of a figure drawn as they stand whose ``$`` signs enclose no formula.

    Nodes should pass names through `nodegraph_mocap.figure_text`. Where one does not, a name such
    as ``$\frac$`` would cost the whole figure. A formula that can be set stays one: an author may
    have meant it.

    Warns
    -----
    UserWarning
        With the texts.
    """
    from matplotlib.mathtext import MathTextParser
    from matplotlib.text import Text

    parser = MathTextParser("path")
    texts = [one for one in figure.findobj(Text) if isinstance(one, Text)]
    broken = [one for one in texts if one.get_parse_math() and _is_broken(one, parser)]
    for text in broken:
        text.set_parse_math(False)
    if broken:
        told = listed(dict.fromkeys(" ".join(one.get_text().split()) for one in broken))
        warnings.warn(f"drawn as text, as no formula: {told}", stacklevel=2)


def _is_broken(text: Text, parser: MathTextParser[VectorParse]) -> bool:
    """Return whether matplotlib takes a line of a text for a formula and cannot set it."""
    return not text.get_usetex() and not all(
        _can_be_set(line, parser) for line in text.get_text().split("\n")
    )


def _can_be_set(line: str, parser: MathTextParser[VectorParse]) -> bool:
    from matplotlib.cbook import is_math_text

    if not is_math_text(line):
        return True
    try:
        parser.parse(line)
    except ValueError:
        return False
    return True
