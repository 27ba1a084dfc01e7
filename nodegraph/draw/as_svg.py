"""A picture as SVG: boxes in layers from the top, arrows downwards, light and dark."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files

from nodegraph.draw.legend import legend
from nodegraph.draw.marks import fan, head, number, smooth, tag
from nodegraph.draw.net import Net, net
from nodegraph.draw.order import ordered
from nodegraph.draw.picture import Arrow, Picture
from nodegraph.draw.place import placed
from nodegraph.draw.shape import CHIP_HEIGHT, Chip, Shape, Text, shape
from nodegraph.draw.text import escaped

_MARGIN = 16.0
_GAP = 46.0
_WIDEST_GAP = 120.0
_SMALLEST_SCALE = 0.6


@dataclass(frozen=True, slots=True)
class _Band:
    """From where to where a layer's boxes reach."""

    top: float
    bottom: float


def svg(picture: Picture) -> str:
    """Return the picture as SVG, for a file of its own or inside a page.

    Boxes stand in layers, so that every arrow runs downwards; none runs through a box. Truth is
    dashed, a gathering arrow is a fan of several lines that meet. Colours follow the reader's
    light or dark scheme; a page sets ``--picture-paper`` and ``--picture-face`` to fit its own.

    Raises
    ------
    ValueError
        If arrows run in a circle.
    """
    shapes = _shapes(picture)
    cells = net(picture, shapes)
    layers = ordered(cells)
    middles = [x + _MARGIN for x in placed(cells, layers)]
    bands = _bands(cells, layers, middles, shapes)
    arrows = [
        _arrow(arrow, route, shapes, middles, _bands_of(route, layers, bands))
        for arrow, route in zip(picture.arrows, cells.routes, strict=True)
    ]
    tops = {cell: band.top for layer, band in zip(layers, bands, strict=True) for cell in layer}
    boxes = [
        _box(one, middles[index] - one.width / 2, tops[index]) for index, one in enumerate(shapes)
    ]
    right = max((x + w / 2 for x, w in zip(middles, cells.widths, strict=True)), default=0.0)
    explained, wide, high = legend(picture, _MARGIN, (bands[-1].bottom if bands else 0.0) + 18.0)
    return _document(picture, [*arrows, *boxes, explained], max(right, wide) + _MARGIN, high)


def _document(picture: Picture, parts: Sequence[str], width: float, height: float) -> str:
    style = files("nodegraph.draw").joinpath("picture.css").read_text(encoding="utf-8")
    wide, high = round(width), round(height + _MARGIN)
    least = round(wide * _SMALLEST_SCALE)
    begin = (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="nodegraph-picture" role="img"'
        f' width="{wide}" height="{high}" viewBox="0 0 {wide} {high}"'
        f' style="max-width: 100%; min-width: {least}px; height: auto">'
    )
    paper = f'<rect class="paper" width="{wide}" height="{high}"/>'
    title = tag("title", picture.title or "graph") + tag("desc", _description(picture))
    return "\n".join([begin, title, f"<style>\n{style}</style>", paper, *parts, "</svg>\n"])


def _description(picture: Picture) -> str:
    boxes = "; ".join(" ".join((box.name, *box.lines)) for box in picture.boxes)
    arrows = "; ".join(str(arrow) for arrow in picture.arrows)
    return f"Nodes: {boxes}. Arrows: {arrows or 'none'}."


def _shapes(picture: Picture) -> list[Shape]:
    wired: dict[tuple[str, str], list[str]] = {}
    for arrow in picture.arrows:
        wired.setdefault((arrow.source, arrow.source_port), [])
        fixed = wired.setdefault((arrow.target, arrow.target_port), [])
        fixed += [arrow.fixed] if arrow.fixed else []
    by_box: dict[str, dict[str, list[str]]] = {}
    for (name, port), fixed in wired.items():
        by_box.setdefault(name, {})[port] = fixed
    found = [by_box.get(box.name, {}) for box in picture.boxes]
    return [
        shape(box, frozenset(ports), ports) for box, ports in zip(picture.boxes, found, strict=True)
    ]


def _bands(
    cells: Net, layers: Sequence[Sequence[int]], middles: Sequence[float], shapes: Sequence[Shape]
) -> list[_Band]:
    """Return where each layer stands; the gap grows with how far its arrows run sideways."""
    bands = []
    y = _MARGIN
    for layer, gap in zip(layers, cells.gaps, strict=True):
        heights = [shapes[cell].height for cell in layer if cell < len(shapes)]
        bands.append(_Band(y, y + max(heights)))
        sideways = max((abs(middles[one.upper] - middles[one.lower]) for one in gap), default=0.0)
        y = bands[-1].bottom + min(_GAP + 0.12 * sideways, _WIDEST_GAP)
    return bands


def _bands_of(
    route: Sequence[int], layers: Sequence[Sequence[int]], bands: Sequence[_Band]
) -> list[_Band]:
    first = next(number for number, layer in enumerate(layers) if route[0] in layer)
    return list(bands[first : first + len(route)])


def _arrow(
    arrow: Arrow,
    route: Sequence[int],
    shapes: Sequence[Shape],
    middles: Sequence[float],
    bands: Sequence[_Band],
) -> str:
    source, target = shapes[route[0]], shapes[route[-1]]
    xs = [middles[cell] for cell in route]
    xs[0] += source.outputs[arrow.source_port] - source.width / 2
    xs[-1] += target.inputs[arrow.target_port] - target.width / 2
    points = [(xs[0], bands[0].top + source.height), (xs[0], bands[0].bottom)]
    for x, band in zip(xs[1:-1], bands[1:-1], strict=True):
        points += [(x, band.top), (x, band.bottom)]
    points.append((xs[-1], bands[-1].top))
    path = fan(points) if arrow.gathers else smooth(points)
    styles = "arrow" + " truth" * arrow.truth + " gathers" * arrow.gathers
    return (
        f'<g class="{styles}" data-arrow="{escaped(_ends(arrow))}">{tag("title", str(arrow))}'
        f'<path class="wire" d="{path}"/>{head(xs[-1], bands[-1].top)}</g>'
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
