"""A picture as SVG: boxes in layers from the top, arrows downwards, light and dark."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from importlib.resources import files
from itertools import pairwise
from math import copysign

from nodegraph.draw.layering import Point
from nodegraph.draw.layout import LABEL_HEIGHT, PADDING, FrameBox, layout
from nodegraph.draw.picture import Arrow, Picture
from nodegraph.draw.shape import CHIP_HEIGHT, Chip, Shape, Text, escaped, shortened, width

HEAD_LENGTH = 8.0
_HEAD_HALF = 4.2
_STRANDS = (-5.0, 5.0, 0.0)
_MEETING = 14.0
_CORNER = 7.0


def number(value: float) -> str:
    """Return a length with one decimal, or none if it is whole."""
    return f"{round(value, 1) + 0.0:.1f}".removesuffix(".0")


def tag(name: str, text: str) -> str:
    """Return an element that holds only text."""
    return f"<{name}>{escaped(text)}</{name}>"


def line(points: Sequence[Point]) -> str:
    """Return the path of an arrow through its points.

    Between points below or beside each other it is straight, with round corners, else a curve
    that begins and ends downwards. The last point is the tip; the line ends where the head begins.
    """
    (tip_x, tip_y), rest = points[-1], points[:-1]
    return _path([*rest, (tip_x, tip_y - HEAD_LENGTH + 1.0)])


def fan(points: Sequence[Point]) -> str:
    """Return several such lines that run side by side and meet shortly before the tip."""
    tip_x, tip_y = points[-1]
    end = [(tip_x, tip_y - _MEETING), (tip_x, tip_y)]
    return "".join(line([*_beside(points, strand)[:-1], *end]) for strand in _STRANDS)


def _beside(points: Sequence[Point], right: float) -> list[Point]:
    """Return the points moved sideways, to the right of a line that runs down."""
    moved = []
    ways = [_way(begin, other) for begin, other in pairwise(points)]
    for (x, y), before, after in zip(points, [ways[0], *ways], [*ways, ways[-1]], strict=True):
        down = before[1] or after[1]
        aside = before[0] or after[0]
        moved.append((x + right * down, y - right * aside))
    return moved


def _way(begin: Point, other: Point) -> tuple[float, float]:
    """Return the direction in which a line leaves and reaches its ends."""
    if begin[1] == other[1]:
        return copysign(1.0, other[0] - begin[0]), 0.0
    return 0.0, copysign(1.0, other[1] - begin[1])


def _path(points: Sequence[Point]) -> str:
    points = _without_stops(points)
    path = [f"M{_pair(points[0])}"]
    for before, point, after in zip(points, points[1:], [*points[2:], None], strict=False):
        if before[0] != point[0] and before[1] != point[1]:
            half = (point[1] - before[1]) / 2
            bends = ((before[0], before[1] + half), (point[0], point[1] - half), point)
            path.append("C" + " ".join(_pair(bend) for bend in bends))
        elif after is None or not _is_corner(before, point, after):
            path.append(f"L{_pair(point)}")
        else:
            begin, end = _towards(point, before), _towards(point, after)
            path.append(f"L{_pair(begin)}Q{_pair(point)} {_pair(end)}")
    return "".join(path)


def _without_stops(points: Sequence[Point]) -> list[Point]:
    """Return the points without those that a straight line passes anyway."""
    corners = [points[0]]
    for point, after in zip(points[1:], [*points[2:], None], strict=True):
        before = corners[-1]
        passes = after is not None and (
            before[0] == point[0] == after[0] or before[1] == point[1] == after[1]
        )
        if point != before and not passes:
            corners.append(point)
    return corners


def _is_corner(before: Point, point: Point, after: Point) -> bool:
    return (before[0] == point[0] and point[1] == after[1]) or (
        before[1] == point[1] and point[0] == after[0]
    )


def _towards(point: Point, other: Point) -> Point:
    """Return the place on the way to another point where a corner's rounding begins."""
    x, y = other[0] - point[0], other[1] - point[1]
    share = min(_CORNER / (abs(x) + abs(y)), 0.5)
    return point[0] + x * share, point[1] + y * share


