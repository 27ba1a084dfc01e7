"""The answer of curves at a glance: all of them in one picture, their marks, and the noise."""

from __future__ import annotations

import math
from html import escape
from statistics import median
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph_compare.curve.marks import within_from
from nodegraph_compare.curve.notes import most_text
from nodegraph_tables.answer import MOST_CARDS, ONE_ROW, Answer, Card, Finding
from nodegraph_tables.lead import dot, svg
from nodegraph_tables.line import Line, tick_text
from nodegraph_tables.numbers import number_text, span_text
from nodegraph_tables.style import unit_text
from nodegraph_tables.text import HERE, Text, Word, joined, say

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.curve.curves import Curves
    from nodegraph_compare.curve.points import Points
    from nodegraph_compare.curve.scale import Scale

_WIDTH, _HEIGHT = 500.0, 200.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 44.0, 428.0, 20.0, 172.0
_LINE = 12.0
"""From name to name."""
_NEAR = 0.1
"""Share of the axis across within which its end has the only number."""

_KINDS = {
    "shared": "shared minimum", "minimum": "lowest minimum", "knee": "knee",
    "enough": "the fewest from which on all are enough",
}  # fmt: skip


class _Scales(NamedTuple):
    """From numbers to pixels."""

    scale: Scale
    left: float
    right: float
    bottom: float
    top: float

    def x(self, value: NDArray[np.float64]) -> NDArray[np.float64]:
        share = (value - self.left) / ((self.right - self.left) or 1.0)
        return np.asarray(_LEFT + (_RIGHT - _LEFT) * share)

    def y(self, value: NDArray[np.float64]) -> NDArray[np.float64]:
        bottom, top = self.scale.along(np.array([self.bottom, self.top]))
        share = (self.scale.along(value) - bottom) / ((top - bottom) or 1.0)
        return np.asarray(_BOTTOM - (_BOTTOM - _TOP) * np.clip(share, 0.0, 1.0))


def answer_of(curves: Curves) -> Answer:
    """Return the answer: where each curve is marked, or lowest, and where noise is reached."""
    drawn = curves.drawn
    if not drawn:
        return Answer((f"No point has a number for {curves.axes.metric}.",))
    findings = _findings(curves)
    of_all = _of_all(curves)
    overall = None
    if of_all is not None:
        beside = {"next fewer": _next_fewer(curves, of_all)}
        overall = _finding(curves, {}, _every(len(drawn)), of_all, beside)
    blocks = " and ".join(curves.axes.blocks)
    point = f"a mean over {blocks}" if blocks else "of one draw, without an interval"
    return Answer(
        _sentence(curves), _scope(curves), (_card(curves),), (), findings, overall,
        certainty=(f"Each point is {point}.",),
    )  # fmt: skip


def _of_all(curves: Curves) -> float | None:
    """Return from where on every one of several curves has an error that is small enough."""
    there = _marked_at(curves, "enough")
    return max(there) if 1 < len(there) == len(curves.drawn) else None


def _next_fewer(curves: Curves, of_all: float) -> float | None:
    """Return the most below what is enough for all curves that some curve has, and is too few."""
    places = curves.marked.places
    tried = (points.x[points.curve] for points in curves.drawn
             if points.x[places[points.label]] == of_all)  # fmt: skip
    return max((float(x) for each in tried for x in each if x < of_all), default=None)


def _findings(curves: Curves) -> tuple[Finding, ...]:
    """Return where each curve is marked, as data; none where some curve is not."""
    axes, places = curves.axes, curves.marked.places
    if any(points.label not in places for points in curves.drawn):
        return ()
    return tuple(
        _finding(
            curves,
            {axes.compare: points.label} if axes.compare else {},
            _title(points, curves),
            float(points.x[places[points.label]]),
            {"enough": curves.enough, "noise": curves.floor(points)},
        )
        for points in curves.drawn
    )


def _finding(
    curves: Curves,
    group: Mapping[str, Label],
    title: str,
    x: float,
    beside: Mapping[str, float | None],
) -> Finding:
    return Finding(
        group=group, title=title, verdict=False, best=(), tied=(), behind=(), first=("",),
        unit=curves.axes.x,
        mean={"": _count(x)},
        beside={
            name: {"": _count(value)}
            for name, value in beside.items()
            if value is not None and math.isfinite(value)
        },
        units={"next fewer": curves.axes.x, "enough": curves.unit, "noise": curves.unit},
    )  # fmt: skip


def _count(x: float) -> float:
    """Return a number, of type int where it is whole."""
    return int(x) if x.is_integer() else x


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
    place = Word(f"{max(there):g} {axes.x}", "number")
    if len(there) < count:
        start = f"{HERE} are enough for {what} in {_of(len(there), count, 'curve')}"
        return say(f"{start}; the others do not come to it", place)
    if min(there) == max(there):
        return say(f"{HERE} are enough for {what} in {_every(count)}", place)
    by_curve = Word(_between(there), "number")
    return say(f"{HERE} are enough for {what} in {_every(count)} ({HERE} by curve)", place,
               by_curve)  # fmt: skip


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


