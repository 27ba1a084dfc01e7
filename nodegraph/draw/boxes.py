"""Size of a box, and the positions of its texts, chips and ports."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from html import escape
from textwrap import wrap

from nodegraph.draw.picture import Alternative, Box, Socket

_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
# Advance widths in em of DejaVu Sans, the widest of the usual system fonts, rounded up: a box
# measured with them holds its text in any of the others.
_WIDTHS = {
    **dict.fromkeys("ijlIJ|!'.,:; ", 0.34),
    **dict.fromkeys('frt()[]{}-/\\"', 0.42),
    **dict.fromkeys("mwMW@%&+=<>~\u00d7#", 0.92),
    **dict.fromkeys("ABCDEFGHKLNOPQRSTUVXYZ", 0.74),
}
_MONOSPACE = 0.61
_BOLD = 1.1


_Parts = tuple[tuple[str, float, float, bool], ...]
_cached = lru_cache(10_000)  # the same names, lengths and lines stand at many boxes


@_cached
def clean(text: str) -> str:
    """Return the text on one line, without the characters that XML cannot hold."""
    return " ".join(_NOT_XML.sub("\ufffd", text).split())


@_cached
def escaped(text: str) -> str:
    """Return the text as XML, for content and for quoted attributes."""
    return escape(clean(text), quote=True)


@_cached
def shortened(text: str, longest: int = 42) -> str:
    """Return the text, cut with an ellipsis if it is longer than some characters."""
    text = clean(text)
    return text if len(text) <= longest else text[: longest - 1].rstrip() + "…"


@_cached
def width(text: str, size: float, *, bold: bool = False, monospace: bool = False) -> float:
    """Return about how wide a text is, in the unit of its font size."""
    narrow = _MONOSPACE if monospace else 0.64
    widths = {} if monospace else _WIDTHS
    ems = sum(
        1.05 if unicodedata.east_asian_width(character) in "WF" else widths.get(character, narrow)
        for character in text
    )
    return ems * size * (_BOLD if bold else 1.0)


CHIP_HEIGHT = 19.0
INSET = 12.0
_CHIP_INSET = 8.0
_CHIP_GAP = 5.0
_ROW_GAP = 2.0
_ROW = CHIP_HEIGHT + _ROW_GAP
_STATE = 60.0
"""Room for how far the combinations of an alternative are, at the end of its row."""
_LONGEST_IN_ROW = 60
_MOST_ROWS = 12
_WIDEST_ROW = 196.0
_NARROWEST = 84.0
_LONGEST_NOTE = 36
_LONGEST_SETTINGS = 28
_LONGEST_AXIS = 34
_AXIS_LINE = 14.0
_BASELINE = 13.3
_LIST = re.compile(r"\[[^\[\]]*\]")
_MOST_LINES = 4
_LONGEST = {"port": 24, "note": 30}
_BETWEEN_SIDES = 18.0
_SIZES = {"port": 12.0, "note": 11.0, "name": 15.0, "line": 11.5, "chip": 11.0}
_LEADING = {"port": 16.0, "note": 13.5, "name": 19.0, "line": 16.0}


Notes = tuple[tuple[str, str], ...]
"""Ports, each with a text."""


@dataclass(frozen=True, slots=True)
class Text:
    """One line of text: its place is the start, or the end, of its baseline."""

    style: str
    text: str
    x: float
    y: float
    hint: str = ""
    at_end: bool = False


@dataclass(frozen=True, slots=True)
class Chip:
    """A small label with a frame; its place is the upper left corner.

    Attributes
    ----------
    texts : tuple of (str, float, float, bool)
        Each with the distance of its start, or of its middle on an axis, and of its baseline from
        the corner, and whether it is a name and no note.
    label : str
        Of an alternative.
    """

    style: str
    texts: _Parts
    x: float
    y: float
    width: float
    height: float
    hint: str
    label: str = ""


@dataclass(frozen=True, slots=True)
class Shape:
    """A box with everything in it, measured from its upper left corner.

    Attributes
    ----------
    rule : float
        Height of the line between the heading and the ports.
    inputs, outputs : mapping of port to float
        How far from the top the port's arrows end or begin.
    """

    box: Box
    width: float
    height: float
    texts: tuple[Text, ...]
    chips: tuple[Chip, ...]
    rule: float
    inputs: Mapping[str, float]
    outputs: Mapping[str, float]


@_cached
def shape(
    box: Box, label: str, fixed: Notes = (), sources: Notes = (), readers: Notes = ()
) -> Shape:
    """Return the box laid out.

    Parameters
    ----------
    box : Box
    label : str
        Shown as its name.
    fixed : tuple of (input port, text)
        The labels that each arrow into the port fixes: ``trial=0, length=45``.
    sources, readers : tuple of (port, name)
        Where arrows into an input begin, and where those from an output end, if that is not drawn:
        ``gaps.hidden``.
    """
    heading = [("name", label), *(("line", line) for line in _heading(box))]
    common = _common(fixed)
    heading += [("note", line) for line in _wrapped(_at(", ".join(common)), _LONGEST_NOTE)]
    notes = {
        socket.name: [
            socket.gathers,
            *(f"from {source}" for source in _of(socket, sources)),
            *(_at(text, common) for text in _of(socket, fixed)),
        ]
        for socket in box.inputs
    }
    onward = {
        socket.name: [f"to {', '.join(names)}"]
        for socket in box.outputs
        if (names := _of(socket, readers))
    }
    inputs = [_lines(socket, notes[socket.name]) for socket in box.inputs]
    outputs = [_lines(socket, onward.get(socket.name, ())) for socket in box.outputs]
    sides = [
        _widest(
            (style, shortened(text, _LONGEST[style])) for lines in side for style, text in lines
        )
        for side in (inputs, outputs)
    ]
    inner = max(_NARROWEST, _widest(heading), sum(sides) + _BETWEEN_SIDES * all(sides))
    texts: list[Text] = []
    y = 4.0
    for style, text in heading:
        y += _LEADING[style]
        hint = clean(text) if shortened(text) != clean(text) else ""
        texts.append(Text(style, shortened(text), INSET, y - 3.0, hint))
    chips: list[Chip] = []
    rows = [_row(each) for each in box.alternatives]
    in_column = len(rows) if len(rows) <= _MOST_ROWS else -(-len(rows) // 2)
    inner = max([inner, *(wide for _, wide in rows)])
    if len(rows) > in_column:
        inner = max(inner, 2 * max(wide for _, wide in rows) + _CHIP_GAP)
    first_row = y + _CHIP_GAP
    if rows:
        y = first_row + in_column * _ROW - _ROW_GAP
    limit = max(inner, _WIDEST_ROW)
    x, top = limit + 1.0, y
    for text in box.axes:
        wrapped = _wrapped(text, _LONGEST_AXIS)
        widths = [width(each, _SIZES["chip"], bold=True) for each in wrapped]
        wide, high = max(widths) + 2 * _CHIP_INSET, CHIP_HEIGHT + (len(wrapped) - 1) * _AXIS_LINE
        if x + wide > limit or high > CHIP_HEIGHT:
            x, top = 0.0, y + _CHIP_GAP
        parts = tuple(
            (each, wide / 2, _BASELINE + at * _AXIS_LINE, True) for at, each in enumerate(wrapped)
        )
        chips.append(Chip("axis", parts, INSET + x, top, wide, high, text))
        x += wide + _CHIP_GAP
        y = max(y, top + high)
    inner = max([inner, *(chip.x + chip.width - INSET for chip in chips)])
    for at, (each, (parts, _)) in enumerate(zip(box.alternatives, rows, strict=True)):
        column, row = divmod(at, in_column)
        wide = inner if len(rows) == in_column else (inner - _CHIP_GAP) / 2
        left = INSET + column * (wide + _CHIP_GAP)
        place = left, first_row + row * _ROW, wide, CHIP_HEIGHT
        chips.append(Chip("alternative", parts, *place, str(each), each.label))
    rule = y + 7.0
    lows = [rule]
    places: list[dict[str, float]] = []
    for x, sockets, side in (
        (INSET, box.inputs, inputs),
        (INSET + inner, box.outputs, outputs),
    ):
        y = rule
        places.append({})
        for socket, lines in zip(sockets, side, strict=True):
            y += 3.0
            places[-1][socket.name] = y + _LEADING["port"] / 2
            own = (notes if side is inputs else onward).get(socket.name, ())
            hint = "; ".join([str(socket), *filter(None, own)])
            for style, line in lines:
                y += _LEADING[style]
                short = shortened(line, _LONGEST[style])
                texts.append(Text(style, short, x, y - 3.5, hint, at_end=side is outputs))
        lows.append(y)
    wide, high = inner + 2 * INSET, max(lows) + 6.0
    return Shape(box, wide, high, tuple(texts), tuple(chips), rule, *places)


def _row(alternative: Alternative) -> tuple[_Parts, float]:
    """Return the texts of the row of an alternative, and how wide it is with its state."""
    parts: list[tuple[str, float, float, bool]] = []
    x = _CHIP_INSET
    for text in filter(None, (alternative.label, alternative.details)):
        short = shortened(text, _LONGEST_IN_ROW)
        parts.append((short, x, _BASELINE, not parts))
        x += width(short, _SIZES["chip"]) + _CHIP_GAP
    return tuple(parts), x + _STATE


def _of(socket: Socket, notes: Notes) -> list[str]:
    return list(dict.fromkeys(text for port, text in notes if port == socket.name))


def _common(fixed: Notes) -> list[str]:
    """Return the labels that stand at several ports, at all that have any."""
    if len({port for port, _ in fixed}) < 2:
        return []
    first, *others = [text.split(", ") for _, text in fixed]
    return [label for label in first if all(label in labels for labels in others)]


def _at(text: str, common: Sequence[str] = ()) -> str:
    """Return the note of a port: the labels that are not common."""
    own = ", ".join(label for label in text.split(", ") if label not in common)
    return own and f"at {own}"


def _heading(box: Box) -> Iterator[str]:
    """Yield the lines below the name of a box: its settings in several."""
    for text in box.lines:
        yield from _wrapped(text, _LONGEST_SETTINGS) if ": " in text else (text,)


@_cached
def _wrapped(text: str, longest: int) -> tuple[str, ...]:
    """Return a note in lines, not broken within a setting; the last is cut where there are more."""
    text = clean(text).replace(": ", ":\N{NO-BREAK SPACE}")
    text = _LIST.sub(lambda found: found[0].replace(" ", "\N{NO-BREAK SPACE}"), text)
    lines = wrap(text, longest, max_lines=_MOST_LINES, placeholder=" …", break_on_hyphens=False)
    return tuple([line.replace("\N{NO-BREAK SPACE}", " ") for line in lines])


def _lines(socket: Socket, notes: Sequence[str]) -> list[tuple[str, str]]:
    """Return the style and text of each line at a port."""
    lines = [line for text in dict.fromkeys(notes) for line in _wrapped(text, _LONGEST["note"])]
    return [("port", socket.shown or socket.name), *(("note", line) for line in lines)]


def _widest(lines: Iterable[tuple[str, str]]) -> float:
    return max(
        (
            width(shortened(text), _SIZES[style], bold=style == "name", monospace=style == "line")
            for style, text in lines
        ),
        default=0.0,
    )
