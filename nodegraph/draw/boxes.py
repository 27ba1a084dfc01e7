"""Size of a box, and the positions of its texts, chips and ports."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from html import escape
from itertools import chain, repeat
from textwrap import wrap
from typing import NamedTuple

from nodegraph.draw.picture import BETWEEN_PARTS, Alternative, Axis, Box, Socket

_NOT_XML = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
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

_Parts = tuple[tuple[str, float, float, str], ...]
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
_STATE = 60.0
"""Room for how far the combinations of an alternative are, at the end of its row."""
_LONGEST_IN_ROW = 40
_LONGEST_BESIDE_LABEL = 49
_MOST_ROWS = 10
_WIDEST_ROWS = 600.0
_NARROWEST = 84.0
_LONGEST_NOTE = 28
_LEAST_LINE = 155.0
"""Width of settings, and of what a box does, where nothing else makes the box wider."""
_LONGEST_AXIS = 34
_LONGEST_VALUE = 18
_LINE = 14.0
_BASELINE = 13.3
_MOST_LINES = 5
_LONGEST_AT_PORT = 26
_LONGEST_BESIDE = 32
_NARROWEST_COLUMN = 200.0
_BETWEEN_COLUMNS = 20.0
_INDENT = 10.0
_BETWEEN_SIDES = 18.0
_SIZES = {"port": 12.0, "note": 11.0, "name": 15.0, "line": 11.5, "does": 11.5, "chip": 11.0}
_LEADING = {"port": 16.0, "note": 13.5, "name": 19.0, "line": 16.0, "does": 14.5}

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
    texts : tuple of (str, float, float, str)
        Each with the distances of its start and its baseline from the corner, and its style.
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
        How far from the top the port's arrows end or begin; with `row_port` of the alternatives
        that have a source of their own.
    """

    box: Box
    width: float
    height: float
    texts: tuple[Text, ...]
    chips: tuple[Chip, ...]
    rule: float
    inputs: Mapping[str, float]
    outputs: Mapping[str, float]


def row_port(alternative: Alternative) -> str:
    """Return what a row is called among the inputs of a shape, which no port is called."""
    return f" {alternative.label}"


