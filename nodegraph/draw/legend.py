"""What dashes, fans and chips mean, below a picture that has any of them."""

from __future__ import annotations

from nodegraph.draw.marks import number
from nodegraph.draw.picture import Picture
from nodegraph.draw.text import escaped, width

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
