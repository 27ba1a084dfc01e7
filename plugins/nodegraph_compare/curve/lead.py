"""The answer of curves at a glance: a card per curve, with its mark and what noise alone does."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph_compare.ties import at_most
from nodegraph_tables.lead import Card, Lead, Text, dot, svg
from nodegraph_tables.numbers import number_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.curve.marks import Mark, Marks
    from nodegraph_compare.curve.points import Axes, Points
    from nodegraph_compare.curve.scale import Scale

_HEIGHT = 92.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 8.0, 232.0, 7.0, 75.0
_KINDS = {"shared": "shared minimum", "minimum": "lowest minimum", "knee": "knee"}


class _Scales(NamedTuple):
    """From numbers to pixels, the same on all cards."""

    scale: Scale
    left: float
    right: float
    low: float
    high: float

    def x(self, value: NDArray[np.float64]) -> NDArray[np.float64]:
        share = (value - self.left) / ((self.right - self.left) or 1.0)
        return np.asarray(_LEFT + (_RIGHT - _LEFT) * share)

    def y(self, value: NDArray[np.float64]) -> NDArray[np.float64]:
        share = (self.scale.along(value) - self.low) / ((self.high - self.low) or 1.0)
        return np.asarray(_BOTTOM - (_BOTTOM - _TOP) * np.clip(share, 0.0, 1.0))


def lead_of(
    axes: Axes,
    curves: Sequence[Points],
    marked: Marks,
    level: Mapping[Label, float] | None,
    scale: Scale,
    mark: Mark,
    tolerance: float,
    unit: str,
) -> Lead:
    """Return the lead: where each curve is marked, or lowest, and where noise is reached.

    Parameters
    ----------
    axes, curves, marked
        The names, the points of each label, and the places with a mark.
    level
        The noise floor of each label, NaN for one without; None where there is no floor.
    scale
        Along y.
    mark, tolerance
        As set.
    unit
        Of the metric.
    """
    drawn = [points for points in curves if len(points.curve)]
    if not drawn:
        return Lead((f"No point has a number for {axes.metric}.",))
    floors = {points.label: (level or {}).get(points.label, math.nan) for points in drawn}
    scales = _scales(drawn, scale)
    cards = tuple(
        _card(points, drawn, axes, marked, floors[points.label], scales, unit) for points in drawn
    )
    return Lead(
        _sentence(axes, drawn, marked, floors, mark, tolerance, unit),
        cards,
        _scope(axes, drawn, scale, floors),
    )


def _sentence(
    axes: Axes,
    drawn: Sequence[Points],
    marked: Marks,
    floors: Mapping[Label, float],
    mark: Mark,
    tolerance: float,
    unit: str,
) -> Text:
    knees = [
        float(points.x[marked.places[points.label]])
        for points in drawn
        if marked.kinds.get(points.label) == "knee"
    ]
    minima = [
        float(points.x[marked.places[points.label]])
        for points in drawn
        if marked.kinds.get(points.label) == "minimum"
    ]
    of_all = "" if len(drawn) == 1 else f" ({_of(len(knees), len(drawn), 'curve')})"
    if marked.shared is not None:
        start: Text = (
            f"All {len(drawn)} curves have a minimum within {tolerance:g} of ",
            f"{marked.shared:g} {axes.x}", "",
        )  # fmt: skip
    elif knees:
        start = ("From ", f"{_between(knees)} {axes.x}", f" on, more of them help less{of_all}")
    elif minima:
        start = ("Lowest at ", f"{_between(minima)} {axes.x}", "")
    else:
        values = [float(points.value[points.curve].min()) for points in drawn]
        start = ("The lowest points have ", _numbers(axes, values, unit), "")
        if mark != "none":
            start = ("Neither a minimum nor a knee to mark; the lowest have ", *start[1:])
    under = [points for points in drawn if math.isfinite(floors[points.label])]
    if not under:
        return (*start[:2], f"{start[2]}.")
    reached = [_reached(points, floors[points.label]) for points in under]
    known = [x for x in reached if x is not None]
    if not known:
        return (*start[:2], f"{start[2]}; no curve comes down to measurement noise.")
    which = "" if len(known) == len(under) else f" by {_of(len(known), len(under), 'curve')}"
    return (*start[:2], f"{start[2]}; noise is reached{which} at ", f"{_between(known)}", ".")


def _card(
    points: Points,
    drawn: Sequence[Points],
    axes: Axes,
    marked: Marks,
    floor: float,
    scales: _Scales,
    unit: str,
) -> Card:
    lowest = int(points.curve[np.argmin(points.value[points.curve])])
    kind = marked.kinds.get(points.label, "")
    place = marked.places.get(points.label, lowest)
    reached = _reached(points, floor)
    where = "not reached" if reached is None else f"reached at {reached:g}"
    noise = (("Noise", f"{number_text(floor, unit)}, {where}"),)
    return Card(
        title=f"{axes.compare} {points.label}" if axes.compare else axes.metric,
        headline=f"{points.x[place]:g} {axes.x}",
        value=_KINDS.get(kind, "lowest point"),
        aside=_numbers(axes, [float(points.value[place])], unit),
        picture=_picture(points, drawn, place, floor, axes, scales),
        facts=noise if math.isfinite(floor) else (),
        best=bool(kind),
    )


def _picture(
    points: Points,
    drawn: Sequence[Points],
    place: int,
    floor: float,
    axes: Axes,
    scales: _Scales,
) -> str:
    shade = ""
    if math.isfinite(floor):
        top = float(scales.y(np.array([floor]))[0])
        shade = f'<rect x="0" width="240" y="{top:.1f}" height="{_BOTTOM - top:.1f}"/>'
    others = (_path(other, scales, "rest") for other in drawn if other is not points)
    x, y = scales.x(points.x), scales.y(points.value)
    curve = "".join(
        dot(
            round(float(x[at]), 1), round(float(y[at]), 1), "tied" if at == place else "best",
            f"{points.x[at]:g} {axes.x}: {number_text(float(points.value[at]))}",
            6.0 if at == place else 2.5,
        )
        for at in sorted(points.curve.tolist(), key=lambda at: at == place)
    )  # fmt: skip
    ends = (
        f'<text x="{_LEFT:g}" y="{_HEIGHT - 3:g}">{scales.left:g}</text>'
        f'<text class="end" x="{_RIGHT:g}" y="{_HEIGHT - 3:g}">'
        f"{scales.right:g} {escape(axes.x)}</text>"
    )
    name = f"{axes.metric} over {axes.x} {points.label}"
    return svg(name, _HEIGHT, (shade, *others, _path(points, scales, ""), curve, ends))


def _path(points: Points, scales: _Scales, kind: str) -> str:
    x, y = scales.x(points.x[points.curve]), scales.y(points.value[points.curve])
    pairs = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    return f'<path class="{kind}" d="M{pairs}"/>'


def _scales(drawn: Sequence[Points], scale: Scale) -> _Scales:
    x = np.concatenate([points.x[points.curve] for points in drawn])
    y = scale.along(np.concatenate([points.value[points.curve] for points in drawn]))
    return _Scales(scale, float(x.min()), float(x.max()), float(y.min()), float(y.max()))


def _scope(axes: Axes, drawn: Sequence[Points], scale: Scale, floors: Mapping[Label, float]) -> str:
    parts = [f"{axes.metric} over {axes.x}, lower is better"]
    if scale.logarithmic:
        parts[0] += ", on a logarithmic scale"
    if any(map(math.isfinite, floors.values())):
        parts.append("shaded: what measurement noise alone does")
    several = f"{len(drawn)} curves" if len(drawn) > 1 else "one curve"
    if axes.blocks:
        of = f"{several}, means over {' and '.join(axes.blocks)}"
    else:
        of = f"{several}; each point is one result, and another draw may differ"
    return f"Scope: {of}. Curves: {'; '.join(parts)}."


def _reached(points: Points, floor: float) -> float | None:
    """Return the first x at which a curve is not above the noise floor."""
    below = points.x[points.curve][at_most(points.value[points.curve], floor)]
    return float(below[0]) if len(below) else None


def _numbers(axes: Axes, values: Sequence[float], unit: str) -> str:
    low, high = number_text(min(values)), number_text(max(values))
    return f"{axes.metric} {low if low == high else f'{low} to {high}'} {unit}".rstrip()


def _between(values: Sequence[float]) -> str:
    low, high = min(values), max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def _of(count: int, total: int, what: str) -> str:
    if count == total:
        return "both curves" if total == 2 else f"all {total} {what}s"
    return f"{count} of {total} {what}s"