@_cached
def shape(
    box: Box,
    label: str,
    fixed: Notes = (),
    sources: Notes = (),
    readers: Notes = (),
    *,
    states: bool = False,
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
    states
        Whether rows of alternatives have room for their states in a run.
    """
    common = _common(fixed)
    into = [
        (
            socket,
            [
                f"all {socket.gathers}" if socket.gathers else "",
                f"from {', '.join(names)}" if (names := _of(socket, sources)) else "",
                *(_at(text, common) for text in _of(socket, fixed)),
            ],
        )
        for socket in box.inputs
    ]
    out = [
        (socket, [f"to {', '.join(names)}"] if (names := _of(socket, readers)) else [])
        for socket in box.outputs
    ]
    alternatives, columns = _columns(box.alternatives, states=states)
    widths = [max(wide for _, wide, _ in column) for column in columns]
    axes = [_axis(axis) for axis in box.axes]
    least = max(
        _NARROWEST,
        _wide("name", label),
        sum(widths) + _CHIP_GAP * (len(widths) - 1),
        *(wide for _, wide, _ in axes),
    )
    inputs, outputs = _side(into), _side(out, at_end=True)
    inner = max(least, _beside(inputs.lines, outputs.lines))
    notes = [("note", line) for line in _wrapped(_at(", ".join(common)), _LONGEST_NOTE)]
    lines = [*_told(box, max(inner, _LEAST_LINE))]
    if len(out) > 1 and not into:
        free = least - _BETWEEN_SIDES - _beside((), outputs.lines)
        told, lines = [*_told(box, max(free, _LEAST_LINE))], []
        inputs = _Side(_stacked(told, 0.0, 2.5), {}, _height(told))
        inner = max(inner, _beside(inputs.lines, outputs.lines))
    inner = max([inner, *(_wide(*line) for line in (*notes, *lines))])
    texts = _stacked([("name", label)], INSET, 4.0)
    top = 4.0 + _LEADING["name"]
    for x, side in ((INSET, inputs), (INSET + inner, outputs)):
        texts += [replace(line, x=x + line.x, y=top + line.y) for line in side.lines]
    ins, outs = (
        {name: top + height for name, height in side.heights.items()} for side in (inputs, outputs)
    )
    y = top + max(inputs.height, outputs.height)
    texts += _stacked(notes, INSET, y)
    rule = y + _LEADING["note"] * len(notes) + 6.0
    texts += _stacked(lines, INSET, rule + 3.0)
    high = max([0.0, *(sum(high + _ROW_GAP for *_, high in column) for column in columns)])
    first_row = rule + _height(lines) + _CHIP_GAP
    y = max(rule + _height(lines), (first_row + high - _ROW_GAP) * bool(columns))
    chips: list[Chip] = []
    x, top = inner + 1.0, y
    for axis, (parts, wide, count) in zip(box.axes, axes, strict=True):
        high = CHIP_HEIGHT + (count - 1) * _LINE
        if x + wide > inner or count > 1:
            x, top = 0.0, y + _CHIP_GAP
        chips.append(Chip("axis", parts, INSET + x, top, wide, high, str(axis)))
        x += wide + _CHIP_GAP
        y = max(y, top + high)
    free = inner - sum(widths) - _CHIP_GAP * (len(widths) - 1)
    each_row = iter(alternatives)
    left = INSET
    for column, narrowest in zip(columns, widths, strict=True):
        wide = narrowest + free / len(widths)
        top = first_row
        for parts, _, high in column:
            each = next(each_row)
            if each.source:
                ins[row_port(each)] = top + CHIP_HEIGHT / 2
            chips.append(Chip("alternative", parts, left, top, wide, high, str(each), each.label))
            top += high + _ROW_GAP
        left += wide + _CHIP_GAP
    high = y + (8.0 if y > rule else 0.0)
    return Shape(box, inner + 2 * INSET, high, tuple(texts), tuple(chips), rule, ins, outs)


_Row = tuple[_Parts, float, float]
"""The texts of the row of an alternative, and how wide and how high it is."""


def _columns(
    alternatives: Sequence[Alternative], *, states: bool
) -> tuple[Sequence[Alternative], list[list[_Row]]]:
    """Return alternatives, and their rows in columns: as many as are wanted and not too wide."""
    count = -(-len(alternatives) // _MOST_ROWS)
    if count > 1:  # arrows reach only the rows on the left
        alternatives = sorted(alternatives, key=lambda each: not each.source)
    rows = [_row(each, states=states) for each in alternatives]
    columns = [rows] * bool(rows)
    for number in range(count, 1, -1):
        high = max(-(-len(rows) // number), sum(bool(each.source) for each in alternatives))
        several = [rows[at : at + high] for at in range(0, len(rows), high)]
        if sum(max(wide for _, wide, _ in column) for column in several) <= _WIDEST_ROWS:
            columns = several
            break
    return alternatives, columns


def panel(box: Box, label: str, sources: Notes, wide: float) -> Shape:
    """Return what the report shows, in columns, below the boxes that it is made from."""
    groups = [(_of(socket, sources), socket.items) for socket in box.inputs]
    groups += [([], box.lines)] if box.lines else []
    count = max(1, min(len(groups), int(wide / _NARROWEST_COLUMN)))
    column = (wide - 2 * INSET + _BETWEEN_COLUMNS) / count
    texts = [Text("name", label, INSET, 20.0)]
    top = bottom = 27.0
    for at, (names, items) in enumerate(groups):
        if at % count == 0:
            top = bottom
        x, y = INSET + at % count * column, top
        lines = [("note", f"from {', '.join(names)}")] if names else []
        for style, text in (*lines, *zip(repeat("port"), items)):
            y += 3.0 if style == "port" else 0.0
            longest = int((column - _BETWEEN_COLUMNS) / _SIZES[style] / 0.6)
            for number, line in enumerate(wrap(clean(text), longest)):
                y += _LEADING[style]
                texts.append(Text(style, line, x + _INDENT * (number > 0), y - 3.5))
        bottom = max(bottom, y + 8.0)
    return Shape(box, wide, bottom, tuple(texts), (), 0.0, {}, {})


class _Side(NamedTuple):
    """The ports on one side of a box, measured from the line above them."""

    lines: list[Text]
    heights: dict[str, float]
    height: float


def _side(ports: Iterable[tuple[Socket, list[str]]], *, at_end: bool = False) -> _Side:
    """Return ports with notes, the first beside its port if both have not too many characters."""
    lines, heights = list[Text](), dict[str, float]()
    y = 0.0
    for socket, notes in ports:
        y += 3.0
        heights[socket.name] = y + _LEADING["port"] / 2
        own = [*filter(None, dict.fromkeys(notes))]
        hint = "; ".join([str(socket), *own])
        below = [line for text in own for line in _wrapped(text, _LONGEST_AT_PORT)]
        texts = [("port", socket.text, 0.0, _LEADING["port"])] if socket.text or not own else []
        texts += [("note", line, 0.0, _LEADING["note"]) for line in below]
        if socket.text and own and len(f"{socket.text} {own[0]}") <= _LONGEST_BESIDE:
            shift = _CHIP_GAP + _wide(*texts[at_end][:2])
            begin, end = (-shift, 0.0) if at_end else (0.0, shift)
            texts[:2] = (*texts[0][:2], begin, texts[0][3]), (*texts[1][:2], end, 0.0)
        y += _LEADING["port"] - texts[0][3]
        for style, text, x, leading in texts:
            y += leading
            if text:
                lines.append(Text(style, shortened(text), x, y - 3.5, hint, at_end))
    return _Side(lines, heights, y)


def _stacked(lines: Iterable[tuple[str, str]], x: float, y: float) -> list[Text]:
    """Return lines one below the other."""
    texts = list[Text]()
    for style, text in lines:
        y += _LEADING[style]
        hint = clean(text) if shortened(text) != clean(text) else ""
        texts.append(Text(style, shortened(text), x, y - 3.0, hint))
    return texts


def _height(lines: Sequence[tuple[str, str]]) -> float:
    return sum(_LEADING[style] for style, _ in lines) + 3.0 * bool(lines)


def _wide(style: str, text: str) -> float:
    return width(shortened(text), _SIZES[style], bold=style == "name", monospace=style == "line")


def _beside(left: Iterable[Text], right: Sequence[Text]) -> float:
    """Return how wide the texts of ports are, with those of the other side at their height."""
    widths = {each: abs(each.x) + _wide(each.style, each.text) for each in (*left, *right)}
    beside = (
        widths[one] + _BETWEEN_SIDES + widths[other]
        for one in left
        for other in right
        if abs(one.y - other.y) < _LEADING["note"]
    )
    return max([0.0, *widths.values(), *beside])


def _row(alternative: Alternative, *, states: bool) -> _Row:
    """Return the row of an alternative; details that are long stand below its label."""
    label = shortened(alternative.label)
    beside = _CHIP_INSET + width(label, _SIZES["chip"]) + _CHIP_GAP
    settings, source = (_wrapped(text, _LONGEST_IN_ROW) for text in alternative.details)
    details = [[("setting", text)] for text in settings]
    if settings and source and len(settings[-1] + source[0]) < _LONGEST_IN_ROW:
        details[-1].append(("note", source[0]))
        source = source[1:]
    details += [[("note", text)] for text in source]
    longest = max((sum(len(text) for _, text in line) for line in details), default=0)
    is_long = len(label) + longest > _LONGEST_BESIDE_LABEL
    parts = [(label, _CHIP_INSET, _BASELINE, "name")]
    wide = beside
    for at, line in enumerate(details, is_long):
        x = 2.0 * _CHIP_INSET if is_long else beside
        for style, text in line:
            parts.append((text, x, _BASELINE + at * _LINE, style))
            x += width(text, _SIZES["chip"]) + _CHIP_GAP
        wide = max(wide, x - _CHIP_GAP)
    high = CHIP_HEIGHT + (len(details) - 1 + is_long) * _LINE * bool(details)
    return tuple(parts), wide + (_STATE if states else _CHIP_GAP), high


def _axis(axis: Axis) -> tuple[_Parts, float, int]:
    """Return the texts of an axis, how wide they are, and how many lines they have.

    They are a table where its labels stand for settings.
    """
    size = _SIZES["chip"]
    table: list[tuple[str, ...]] = [(text,) for text in _wrapped(str(axis), _LONGEST_AXIS)]
    if axis.values:
        table = [(axis.name, *axis.settings), *axis.values]
    parts: list[tuple[str, float, float, str]] = []
    x = 0.0
    for place, column in enumerate(zip(*table, strict=True)):
        texts = [shortened(text, _LONGEST_VALUE) if place else text for text in column]
        x += _CHIP_INSET
        style = "note" if place else "name"
        parts += [(text, x, _BASELINE + at * _LINE, style) for at, text in enumerate(texts)]
        x += max(width(text, size, bold=place == 0) for text in texts)
    return tuple(parts), x + _CHIP_INSET, len(table)


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


def _told(box: Box, wide: float) -> Iterator[tuple[str, str]]:
    """Yield what a box tells of itself, in lines: its method, what that does, and settings."""
    does = (("does", line) for line in wrap(clean(box.does), min(40, int(wide / 6.5))))
    longest = int(wide / _SIZES["line"] / _MONOSPACE)
    lines = (("line", line) for text in box.settings for line in _wrapped(text, longest))
    return chain([("line", box.method)] * bool(box.method), does, lines)


@_cached
def _wrapped(text: str, longest: int) -> tuple[str, ...]:
    """Return a text in lines, of parts that are whole; the last is cut where there are more."""
    parts = BETWEEN_PARTS.split(clean(text))
    lines = wrap(
        " ".join(
            part if len(part) > longest else part.replace(" ", "\N{NO-BREAK SPACE}")
            for part in parts
        ),
        longest,
        max_lines=_MOST_LINES,
        placeholder=" …",
        break_on_hyphens=False,
        break_long_words=False,
    )
    whole = (line.replace("\N{NO-BREAK SPACE}", " ") for line in lines)
    return tuple([line.strip(" \N{MIDDLE DOT}") for line in whole])