def _card(curves: Curves) -> Card:
    axes, drawn = curves.axes, curves.drawn
    kinds = dict.fromkeys(curves.marked.kinds.values())
    marked = [x for kind in kinds for x in _marked_at(curves, kind)]
    lowest = [float(points.x[_lowest(points)]) for points in drawn]
    of_all = _of_all(curves)
    more = len(drawn) - MOST_CARDS
    rest: list[tuple[str, Text]] = [("more", (f"{more} are in the table",))] if more > 0 else []
    return Card(
        title=(f"{axes.metric} over {axes.x}",),
        headline=(f"{_between([of_all] if of_all else marked or lowest)} {axes.x}",),
        value=(
            f"enough for {_every(len(drawn))}"
            if of_all
            else " or ".join(_KINDS[kind] for kind in kinds) or "lowest",
        ),
        picture=_picture(curves),
        facts=(
            *((_title(each, curves), _fact(each, curves)) for each in drawn[:MOST_CARDS]),
            *rest,
        ),
    )


def _lowest(points: Points) -> int:
    return int(points.curve[np.argmin(points.value[points.curve])])


def _fact(points: Points, curves: Curves) -> Text:
    """Return the mark of a curve, and where it comes to the noise."""
    axes, marked, floor = curves.axes, curves.marked, curves.floor(points)
    kind = marked.kinds.get(points.label, "")
    place = marked.places.get(points.label, _lowest(points))
    at, what = f"{points.x[place]:g} {axes.x}", _KINDS.get(kind, "lowest point")
    if not kind and curves.mark != "none":
        at, what = "no knee" if curves.enough is None else "not reached", f"lowest at {at}"
    # what all are marked for stands above them
    what = "" if len({*marked.kinds.values()}) == 1 and kind else f", {what}"
    text = f"{at}{what}, {_numbers(curves, [float(points.value[place])])}"
    if not math.isfinite(floor) or curves.enough is not None:
        return (text,)
    reached = _reached(points, floor)
    where = "not reached" if reached is None else f"reached at {reached:g}"
    return (f"{text} (noise {number_text(floor, curves.unit)}, {where})",)


def _picture(curves: Curves) -> str:
    """Return all curves over one another, with a circle at each mark."""
    axes, drawn, scales, last = curves.axes, curves.drawn, _scales(curves), _last(curves)
    floors = [floor for points in drawn if math.isfinite(floor := curves.floor(points))]
    parts: list[str] = []
    if floors:
        top = float(scales.y(np.array([max(floors)]))[0])
        parts.append(
            f'<rect x="{_LEFT:g}" width="{_RIGHT - _LEFT:g}" y="{top:.1f}" '
            f'height="{_BOTTOM - top:.1f}"/>'
            f'<text x="{_LEFT + 6:g}" y="{top - 4:.1f}">noise</text>'
        )
    y = Line(scales.bottom, scales.top, log=curves.scale.logarithmic).ticks()
    for at, tick in zip(scales.y(np.array(y)), y, strict=True):
        parts += [
            f'<line class="grid" x1="{_LEFT:g}" x2="{_RIGHT:g}" y1="{at:.1f}" y2="{at:.1f}"/>',
            f'<text class="end" x="{_LEFT - 6:g}" y="{at + 4:.1f}">{tick_text(tick, curves.unit)}'
            "</text>",
        ]
    ends, near = (scales.left, scales.right), _NEAR * (scales.right - scales.left)
    inside = Line(*ends).ticks()
    x = [*dict.fromkeys(ends), *(each for each in inside if ends[0] + near < each < ends[1] - near)]
    for at, tick in zip(scales.x(np.array(x)), x, strict=True):
        parts.append(
            f'<text class="middle" x="{at:.1f}" y="{_BOTTOM + 16:g}">{tick_text(tick, "")}</text>'
        )
    if curves.enough is not None:
        level = float(scales.y(np.array([curves.enough]))[0])
        parts.append(
            f'<line class="enough" x1="{_LEFT:g}" x2="{_RIGHT:g}" y1="{level:.1f}" '
            f'y2="{level:.1f}"/>'
            f'<text class="end" x="{_RIGHT:g}" y="{level - 5:.1f}">'
            f"{escape(most_text(curves))} is enough</text>"
        )
    unit = unit_text(curves.unit)
    parts += [
        f'<text x="4" y="10">\N{UPWARDS ARROW} {escape(axes.metric)}'
        f"{f' ({escape(unit)})' if unit else ''}</text>",
        f'<text class="end" x="{_RIGHT:g}" y="{_HEIGHT - 2:g}">{escape(axes.x)} '
        "\N{RIGHTWARDS ARROW}</text>",
        *(_path(points, scales, is_last=points is last) for points in drawn),
        *_names(drawn, scales),
        *([] if last is None else [_name(last, curves, scales)]),
        *(
            _mark(points, curves, scales)
            for points in drawn
            if points.label in curves.marked.places
        ),
    ]
    return svg(f"{axes.metric} over {axes.x}", _HEIGHT, parts, _WIDTH)


