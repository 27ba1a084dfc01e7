"""A picture as SVG: boxes in columns, arrows from left to right, light and dark."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from importlib.resources import files
from itertools import pairwise
from math import ceil
from textwrap import wrap

from nodegraph.draw.boxes import INSET, Chip, Shape, Text, clean, escaped, shortened, width
from nodegraph.draw.frames import Frame
from nodegraph.draw.layout import LABEL_HEIGHT, LEAST_WIDTH, PADDING, Point, layout
from nodegraph.draw.picture import Arrow, Box, Picture
from nodegraph.gc_pause import gc_paused

HEAD_LENGTH = 8.0
_HEAD_HALF = 4.2
_WIDE_HALF = 5.4
_LEVEL = 8.0

_LOOK = {
    "paper": 'fill="#ffffff"',
    "shade": 'fill="#17202c" fill-opacity="0.12"',
    "frame": 'fill="#ffffff" stroke="#aeb8c5" stroke-width="1.2"',
    "frame input": 'fill="#f1f4f8" stroke="#aeb8c5" stroke-width="1.2"',
    "frame report": 'fill="#ffffff" stroke="#0b63c4" stroke-width="2.2"',
    "frame compares": 'fill="#ffffff" stroke="#00756b" stroke-width="2.2"',
    "rule": 'fill="none" stroke="#e4e8ee"',
    "around": 'fill="#7f8fa4" fill-opacity="0.08" stroke="#aeb8c5" stroke-dasharray="2 3"',
    "wire": 'fill="none" stroke="#6c7889" stroke-width="1.6" stroke-linecap="round"',
    "wire truth": 'fill="none" stroke="#a04a00" stroke-width="1.6" stroke-dasharray="6 4.5"',
    "wire truth gathers": 'fill="none" stroke="#a04a00" stroke-width="2.8" stroke-dasharray="6 5"',
    "wire gathers": 'fill="none" stroke="#6c7889" stroke-width="2.8" stroke-linecap="round"',
    "listed": 'fill="#0b63c4"',
    "head": 'fill="#6c7889"',
    "head truth": 'fill="#a04a00"',
    "name": 'font-size="15" font-weight="650"',
    "line": 'font-size="11.5" fill="#5b6675" font-family="monospace"',
    "does": 'font-size="11.5" fill="#5b6675"',
    "setting": 'font-size="11" fill="#5b6675"',
    "port": 'font-size="12"',
    "note": 'font-size="11" fill="#0b63c4"',
    "label": 'font-size="13" font-weight="650" fill="#5b6675"',
    "chip alternative": 'fill="#f1f4f8" stroke="#aeb8c5" stroke-width="0.8"',
    "chip axis": 'fill="#e8f1fc"',
    "chip text": 'font-size="11"',
    "chip axis text": 'font-size="11" font-weight="600" fill="#0b63c4"',
    "legend": 'font-size="11" fill="#5b6675"',
    "heading": 'font-size="16" font-weight="650"',
}
"""Sizes, and light colours for programs that do not read `picture.css`."""
_COLOURS = ("#5b6675", "#00756b", "#8430b0", "#b8225f", "#3d7a1f", "#2f5fd0", "#7d6200")
"""Of sockets: of types that have no mark of their own, then of those that have one."""


@lru_cache(10_000)
def number(value: float) -> str:
    """Return a length with one decimal, or none if it is whole."""
    return f"{round(value, 1) + 0.0:.1f}".removesuffix(".0")


def tag(name: str, text: str) -> str:
    """Return an element that holds only text."""
    return f"<{name}>{escaped(text)}</{name}>"


def line(points: Sequence[Point]) -> str:
    """Return the path of an arrow; the last point is the tip, the line ends where the head begins.

    It is straight between points of one height, or one above the other, else a curve that begins
    and ends level, past the ends of other arrows.
    """
    *before, (tip_x, tip_y) = points
    path = f"M{_pair(points[0])}"
    for (x, y), (to_x, to_y) in pairwise([*before, (tip_x - HEAD_LENGTH + 1.0, tip_y)]):
        if y == to_y or x == to_x:
            path += f"L{_pair((to_x, to_y))}" if (x, y) != (to_x, to_y) else ""
        else:
            begin, end = x + _LEVEL, max(to_x - _LEVEL, x + _LEVEL)
            middle = (begin + end) / 2
            path += f"L{_pair((begin, y))}C{_pair((middle, y))} {_pair((middle, to_y))}"
            path += f" {_pair((end, to_y))}L{_pair((to_x, to_y))}"
    return path


def _pair(point: Point) -> str:
    return f"{number(point[0])} {number(point[1])}"


def head(x: float, y: float, *, truth: bool, gathers: bool) -> str:
    """Return an arrow head whose tip is at a point, from the left."""
    half = _WIDE_HALF if gathers else _HEAD_HALF
    above, below, base = number(y - half), number(y + half), number(x - HEAD_LENGTH)
    look = _LOOK["head truth" if truth else "head"]
    return (
        f'<path class="head" {look} d="M{base} {above}L{base} {below}L{number(x)} {number(y)}Z"/>'
    )


def _marks(picture: Picture) -> dict[str, int]:
    """Return the mark of each type, in the order in which the boxes have them; 0 for any other."""
    sockets = (socket for box in picture.boxes for socket in (*box.inputs, *box.outputs))
    types = dict.fromkeys(socket.value for socket in sockets if socket.type)
    return {name: mark if mark < len(_COLOURS) else 0 for mark, name in enumerate(types, 1)}


def _socket(mark: int, x: float, y: float, *, truth: bool, port: str = "") -> str:
    """Return a mark whose shape and colour tell a type; it is hollow for the truth."""
    wide = f'stroke="{_COLOURS[mark]}" stroke-width="1.6"'
    look = f'fill="#ffffff" {wide}' if truth else f'fill="{_COLOURS[mark]}"'
    begin = f'class="socket type-{mark}{" truth" * truth}"{port} {look}'
    if mark < 3:
        half = (2.6, 3.7, 3.3)[mark]
        place = f'x="{number(x - half)}" y="{number(y - half)}"'
        size = f'width="{number(2 * half)}" height="{number(2 * half)}"'
        round_by = f' rx="{number(half)}"' if mark == 1 else ""
        return f"<rect {begin} {place} {size}{round_by}/>"
    corners = [(x + right, y + down) for right, down in _CORNERS[mark]]
    return f'<path {begin} d="M{"L".join(map(_pair, corners))}Z"/>'


def _dot(x: float, y: float) -> str:
    """Return the mark of an output that the report shows."""
    place = f'x="{number(x - 3.5)}" y="{number(y - 3.5)}" width="7" height="7" rx="3.5"'
    return f'<rect class="listed" {_LOOK["listed"]} {place}/>'


_CORNERS: Mapping[int, Sequence[Point]] = {
    3: [(0, -4.6), (4.6, 0), (0, 4.6), (-4.6, 0)],
    4: [(-3.4, -4.2), (4.4, 0), (-3.4, 4.2)],
    5: [(-4.3, -3.4), (4.3, -3.4), (0, 4.4)],
    6: [(-1.8, -4.2), (1.8, -4.2), (4.4, 0), (1.8, 4.2), (-1.8, 4.2), (-4.4, 0)],
}
"""Of a diamond, triangles to the right and down, and a hexagon; before them stand a small square,
a circle and a square."""

_Samples = list[tuple[str, str]]
"""What is drawn in the legend, each with its meaning."""


def _styles(picture: Picture, drawn: Sequence[Arrow]) -> _Samples:
    """Return samples of arrows, chips and frames that the picture has."""
    samples = []
    for kind, text in (("truth", "truth"), ("gathers", "gathers several values")):
        if any(getattr(arrow, kind) for arrow in drawn):
            look = _LOOK[f"wire {kind}"]
            path = f'<path class="wire" {look} d="M0 0L30 0"/>'
            samples.append((f'<g class="{kind}">{path}</g>', text))
    if len(drawn) < len(picture.arrows):
        text = f'<text class="note" {_LOOK["note"]} x="-4" y="4">from a</text>'
        samples.append((text, "read from box a"))
    if any(box.axes for box in picture.boxes):
        rect = f'<rect {_LOOK["chip axis"]} x="2" y="-7" width="26" height="14" rx="7"/>'
        samples.append((f'<g class="chip axis">{rect}</g>', "what is varied"))
    if any(box.is_list for box in picture.boxes):
        samples.append((_dot(20, 0), "in the report"))
    for kind, text, radius in (
        ("input", "data", 7),
        ("compares", "compares alternatives", 3),
        ("report", "in the report", 3),
    ):
        if any(_look(box) == kind and not box.is_list for box in picture.boxes):
            place = f'x="2" y="-7" width="26" height="14" rx="{radius}"'
            rect = f'<rect class="frame" {_LOOK[f"frame {kind}"]} {place}/>'
            samples.append((f'<g class="box-{kind}">{rect}</g>', text))
    return samples


def _types(picture: Picture, marks: Mapping[str, int]) -> _Samples:
    """Return samples of sockets."""
    samples = [(_socket(mark, 22, 0, truth=False), name) for name, mark in marks.items() if mark]
    if 0 in marks.values():
        samples.append((_socket(0, 22, 0, truth=False), "other types"))
    sockets = (socket for box in picture.boxes for socket in (*box.inputs, *box.outputs))
    if marks and any(socket.truth for socket in sockets):
        samples.append((_socket(1, 22, 0, truth=True), "hollow: the truth"))
    return samples


def _legend(paragraphs: Iterable[_Samples], widest: float, top: float) -> tuple[str, float, float]:
    """Return the legend, how far to the right it reaches, and how far down."""
    parts = []
    reach, y = 0.0, top + 12.0
    for samples in filter(None, paragraphs):
        widths = [55.0 + width(text, 11.0) for _, text in samples]
        lines = ceil(sum(widths) / widest)
        x, full = 0.0, (sum(widths) + max(widths) * (lines > 1)) / lines
        for (sample, text), wide in zip(samples, widths, strict=True):
            if x + wide > full:
                x, y = 0.0, y + 22.0
            parts.append(f'<g transform="translate({number(x)} {number(y)})">{sample}</g>')
            place = f'x="{number(x + 37)}" y="{number(y + 4)}"'
            parts.append(f"<text {_LOOK['legend']} {place}>{escaped(text)}</text>")
            x += wide
            reach = max(reach, x - 18.0)
        y += 22.0
    if not parts:
        return "", 0.0, top - 18.0
    return f'<g class="legend">{"".join(parts)}</g>', reach, y - 14.0


_MARGIN = 10.0
_SMALLEST_SCALE = 0.6
_LINE = 21.0
"""Height of a line above the boxes."""


@gc_paused()
def svg(picture: Picture, *, sockets: bool = False, heading: bool = True) -> str:
    """Return the picture as SVG, for a file of its own or inside a page.

    Boxes stand in columns, wrapped like lines of text, and what the report lists below all. Boxes
    whose dotted names have a common prefix stand in a frame. Truth is dashed, a gathering arrow is
    wide. Types of ports show on hover. Colours follow the reader's light or dark scheme; a page
    sets ``--picture-paper`` and ``--picture-face`` to fit its own.

    Parameters
    ----------
    picture
    sockets
        Whether every port has a mark whose shape and colour tell its type, with a legend, and
        rows of alternatives have room for their states in a run.
    heading
        Whether the title and the combinations stand above the boxes.

    Raises
    ------
    ValueError
        If arrows form a cycle.
    """
    shapes, placed, routes = layout(picture, states=sockets)
    lines_of = [*zip(picture.arrows, routes, strict=True)]
    arrows = [_arrow(*each) for each in lines_of]
    frames = [_frame(*frame) for frame in placed.frames]
    marks = _marks(picture) if sockets else {}
    lists = {box.name for box in picture.boxes if box.is_list}
    listed = {(each.source, each.source_port) for each in picture.arrows if each.target in lists}
    corners = zip(shapes, placed.corners, strict=True)
    boxes = [_box(shape, *corner, marks, listed) for shape, corner in corners]
    drawn = [arrow for arrow, lines in lines_of if lines]
    samples = _styles(picture, drawn), _types(picture, marks)
    explained, wide, high = _legend(samples, max(placed.width, LEAST_WIDTH), placed.height + 9.0)
    wide = max(placed.width, wide)
    above = _heading(picture, max(wide, LEAST_WIDTH)) if heading else []
    return _document(
        picture, [*above, *frames, *arrows, *boxes, explained], wide, high, _LINE * len(above)
    )


def _heading(picture: Picture, widest: float) -> list[str]:
    """Return the lines above the boxes, the last nearest to them."""
    title, counts = clean(picture.title), clean(picture.combinations)
    lines = [("heading", text) for text in wrap(title, ceil(widest / 10.0))]
    lines += [("port", text) for text in wrap(counts, ceil(widest / 7.0))]
    return [
        f'<text {_LOOK[look]} x="0" y="{number(-_LINE * up - 12.0)}">{escaped(text)}</text>'
        for up, (look, text) in enumerate(reversed(lines))
    ][::-1]


def _document(
    picture: Picture, parts: Sequence[str], width: float, height: float, above: float
) -> str:
    style = files("nodegraph.draw").joinpath("picture.css").read_text(encoding="utf-8")
    wide, high = round(width + 2 * _MARGIN), round(above + height + 2 * _MARGIN)
    least = round(wide * _SMALLEST_SCALE)
    begin = (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="nodegraph-picture" role="img"'
        f' width="{wide}" height="{high}" viewBox="0 0 {wide} {high}"'
        f' style="max-width: 100%; min-width: {least}px">'
    )
    paper = f'<rect class="paper" {_LOOK["paper"]} width="{wide}" height="{high}"/>'
    inside = (
        '<g font-family="DejaVu Sans, Arial, sans-serif" fill="#17202c"'
        f' transform="translate({number(_MARGIN)} {number(_MARGIN + above)})">'
    )
    title = tag("title", picture.title or "graph") + tag("desc", _description(picture))
    return "\n".join(
        [begin, title, f"<style>\n{style}</style>", paper, inside, *parts, "</g>", "</svg>\n"]
    )


def _description(picture: Picture) -> str:
    boxes = "; ".join(" ".join((box.name, *box.texts)) for box in picture.boxes)
    arrows = "; ".join(str(arrow) for arrow in picture.arrows)
    return f"Nodes: {boxes}. Arrows: {arrows or 'none'}."


def _frame(frame: Frame, corner: Point, extent: Point) -> str:
    name = ".".join(frame)
    size = f'width="{number(extent[0])}" height="{number(extent[1])}" rx="12"'
    return (
        f'<g class="around" data-frame="{escaped(name)}"'
        f' transform="translate({_pair(corner)})">{tag("title", name)}'
        f'<rect {_LOOK["around"]} {size}/><text class="label" {_LOOK["label"]}'
        f' x="{number(PADDING)}" y="{number(LABEL_HEIGHT - 7)}">'
        f"{escaped(shortened(frame[-1]))}</text></g>"
    )


def _arrow(arrow: Arrow, lines: Sequence[Sequence[Point]]) -> str:
    styles = " truth" * arrow.truth + " gathers" * arrow.gathers
    look = _LOOK[f"wire{styles}"]
    tips = [head(*points[-1], truth=arrow.truth, gathers=arrow.gathers) for points in lines]
    return (
        f'<g class="arrow{styles}" data-arrow="{escaped(_ends(arrow))}">{tag("title", str(arrow))}'
        f'<path class="wire" {look} d="{"".join(map(line, lines))}"/>{"".join(tips)}</g>'
    )


def _ends(arrow: Arrow) -> str:
    return f"{arrow.source}.{arrow.source_port} {arrow.target}.{arrow.target_port}"


def _look(box: Box) -> str:
    """Return what the frame of a box tells."""
    return "compares" if box.kind == "node" and box.compares else box.kind


def _box(
    shape: Shape,
    x: float,
    y: float,
    marks: Mapping[str, int],
    listed: Collection[tuple[str, str]],
) -> str:
    kind = _look(shape.box)
    radius = 18 if kind == "input" else 9
    look = _LOOK["frame" if kind == "node" else f"frame {kind}"]
    size = f'width="{number(shape.width)}" height="{number(shape.height)}" rx="{radius}"'
    parts = [
        f'<g class="box box-{kind}" data-box="{escaped(shape.box.name)}"'
        f' transform="translate({number(x)} {number(y)})">',
        tag("title", " ".join((shape.box.name, *shape.box.texts))),
        f'<rect class="shade" {_LOOK["shade"]} y="2" {size}/><rect class="frame" {look} {size}/>',
    ]
    if (shape.inputs or shape.outputs) and shape.rule < shape.height:
        parts.append(
            f'<path class="rule" {_LOOK["rule"]}'
            f' d="M{_pair((1, shape.rule))}L{_pair((shape.width - 1, shape.rule))}"/>'
        )
    parts += [_text(text) for text in shape.texts] + [_chip(chip) for chip in shape.chips]
    if marks:
        parts += _sockets(shape, marks)
    parts += [
        _dot(shape.width, height)
        for port, height in shape.outputs.items()
        if (shape.box.name, port) in listed
    ]
    return "".join([*parts, "</g>"])


def _sockets(shape: Shape, marks: Mapping[str, int]) -> Iterator[str]:
    for side, sockets, heights, x in (
        ("input", shape.box.inputs, shape.inputs, INSET / 2 - 0.6),
        ("output", shape.box.outputs, shape.outputs, shape.width - INSET / 2 - 0.6),
    ):
        for socket in sockets:
            port = f' data-{side}="{escaped(socket.name)}"'
            mark = marks.get(socket.value, 0)
            yield _socket(mark, x, heights[socket.name], truth=socket.truth, port=port)


def _text(text: Text) -> str:
    anchor = ' text-anchor="end"' if text.at_end else ""
    hint = tag("title", text.hint) if text.hint else ""
    return (
        f'<text class="{text.style}" {_LOOK[text.style]}'
        f' x="{number(text.x)}" y="{number(text.y)}"{anchor}>'
        f"{escaped(text.text)}{hint}</text>"
    )


def _chip(chip: Chip) -> str:
    looks = {each: f'class="{each}" {_LOOK[each]}' for each in ("note", "setting")}
    looks["name"] = _LOOK.get(f"chip {chip.style} text", _LOOK["chip text"])
    texts = [
        f'<text {looks[style]} x="{number(chip.x + x)}" y="{number(chip.y + y)}">'
        f"{escaped(text)}</text>"
        for text, x, y, style in chip.texts
    ]
    name = f' data-alternative="{escaped(chip.label)}"' if chip.label else ""
    return (
        f'<g class="chip {chip.style}"{name}>{tag("title", chip.hint)}'
        f"<rect {_LOOK[f'chip {chip.style}']}"
        f' x="{number(chip.x)}" y="{number(chip.y)}" width="{number(chip.width)}"'
        f' height="{number(chip.height)}" rx="{5 if chip.style == "alternative" else 9.5}"/>'
        f"{''.join(texts)}</g>"
    )
