"""A picture as SVG: boxes in layers from the top, arrows downwards, light and dark."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from importlib.resources import files

from nodegraph.draw.cells import Point
from nodegraph.draw.layout import Framed, layout
from nodegraph.draw.legend import legend
from nodegraph.draw.level import LABEL_HEIGHT, PADDING
from nodegraph.draw.marks import fan, head, line, number, tag
from nodegraph.draw.picture import Arrow, Picture
from nodegraph.draw.shape import CHIP_HEIGHT, Chip, Shape, Text
from nodegraph.draw.text import escaped, shortened

_MARGIN = 16.0
_SMALLEST_SCALE = 0.6


def svg(picture: Picture) -> str:
    """Return the picture as SVG, for a file of its own or inside a page.

    Boxes stand in layers, so that every arrow runs downwards; a tall picture is folded into
    columns, and an arrow to the next column runs around. None runs through a box. Boxes whose
    dotted names begin alike stand in a frame. Truth is dashed, a gathering arrow is a fan of
    several lines that meet. Colours follow the reader's light or dark scheme; a page sets
    ``--picture-paper`` and ``--picture-face`` to fit its own.

    Raises
    ------
    ValueError
        If arrows run in a circle.
    """
    found = layout(picture)
    meeting = Counter((arrow.target, arrow.target_port) for arrow in picture.arrows)
    arrows = [
        _arrow(arrow, points, alone=meeting[arrow.target, arrow.target_port] == 1)
        for arrow, points in zip(picture.arrows, found.routes, strict=True)
    ]
    frames = [_frame(one) for one in found.frames]
    boxes = [_box(one, x, y) for one, (x, y) in found.boxes]
    explained, wide, high = legend(picture, 0.0, found.height + 18.0)
    return _document(picture, [*frames, *arrows, *boxes, explained], max(found.width, wide), high)


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


def _frame(one: Framed) -> str:
    size = f'width="{number(one.width)}" height="{number(one.height)}" rx="12"'
    return (
        f'<g class="around" data-frame="{escaped(one.name)}"'
        f' transform="translate({number(one.x)} {number(one.y)})">{tag("title", one.name)}'
        f'<rect {size}/><text class="label" x="{number(PADDING)}" y="{number(LABEL_HEIGHT - 7)}">'
        f"{escaped(shortened(one.label))}</text></g>"
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


def _box(one: Shape, x: float, y: float) -> str:
    radius = 18 if one.box.kind == "input" else 9
    size = f'width="{number(one.width)}" height="{number(one.height)}" rx="{radius}"'
    parts = [
        f'<g class="box box-{one.box.kind}" data-box="{escaped(one.box.name)}"'
        f' transform="translate({number(x)} {number(y)})">',
        tag("title", " ".join((one.box.name, *one.box.lines))),
        f'<rect class="shade" y="2" {size}/><rect class="frame" {size}/>',
    ]
    for rule in one.rules:
        parts.append(
            f'<line class="rule" x1="1" x2="{number(one.width - 1)}"'
            f' y1="{number(rule)}" y2="{number(rule)}"/>'
        )
    parts += [_text(text) for text in one.texts] + [_chip(chip) for chip in one.chips]
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
