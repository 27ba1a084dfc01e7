"""The answer of curves at a glance: a card per curve, with its mark and what noise alone does."""

from __future__ import annotations

import math
from html import escape
from statistics import median
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph_compare.curve.marks import within_from
from nodegraph_compare.curve.notes import most_text
from nodegraph_tables.answer import HERE, Answer, Card, Finding, Text, Word, dot, joined, say, svg
from nodegraph_tables.numbers import number_text, span_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from nodegraph_compare.curve.curves import Curves
    from nodegraph_compare.curve.points import Points
    from nodegraph_compare.curve.scale import Scale

_HEIGHT = 92.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 8.0, 232.0, 7.0, 75.0
_KINDS = {
    "shared": "shared minimum", "minimum": "lowest minimum", "knee": "knee", "enough": "enough",
}  # fmt: skip


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


def answer_of(curves: Curves) -> Answer:
    """Return the answer: where each curve is marked, or lowest, and where noise is reached."""
    drawn = curves.drawn
    if not drawn:
        return Answer((f"No point has a number for {curves.axes.metric}.",))
    scales = _scales(curves)
    cards = tuple(_card(points, curves, scales) for points in drawn)
    return Answer(_sentence(curves), _scope(curves), cards, findings=_findings(curves))


def _findings(curves: Curves) -> tuple[Finding, ...]:
    """Return where each curve is marked, as data; none where some curve is not."""
    axes, places = curves.axes, curves.marked.places
    if any(points.label not in places for points in curves.drawn):
        return ()
    marked = [float(points.x[places[points.label]]) for points in curves.drawn]
    return tuple(
        Finding(
            group={axes.compare: points.label} if axes.compare else {},
            title=_title(points, curves),
            verdict=False, best=(), tied=(), behind=(), first=("",), unit=axes.x,
            mean={"": int(x) if x.is_integer() else x},
            beside={} if curves.enough is None else {"enough": {"": curves.enough}},
            units={"enough": curves.unit},
        )
        for points, x in zip(curves.drawn, marked, strict=True)
    )  # fmt: skip


def _title(points: Points, curves: Curves) -> str:
    axes = curves.axes
    return f"{axes.compare} {points.label}" if axes.compare else axes.metric


def _sentence(curves: Curves) -> Text:
    drawn, marked, axes = curves.drawn, curves.marked, curves.axes
    knees, minima = _marked_at(curves, "knee"), _marked_at(curves, "minimum")
    of_all = "" if len(drawn) == 1 else _of(len(knees), len(drawn), "curve")
    if curves.enough is not None:
        start = _enough(curves, curves.enough)
    elif marked.shared is not None:
        place = Word(f"{marked.shared:g} {axes.x}", "number")
        start = say(
            f"All {len(drawn)} curves have a minimum within {curves.tolerance:g} of {HERE}", place
        )
    elif knees:
        place = Word(f"{median(knees):g} {axes.x}", "number")
        several = f"median; {_between(knees)} in {of_all}" if len({*knees}) > 1 else of_all
        start = say(
            f"From {HERE} on, more of them help less{f' ({several})' if several else ''}", place
        )
    elif minima:
        start = say(f"Lowest at {HERE}", Word(f"{_between(minima)} {axes.x}", "number"))
    else:
        values = [float(points.value[points.curve].min()) for points in drawn]
        start = say(f"The lowest points have {HERE}", Word(_numbers(curves, values), "number"))
        if curves.mark != "none":
            start = say(
                f"Neither a minimum nor a knee to mark; the lowest have {HERE}",
                Word(_numbers(curves, values), "number"),
            )
    return joined(" ", [say(f"{HERE}.", start), _beside_noise(curves)])


def _marked_at(curves: Curves, kind: str) -> list[float]:
    """Return the x of all marks of a kind."""
    places, kinds = curves.marked.places, curves.marked.kinds
    return [
        float(points.x[places[points.label]])
        for points in curves.drawn
        if kinds.get(points.label) == kind
    ]


def _enough(curves: Curves, most: float) -> Text:
    """Return from where on curves have an error that is small enough, and how many come to it."""
    axes, count = curves.axes, len(curves.drawn)
    what = f"{axes.metric} of at most {most_text(curves)}"
    there = _marked_at(curves, "enough")
    if not there:
        last = [float(points.x[points.curve].max()) for points in curves.drawn]
        return (f"No curve comes to {what}, with up to {_between(last)} {axes.x}",)
    of_all = _of(len(there), count, "curve")
    rest = "; the others do not come to it" if len(there) < count else ""
    place = Word(f"{_between(there)} {axes.x}", "number")
    return say(f"{HERE} are enough for {what} ({of_all}{rest})", place)


