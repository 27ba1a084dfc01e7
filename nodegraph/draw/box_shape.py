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


PADDING = 14.0
CHIP_HEIGHT = 19.0
_CHIP_INSET = 8.0
_CHIP_GAP = 5.0
_CHIP_SIZE = 11.0
_CHIPS = 14
_WIDEST_ROW = 236.0
_NARROWEST = 112.0
_SOCKET_GAP = 14.0
_ALL_SOCKETS = 3
_NOTE = 26
_SIZES = {"port": 11.0, "more": 9.5, "note": 10.0, "name": 15.0, "line": 11.5}
_LEADING = {"port": 13.0, "more": 11.5, "note": 12.5, "name": 19.0, "line": 16.0}


@dataclass(frozen=True, slots=True)
class Text:
    """One line of text: its place is the middle or the start of its baseline."""

    style: str
    text: str
    x: float
    y: float
    middle: bool = False
    hint: str = ""


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
    rules : tuple of float
        Heights of the lines that part ports from the rest.
    inputs, outputs : mapping of port to float
        How far from the left the port's arrows end or begin.
    """

    box: Box
    width: float
    height: float
    texts: tuple[Text, ...]
    chips: tuple[Chip, ...]
    rules: tuple[float, ...]
    inputs: Mapping[str, float]
    outputs: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class _Slot:
    """The text at one place on a box's edge, and the ports that it names."""

    ports: tuple[str, ...]
    lines: tuple[tuple[str, str], ...]
    hint: str

    @property
    def width(self) -> float:
        return max(width(text, _SIZES[style]) for style, text in self.lines)


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
    chips = _chip_texts(box)
    inner = max(_NARROWEST, _heading_width(box, label), _strip_width(inputs), _strip_width(outputs))
    flowing = [_flow(group, max(inner, _WIDEST_ROW)) for group in chips]
    inner = max([inner, *(x + chip for row in flowing for x, _, chip in row)])
    top, inputs_height = 6.0, _strip_height(inputs)
    texts, in_places = _strip(inputs, inner, top)
    y = top + inputs_height + (8.0 if inputs else 4.0)
    rules = [top + inputs_height + 4.0] if inputs else []
    heading, y = _heading(box, label, y)
    drawn, y = _chips(chips, flowing, y)
    y += 8.0
    if outputs:
        rules.append(y)
    below, out_places = _strip(outputs, inner, y + 3.0)
    height = y + (_strip_height(outputs) + 8.0 if outputs else 0.0)
    return Shape(
        box=box,
        width=inner + 2 * PADDING,
        height=height,
        texts=(*texts, *heading, *below),
        chips=tuple(drawn),
        rules=tuple(rules),
        inputs=in_places,
        outputs=out_places,
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


def _strip_width(slots: Sequence[_Slot]) -> float:
    return sum(slot.width for slot in slots) + _SOCKET_GAP * max(0, len(slots) - 1)


def _strip_height(slots: Sequence[_Slot]) -> float:
    return max((sum(_LEADING[style] for style, _ in slot.lines) for slot in slots), default=0.0)


def _strip(slots: Sequence[_Slot], inner: float, top: float) -> tuple[list[Text], dict[str, float]]:
    spare = (inner - _strip_width(slots)) / len(slots) if slots else 0.0
    texts: list[Text] = []
    places: dict[str, float] = {}
    left = PADDING
    for slot in slots:
        middle = left + (slot.width + spare) / 2
        y = top
        for style, text in slot.lines:
            y += _LEADING[style]
            texts.append(Text(style, text, middle, y - 2.0, middle=True, hint=slot.hint))
        places |= dict.fromkeys(slot.ports, middle)
        left += slot.width + spare + _SOCKET_GAP
    return texts, places


def _heading_width(box: Box, label: str) -> float:
    lines = [width(shortened(line), _SIZES["line"], monospace=True) for line in box.lines]
    return max([width(shortened(label), _SIZES["name"], bold=True), *lines])


def _heading(box: Box, label: str, y: float) -> tuple[list[Text], float]:
    texts = []
    for style, text in [("name", label), *(("line", line) for line in box.lines)]:
        y += _LEADING[style]
        hint = clean(text) if shortened(text) != clean(text) else ""
        texts.append(Text(style, shortened(text), PADDING, y - 3.0, hint=hint))
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