def _pair(point: Point) -> str:
    return f"{number(point[0])} {number(point[1])}"


def head(x: float, y: float) -> str:
    """Return an arrow head whose tip is at a point, from above."""
    left, right, base = number(x - _HEAD_HALF), number(x + _HEAD_HALF), number(y - HEAD_LENGTH)
    return f'<path class="head" d="M{left} {base}H{right}L{number(x)} {number(y)}Z"/>'


_SAMPLE = 30.0
_HEIGHT = 20.0
_SIZE = 11.0


def legend(picture: Picture, left: float, top: float) -> tuple[str, float, float]:
    """Return the legend, how far to the right it reaches, and how far down."""
    entries = _entries(picture)
    if not entries:
        return "", left, top - 18.0
    x, y = left, top + 12.0
    parts = ['<g class="legend">']
    for sample, text in entries:
        parts.append(f'<g transform="translate({number(x)} {number(y)})">{sample}</g>')
        parts.append(
            f'<text x="{number(x + _SAMPLE + 7)}" y="{number(y + 4)}">{escaped(text)}</text>'
        )
        x += _SAMPLE + 7 + width(text, _SIZE) + 18.0
    return "".join([*parts, "</g>"]), x - 18.0, top + _HEIGHT


def _entries(picture: Picture) -> list[tuple[str, str]]:
    entries = []
    if any(arrow.truth for arrow in picture.arrows):
        entries.append(('<g class="truth"><path class="wire" d="M0 0H30"/></g>', "truth"))
    if any(arrow.gathers for arrow in picture.arrows):
        lines = "M0 -5C12 -5 16 0 22 0M0 5C12 5 16 0 22 0M0 0H30"
        entries.append((f'<g class="gathers"><path class="wire" d="{lines}"/></g>', "gathers"))
    for style, radius, text in (("alternative", 5, "alternatives"), ("axis", 7, "axes")):
        if any(box.alternatives if style == "alternative" else box.axes for box in picture.boxes):
            rect = f'<rect x="2" y="-7" width="26" height="14" rx="{radius}"/>'
            entries.append((f'<g class="chip {style}">{rect}</g>', text))
    return entries


_MARGIN = 16.0
_SMALLEST_SCALE = 0.6


def svg(picture: Picture) -> str:
    """Return the picture as SVG, for a file of its own or inside a page.

    Boxes stand in layers, so that every arrow runs downwards; a tall picture is folded into
    columns, and an arrow to the next column runs around. None runs through a box. Boxes whose
    dotted names have a common prefix stand in a frame. Truth is dashed, a gathering arrow is a
    fan of several lines that meet. Colours follow the reader's light or dark scheme; a page
    sets ``--picture-paper`` and ``--picture-face`` to fit its own.

    Raises
    ------
    ValueError
        If arrows form a cycle.
    """
    drawing = layout(picture)
    meeting = Counter((arrow.target, arrow.target_port) for arrow in picture.arrows)
    arrows = [
        _arrow(arrow, points, alone=meeting[arrow.target, arrow.target_port] == 1)
        for arrow, points in zip(picture.arrows, drawing.routes, strict=True)
    ]
    frames = [_frame(frame) for frame in drawing.frames]
    boxes = [_box(shape, x, y) for shape, (x, y) in drawing.boxes]
    explained, wide, high = legend(picture, 0.0, drawing.height + 18.0)
    return _document(picture, [*frames, *arrows, *boxes, explained], max(drawing.width, wide), high)