def _beside_noise(curves: Curves) -> Text:
    """Return how far marked points are above measurement noise, and which curves reach it."""
    under = [points for points in curves.drawn if math.isfinite(curves.floor(points))]
    if not under:
        return ()
    known = [x for each in under if (x := _reached(each, curves.floor(each))) is not None]
    places = curves.marked.places
    times = [
        float(points.value[places[points.label]]) / curves.floor(points)
        for points in under
        if points.label in places and curves.floor(points) > 0.0
    ]
    who = _of(len(known), len(under), "curve") if known else "no curve"
    reached = f"{who} reach{'es' * (len(known) < 2)}"
    at = say(f" at {HERE}", Word(f"{_between(known)} {curves.axes.x}", "number")) if known else ()
    if not times or curves.enough is not None:
        return say(f"{reached[0].upper()}{reached[1:]} measurement noise{HERE}.", at)
    number = Word(span_text([min(times), max(times)]), "number")
    start = f"{curves.axes.metric} there is {HERE} times that of measurement noise"
    return say(f"{start}, which {reached}{HERE}.", number, at)


def _card(points: Points, curves: Curves, scales: _Scales) -> Card:
    axes, marked, floor = curves.axes, curves.marked, curves.floor(points)
    lowest = int(points.curve[np.argmin(points.value[points.curve])])
    kind = marked.kinds.get(points.label, "")
    place = marked.places.get(points.label, lowest)
    reached = _reached(points, floor)
    where = "not reached" if reached is None else f"reached at {reached:g} {axes.x}"
    noise = (("Noise", (f"{number_text(floor, curves.unit)}, {where}",)),)
    at, what = f"{points.x[place]:g} {axes.x}", _KINDS.get(kind, "lowest point")
    if not kind and curves.mark != "none":
        at, what = "no knee" if curves.enough is None else "not reached", f"lowest at {at}"
    return Card(
        title=_title(points, curves),
        headline=(at,),
        value=(what,),
        aside=(_numbers(curves, [float(points.value[place])]),),
        picture=_picture(points, curves, place, scales),
        facts=noise if math.isfinite(floor) else (),
    )


def _picture(points: Points, curves: Curves, place: int, scales: _Scales) -> str:
    axes, floor = curves.axes, curves.floor(points)
    shade = ""
    if math.isfinite(floor):
        top = float(scales.y(np.array([floor]))[0])
        shade = f'<rect x="0" width="240" y="{top:.1f}" height="{_BOTTOM - top:.1f}"/>'
    if curves.enough is not None:
        level = float(scales.y(np.array([curves.enough]))[0])
        shade += f'<line class="enough" x1="0" x2="240" y1="{level:.1f}" y2="{level:.1f}"/>'
    others = (_path(other, scales, "rest") for other in curves.drawn if other is not points)
    x, y = scales.x(points.x), scales.y(points.value)
    curve = "".join(
        dot(
            round(float(x[at]), 1), round(float(y[at]), 1), "before" if at == place else "own",
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


def _scales(curves: Curves) -> _Scales:
    drawn, scale = curves.drawn, curves.scale
    x = np.concatenate([points.x[points.curve] for points in drawn])
    y = scale.along(np.concatenate([points.value[points.curve] for points in drawn]))
    return _Scales(scale, float(x.min()), float(x.max()), float(y.min()), float(y.max()))


def _scope(curves: Curves) -> Text:
    axes, drawn, recordings = curves.axes, curves.drawn, curves.recordings
    parts = [f"{axes.metric} over {axes.x}, lower is better"]
    if curves.scale.logarithmic:
        parts[0] += ", on a logarithmic scale"
    if any(math.isfinite(curves.floor(points)) for points in drawn):
        parts.append("shaded: what measurement noise alone does")
    if curves.enough is not None:
        parts.append(f"dashed: {most_text(curves)}, which is enough")
    if "knee" in curves.marked.kinds.values():
        parts.append("knee: where a curve turns, so that more help less")
    several = f"{len(drawn)} curves" if len(drawn) > 1 else "One curve"
    kind = " of synthetic recordings" if recordings.synthetic else ""
    data = ", ".join(filter(None, [recordings.names, recordings.sizes]))
    point = f"mean over {' and '.join(axes.blocks)}" if axes.blocks else "single result"
    people = "; untested on people" * recordings.synthetic
    held = (
        f"{several}{kind}{f' ({data})' if data else ''}, each point a {point}: described, not "
        f"tested; other draws may differ{people}."
    )
    if len(drawn) > 1:
        parts.append("dark: the curve of the card, grey: the others")
    return joined(" ", [Word(held), f"Curves: {'; '.join(parts)}."])


def _reached(points: Points, floor: float) -> float | None:
    """Return the x from which on a curve is not above the noise floor."""
    place = within_from(points, floor)
    return None if place is None else float(points.x[place])


def _numbers(curves: Curves, values: Sequence[float]) -> str:
    return f"{curves.axes.metric} {span_text([min(values), max(values)], curves.unit)}"


def _between(values: Sequence[float]) -> str:
    low, high = min(values), max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def _of(count: int, total: int, what: str) -> str:
    if count == total:
        return {1: f"the {what}", 2: f"both {what}s"}.get(total, f"all {total} {what}s")
    return f"{count} of {total} {what}s"
