"""Size of a box, and the positions of its texts, chips and ports."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape

from nodegraph.draw.picture import Box, Socket

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
    for index, width in enumerate(widths):
        if used + gap + width > limit:
            filled.append([])
            used = -gap
        filled[-1].append(index)
        used += gap + width
    return filled


def _character_width(character: str, monospace: bool) -> float:
    if unicodedata.east_asian_width(character) in "WF":
        return 1.05
    return _MONOSPACE if monospace else _WIDTHS.get(character, 0.64)


PADDING = 12.0
CHIP_HEIGHT = 19.0
_CHIP_INSET = 8.0
_CHIP_GAP = 5.0
_CHIP_SIZE = 11.0
_CHIPS = 14
_WIDEST_ROW = 196.0
_NARROWEST = 84.0
_BETWEEN_SIDES = 18.0
_ALL_SOCKETS = 3
_NOTE = 26
_SIZES = {"port": 11.0, "more": 9.5, "note": 10.0, "name": 15.0, "line": 11.5}
_LEADING = {"port": 15.0, "more": 13.0, "note": 12.5, "name": 19.0, "line": 16.0}


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
    """A small label with a frame; its place is the upper left corner."""

    style: str
    text: str
    x: float
    y: float
    width: float
    hint: str = ""


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


@dataclass(frozen=True, slots=True)
class _Slot:
    """The text at one place on a box's edge, and the ports that it names."""

    ports: tuple[str, ...]
    lines: tuple[tuple[str, str], ...]
    hint: str


def shape(
    box: Box, wired: frozenset[str], notes: Mapping[str, Sequence[str]], label: str = ""
) -> Shape:
    """Return the box laid out.

    Parameters
    ----------
    box : Box
    wired : frozenset of str
        Ports with an arrow: of a box with many ports, the others are only counted.
    notes : mapping of input port to texts
        Which labels the arrows into each port fix.
    label : str
        Shown instead of the name, if not empty.
    """
    label = label or box.name
    inputs = _slots(box.inputs, wired, notes)
    outputs = _slots(box.outputs, wired, {})
    sides = [_widest(inputs), _widest(outputs)]
    inner = max(_NARROWEST, _heading_width(box, label), sum(sides) + _BETWEEN_SIDES * all(sides))
    groups = _chip_texts(box)
    flowing = [_flow(group, max(inner, _WIDEST_ROW)) for group in groups]
    inner = max([inner, *(x + chip for places in flowing for x, _, chip in places)])
    heading, y = _heading(box, label, 4.0)
    chips, y = _chips(groups, flowing, y)
    rule = y + 7.0
    into, inputs_at, left_end = _side(inputs, PADDING, rule)
    out, outputs_at, right_end = _side(outputs, PADDING + inner, rule, at_end=True)
    return Shape(
        box=box,
        width=inner + 2 * PADDING,
        height=max(left_end, right_end) + 6.0,
        texts=(*heading, *into, *out),
        chips=tuple(chips),
        rule=rule,
        inputs=inputs_at,
        outputs=outputs_at,
    )


def _slots(
    sockets: Sequence[Socket], wired: frozenset[str], notes: Mapping[str, Sequence[str]]
) -> list[_Slot]:
    few = len(sockets) <= _ALL_SOCKETS
    slots = [
        _slot(socket, notes.get(socket.name, ()))
        for socket in sockets
        if few or socket.name in wired
    ]
    rest = [socket for socket in sockets if not few and socket.name not in wired]
    if rest:
        names = tuple(socket.name for socket in rest)
        more = f"+{len(rest)} more" if slots else f"{len(rest)} ports"
        slots.append(_Slot(names, (("more", more),), ", ".join(map(str, rest))))
    return slots


def _slot(socket: Socket, notes: Sequence[str]) -> _Slot:
    texts = tuple(dict.fromkeys([socket.gathers, *notes] if socket.gathers else notes))
    lines = [("port", shortened(socket.name, 24))]
    lines += [("note", shortened(text, _NOTE)) for text in texts]
    return _Slot((socket.name,), tuple(lines), "; ".join((str(socket), *texts)))


def _widest(slots: Sequence[_Slot]) -> float:
    lines = [line for slot in slots for line in slot.lines]
    return max((width(text, _SIZES[style]) for style, text in lines), default=0.0)


def _side(
    slots: Sequence[_Slot], x: float, y: float, *, at_end: bool = False
) -> tuple[list[Text], dict[str, float], float]:
    """Return the texts of the ports on one side, their heights, and the lower end."""
    texts: list[Text] = []
    places: dict[str, float] = {}
    for slot in slots:
        y += 3.0
        places |= dict.fromkeys(slot.ports, y + _LEADING["port"] / 2)
        for style, text in slot.lines:
            y += _LEADING[style]
            texts.append(Text(style, text, x, y - 3.5, slot.hint, at_end))
    return texts, places, y


def _heading_width(box: Box, label: str) -> float:
    lines = [width(shortened(line), _SIZES["line"], monospace=True) for line in box.lines]
    return max([width(shortened(label), _SIZES["name"], bold=True), *lines])


def _heading(box: Box, label: str, y: float) -> tuple[list[Text], float]:
    texts = []
    for style, text in [("name", label), *(("line", line) for line in box.lines)]:
        y += _LEADING[style]
        hint = clean(text) if shortened(text) != clean(text) else ""
        texts.append(Text(style, shortened(text), PADDING, y - 3.0, hint))
    return texts, y


def _chip_texts(box: Box) -> list[list[tuple[str, str, str]]]:
    """Return the style, text and hint of each chip: alternatives first, then axes."""
    shown = [("alternative", shortened(text, 24), text) for text in box.alternatives[:_CHIPS]]
    rest = box.alternatives[_CHIPS:]
    if rest:
        shown.append(("more", f"+{len(rest)} more", ", ".join(rest)))
    axes = [("axis", shortened(text), text) for text in box.axes]
    return [group for group in (shown, axes) if group]


def _flow(group: Sequence[tuple[str, str, str]], limit: float) -> list[tuple[float, int, float]]:
    """Return for each chip how far from the left it stands, in which row, and its width."""
    widths = [
        width(text, _CHIP_SIZE, bold=style == "axis") + 2 * _CHIP_INSET for style, text, _ in group
    ]
    places = []
    for number, row in enumerate(rows(widths, limit, _CHIP_GAP)):
        x = 0.0
        for index in row:
            places.append((x, number, widths[index]))
            x += widths[index] + _CHIP_GAP
    return places


def _chips(
    groups: Sequence[Sequence[tuple[str, str, str]]],
    flowing: Sequence[Sequence[tuple[float, int, float]]],
    y: float,
) -> tuple[list[Chip], float]:
    chips = []
    for group, places in zip(groups, flowing, strict=True):
        y += _CHIP_GAP
        for (style, text, hint), (x, row, wide) in zip(group, places, strict=True):
            top = y + row * (CHIP_HEIGHT + _CHIP_GAP)
            chips.append(Chip(style, text, PADDING + x, top, wide, hint))
        y += (places[-1][1] + 1) * (CHIP_HEIGHT + _CHIP_GAP) - _CHIP_GAP
    return chips, y
