"""A picture as PDF: its SVG, drawn by matplotlib from the attributes of the elements."""

from __future__ import annotations

import re
from collections.abc import Iterator
from io import BytesIO
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

from nodegraph.draw.boxes import clean
from nodegraph.draw.picture import Picture
from nodegraph.draw.svg import svg

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.patches import Patch
    from matplotlib.path import Path as MplPath

_SVG = "{http://www.w3.org/2000/svg}"
_PIXELS = 96.0
_POINTS = 0.75
"""Points of a pixel."""

_PLACE = re.compile(r"translate\(([-\d.]+) ([-\d.]+)\)")
_COMMAND = re.compile(r"([MLCZ])([^MLCZ]*)")
_INHERITED = ("fill", "font-family")


def pdf(picture: Picture) -> bytes:
    """Return the picture as a PDF file of one page, light, as large as the SVG.

    Raises
    ------
    ValueError
        If arrows form a cycle.
    """
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    root = ElementTree.fromstring(svg(picture))
    width, height = float(root.attrib["width"]), float(root.attrib["height"])
    figure = Figure(figsize=(width / _PIXELS, height / _PIXELS))
    axis = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0.0, width), ylim=(height, 0.0))
    axis.axis("off")
    for order, (element, x, y, look) in enumerate(_elements(root, 0.0, 0.0, {})):
        kind = element.tag.removeprefix(_SVG)
        if kind == "text":
            _draw_text(axis, order, element.text or "", x, y, look)
        elif kind in ("rect", "path") and look.get("d") != "":
            axis.add_patch(_patch(order, kind, x, y, look))
    file = BytesIO()
    # embedded as outlines of characters, the text can be searched and copied
    with rc_context({"pdf.fonttype": 42}):
        figure.savefig(
            file, format="pdf", metadata={"CreationDate": None, "Title": clean(picture.title)}
        )
    return file.getvalue()


def _elements(
    element: ElementTree.Element, x: float, y: float, inherited: dict[str, str]
) -> Iterator[tuple[ElementTree.Element, float, float, dict[str, str]]]:
    """Yield an element and those in it, in their order, each with its place and its attributes."""
    place = _PLACE.match(element.get("transform", ""))
    if place:
        x, y = x + float(place[1]), y + float(place[2])
    look = inherited | dict(element.attrib)
    yield element, x, y, look
    below = {name: look[name] for name in _INHERITED if name in look}
    for inside in element:
        yield from _elements(inside, x, y, below)


def _draw_text(axis: Axes, order: int, text: str, x: float, y: float, look: dict[str, str]) -> None:
    axis.text(
        x + float(look["x"]),
        y + float(look["y"]),
        text,
        color=look.get("fill", "#000000"),
        fontsize=float(look["font-size"]) * _POINTS,
        fontweight="bold" if "font-weight" in look else "normal",
        family="monospace" if look.get("font-family") == "monospace" else "DejaVu Sans",
        ha={"middle": "center", "end": "right"}.get(look.get("text-anchor", ""), "left"),
        parse_math=False,
        zorder=order,
    )


def _patch(order: int, kind: str, x: float, y: float, look: dict[str, str]) -> Patch:
    from matplotlib.patches import FancyBboxPatch, PathPatch

    stroke, fill = look.get("stroke", "none"), look.get("fill", "none")
    width = float(look.get("stroke-width", 1.0)) * _POINTS
    style: dict[str, Any] = {"zorder": order, "linewidth": width * (stroke != "none")}
    if dashes := look.get("stroke-dasharray", "").split():
        style["linestyle"] = (0, [float(length) * _POINTS / width for length in dashes])
    alpha = float(look.get("fill-opacity", 1.0))
    style |= {"facecolor": "none" if fill == "none" else (fill, alpha), "edgecolor": stroke}
    if kind == "path":
        return PathPatch(_path(look["d"], x, y), **style)
    corner = (x + float(look.get("x", 0.0)), y + float(look.get("y", 0.0)))
    size = float(look["width"]), float(look["height"])
    rounding = f"round,pad=0,rounding_size={look['rx']}" if "rx" in look else "square,pad=0"
    return FancyBboxPatch(corner, *size, boxstyle=rounding, **style)


def _path(text: str, x: float, y: float) -> MplPath:
    from matplotlib.path import Path

    codes = {"M": Path.MOVETO, "L": Path.LINETO, "C": Path.CURVE4}
    points: list[tuple[float, float]] = []
    kinds: list[np.uint8] = []
    for command, numbers in _COMMAND.findall(text):
        values = [float(value) for value in numbers.split()]
        pairs = [(x + a, y + b) for a, b in zip(values[0::2], values[1::2], strict=True)]
        points += pairs or points[:1]
        kinds += [codes[command]] * len(pairs) if pairs else [Path.CLOSEPOLY]
    return Path(points, kinds)
