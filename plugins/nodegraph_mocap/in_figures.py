"""Names of users in figures: drawn as they stand, never set as mathematics."""

from __future__ import annotations

from textwrap import wrap

_HIDDEN = "_"
"""What the legends of matplotlib leave out begins with it."""

_NOTHING = "\N{ZERO WIDTH SPACE}"
_LEFT_OUT = "\N{HORIZONTAL ELLIPSIS}"


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
    """Return text in so many lines at most, without its middle where it does not fit."""
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