def _document(picture: Picture, parts: Sequence[str], width: float, height: float) -> str:
    style = files("nodegraph.draw").joinpath("picture.css").read_text(encoding="utf-8")
    wide, high = round(width + 2 * _MARGIN), round(height + 2 * _MARGIN)
    least = round(wide * _SMALLEST_SCALE)
    begin = (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="nodegraph-picture" role="img"'
        f' width="{wide}" height="{high}" viewBox="0 0 {wide} {high}"'
        f' style="max-width: 100%; min-width: {least}px; height: auto">'
    )
    paper = f'<rect class="paper" width="{wide}" height="{high}"/>'
    inside = f'<g transform="translate({number(_MARGIN)} {number(_MARGIN)})">'
    title = tag("title", picture.title or "graph") + tag("desc", _description(picture))
    return "\n".join(
        [begin, title, f"<style>\n{style}</style>", paper, inside, *parts, "</g>", "</svg>\n"]
    )


def _description(picture: Picture) -> str:
    boxes = "; ".join(" ".join((box.name, *box.lines)) for box in picture.boxes)
    arrows = "; ".join(str(arrow) for arrow in picture.arrows)
    return f"Nodes: {boxes}. Arrows: {arrows or 'none'}."


def _frame(frame: FrameBox) -> str:
    size = f'width="{number(frame.width)}" height="{number(frame.height)}" rx="12"'
    return (
        f'<g class="around" data-frame="{escaped(frame.name)}"'
        f' transform="translate({number(frame.x)} {number(frame.y)})">{tag("title", frame.name)}'
        f'<rect {size}/><text class="label" x="{number(PADDING)}" y="{number(LABEL_HEIGHT - 7)}">'
        f"{escaped(shortened(frame.label))}</text></g>"
    )


def _arrow(arrow: Arrow, points: Sequence[Point], *, alone: bool) -> str:
    path = fan(points) if arrow.gathers and alone else line(points)
    styles = "arrow" + " truth" * arrow.truth + " gathers" * arrow.gathers
    return (
        f'<g class="{styles}" data-arrow="{escaped(_ends(arrow))}">{tag("title", str(arrow))}'
        f'<path class="wire" d="{path}"/>{head(*points[-1])}</g>'
    )


def _ends(arrow: Arrow) -> str:
    return f"{arrow.source}.{arrow.source_port} {arrow.target}.{arrow.target_port}"


def _box(shape: Shape, x: float, y: float) -> str:
    radius = 18 if shape.box.kind == "input" else 9
    size = f'width="{number(shape.width)}" height="{number(shape.height)}" rx="{radius}"'
    parts = [
        f'<g class="box box-{shape.box.kind}" data-box="{escaped(shape.box.name)}"'
        f' transform="translate({number(x)} {number(y)})">',
        tag("title", " ".join((shape.box.name, *shape.box.lines))),
        f'<rect class="shade" y="2" {size}/><rect class="frame" {size}/>',
    ]
    for rule in shape.rules:
        parts.append(
            f'<line class="rule" x1="1" x2="{number(shape.width - 1)}"'
            f' y1="{number(rule)}" y2="{number(rule)}"/>'
        )
    parts += [_text(text) for text in shape.texts] + [_chip(chip) for chip in shape.chips]
    return "".join([*parts, "</g>"])


def _text(text: Text) -> str:
    middle = ' text-anchor="middle"' if text.middle else ""
    hint = tag("title", text.hint) if text.hint else ""
    return (
        f'<text class="{text.style}" x="{number(text.x)}" y="{number(text.y)}"{middle}>'
        f"{escaped(text.text)}{hint}</text>"
    )


def _chip(chip: Chip) -> str:
    return (
        f'<g class="chip {chip.style}">{tag("title", chip.hint)}'
        f'<rect x="{number(chip.x)}" y="{number(chip.y)}" width="{number(chip.width)}"'
        f' height="{number(CHIP_HEIGHT)}" rx="{5 if chip.style == "alternative" else 9.5}"/>'
        f'<text x="{number(chip.x + chip.width / 2)}" y="{number(chip.y + 13.3)}"'
        f' text-anchor="middle">{escaped(chip.text)}</text></g>'
    )