def _names(drawn: Sequence[Points], scales: _Scales) -> Iterator[str]:
    """Yield the names of a few curves, from the top down, with lines from their ends to them."""
    if not 1 < len(drawn) <= ONE_ROW:
        return
    ends = [
        (float(scales.y(each.value)[at]), float(scales.x(each.x)[at]), str(each.label))
        for each in drawn
        for at in each.curve[-1:]
    ]
    above = -_LINE
    for left, (y, x, name) in zip(range(len(ends) - 1, -1, -1), sorted(ends), strict=True):
        above = min(max(y, above + _LINE), _BOTTOM - _LINE * left)
        yield (
            f'<line class="grid" x1="{x:.1f}" x2="{_RIGHT + 8:g}" y1="{y:.1f}" y2="{above:.1f}"/>'
            f'<text x="{_RIGHT + 11:g}" y="{above + 4:.1f}">{escape(name)}</text>'
        )


def _last(curves: Curves) -> Points | None:
    """Return the curve, of many, that takes the most to be small enough."""
    if len(curves.drawn) <= ONE_ROW or _of_all(curves) is None:
        return None
    places = curves.marked.places
    return max(curves.drawn, key=lambda points: points.x[places[points.label]])


def _name(points: Points, curves: Curves, scales: _Scales) -> str:
    """Return the name of a curve, beside its mark."""
    at = curves.marked.places[points.label]
    x, y = float(scales.x(points.x)[at]), float(scales.y(points.value)[at])
    return f'<text class="end" x="{x - 8:.1f}" y="{y + 14:.1f}">{escape(str(points.label))}</text>'


def _mark(points: Points, curves: Curves, scales: _Scales) -> str:
    place = curves.marked.places[points.label]
    x, y = scales.x(points.x)[place], scales.y(points.value)[place]
    name = f"{_title(points, curves)}: {points.x[place]:g} {curves.axes.x}"
    return dot(round(float(x), 1), round(float(y), 1), "before", name, 5.0)


def _path(points: Points, scales: _Scales, *, is_last: bool) -> str:
    x, y = scales.x(points.x[points.curve]), scales.y(points.value[points.curve])
    pairs = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    last = ' class="last"' * is_last
    return f'<path{last} d="M{pairs}"><title>{escape(str(points.label))}</title></path>'


def _scales(curves: Curves) -> _Scales:
    drawn, scale = curves.drawn, curves.scale
    x = np.concatenate([points.x[points.curve] for points in drawn])
    y = scale.shown(np.concatenate([points.value[points.curve] for points in drawn]))
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
    if _last(curves) is not None:
        parts.append("thick: the one that needs most")
    if "knee" in curves.marked.kinds.values():
        parts.append("knee: where a curve turns, so that more help less")
    data = ", ".join(filter(None, [recordings.names, recordings.sizes]))
    people = "; untested on people" * recordings.synthetic
    several = f"{_several(curves)}{f' ({data})' if data else ''}"
    held = f"{several}: others may differ{people}."
    if kinds := dict.fromkeys(_KINDS[kind] for kind in curves.marked.kinds.values()):
        parts.append(f"circle: {' or '.join(kinds)}")
    return joined(" ", [Word(held), f"Curves: {'; '.join(parts)}."])


def _several(curves: Curves) -> str:
    """Return of what there are curves, and how many: ``8 synthetic recordings``."""
    count, recordings = len(curves.drawn), curves.recordings
    kind = "synthetic " * recordings.synthetic
    if count == len(recordings.files) > 1:
        return f"{count} {kind}recordings, a curve each"
    curve = f"{count} curves" if count > 1 else "One curve"
    return f"{curve} of {kind}recordings" if kind else curve


def _reached(points: Points, floor: float) -> float | None:
    """Return the x from which on a curve is not above the noise floor."""
    place = within_from(points, floor)
    return None if place is None else float(points.x[place])


def _numbers(curves: Curves, values: Sequence[float]) -> str:
    return f"{curves.axes.metric} {span_text([min(values), max(values)], curves.unit)}"


def _between(values: Sequence[float]) -> str:
    low, high = min(values), max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def _every(count: int) -> str:
    return _of(count, count, "curve")


def _of(count: int, total: int, what: str) -> str:
    if count == total:
        return {1: f"the {what}", 2: f"both {what}s"}.get(total, f"all {total} {what}s")
    return f"{count} of {total} {what}s"
