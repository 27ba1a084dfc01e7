"""Texts of a drawing: safe to write into XML, measured without fonts, shortened, wrapped."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from html import escape

_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_MONOSPACE = 0.61
_BOLD = 1.1
# Advance widths in em of DejaVu Sans, the widest of the usual system fonts, rounded up: a box
# measured with them holds its text in any of the others.
_WIDTHS = {
    **dict.fromkeys("ijlIJ|!'.,:; ", 0.34),
    **dict.fromkeys('frt()[]{}-/\\"', 0.42),
    **dict.fromkeys("mwMW@%&+=<>~\u00d7#", 0.92),
    **dict.fromkeys("ABCDEFGHKLNOPQRSTUVXYZ", 0.74),
}


def clean(text: str) -> str:
    """Return the text on one line, without the characters that XML cannot hold."""
    return " ".join(_NOT_XML.sub("\ufffd", text).split())


def escaped(text: str) -> str:
    """Return the text as XML, for content and for quoted attributes."""
    return escape(clean(text), quote=True)


def shortened(text: str, longest: int = 42) -> str:
    """Return the text, cut with an ellipsis if it is longer than some characters."""
    text = clean(text)
    return text if len(text) <= longest else text[: longest - 1].rstrip() + "…"


def width(text: str, size: float, *, bold: bool = False, monospace: bool = False) -> float:
    """Return about how wide a text is, in the unit of its font size."""
    ems = sum(_character_width(character, monospace) for character in text)
    return ems * size * (_BOLD if bold else 1.0)


def rows(widths: Sequence[float], limit: float, gap: float) -> list[list[int]]:
    """Return which pieces stand in which row, when no row is wider than the limit."""
    filled: list[list[int]] = []
    used = limit + 1.0
    for index, one in enumerate(widths):
        if used + gap + one > limit:
            filled.append([])
            used = -gap
        filled[-1].append(index)
        used += gap + one
    return filled


def _character_width(character: str, monospace: bool) -> float:
    if unicodedata.east_asian_width(character) in "WF":
        return 1.05
    return _MONOSPACE if monospace else _WIDTHS.get(character, 0.64)
