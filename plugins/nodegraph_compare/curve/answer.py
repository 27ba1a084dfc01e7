"""What curves say, in sentences: where their marks are, what noise alone does, what is left out."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.bootstrap import CONFIDENCE, RESAMPLES
from nodegraph_compare.left_out import absences, start_text
from nodegraph_compare.ties import at_most

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from nodegraph import Across, Label
    from nodegraph_compare.curve.marks import Mark, Marks
    from nodegraph_compare.curve.points import Axes, Points
    from nodegraph_mocap import Table


def answer(
    axes: Axes,
    found: Sequence[Points],
    marked: Marks,
    level: Mapping[Label, float] | None,
    mark: Mark,
    tolerance: float,
    unit: str,
) -> list[str]:
    """Return sentences: what is marked, or the lowest points, then what the noise floor reaches.

    Parameters
    ----------
    axes, found, marked
        The names, the points of each label, and the places with a mark.
    level
        The noise floor of each label, NaN for one without; None where there is no floor.
    mark, tolerance
        What was asked for.
    unit
        Of the metric.
    """
    drawn = [one for one in found if len(one.curve)]
    if not drawn:
        return [f"No point has a number for {axes.metric}; nothing can be said."]
    said = _Said(axes, marked, level, unit)
    under = [one for one in drawn if _known(level, one)]
    told = [] if mark == "none" else said.marks(drawn, mark, tolerance)
    told += said.lowest(drawn) if mark == "none" and not under else []
    return [*told, *(said.floor(one) for one in under)]


def verdict(marked: Marks, axes: Axes, mark: Mark, tolerance: float) -> str:
    """Return what a figure says above its curves; nothing where nothing was asked.

    Parameters
    ----------
    marked
        The places with a mark.
    axes
        The names.
    mark, tolerance
        What was asked for.
    """
    if mark != "shared":
        return ""
    if marked.shared is None:
        return f"no minimum shared within {tolerance:g} {axes.x}"
    return f"minimum shared at {marked.shared:g} {axes.x}"


def notes(axes: Axes, marked: Marks, level: Mapping[Label, float] | None, seed: int) -> list[str]:
    """Return what the columns of the table mean.

    Parameters
    ----------
    axes, marked
        The names, and the places with a mark.
    level
        The noise floor of each label; None where there is no floor.
    seed
        Of the bootstrap.
    """
    if axes.blocks:
        text = (
            f"{axes.metric}: mean over blocks, a block being one combination of "
            f"{', '.join(axes.blocks)}; low, high: its {CONFIDENCE:.0%} bootstrap interval "
            f"({RESAMPLES} resamples, seed {seed})."
        )
    else:
        text = f"{axes.metric}: of one row, or the mean where rows says that there are more."
    told = [f"{text} Lower is better."]
    if axes.lowest:
        told.append(f"on curve: the lowest of the points at one value of {axes.x}.")
    told.append("local minimum: lower than the points of the curve before and after it.")
    if level is not None:
        told.append("below floor: at or below what measurement noise alone does.")
    if "knee" in marked.kinds.values():
        told.append(
            "knee: the point of a curve farthest below the straight line through its first and "
            "last point, on the scales of the figure; errors below the noise floor count as it."
        )
    return told


def losses(
    scores: Across[Table],
    axes: Axes,
    found: Sequence[Points],
    level: Mapping[Label, float] | None,
    *,
    skipped: bool,
) -> list[str]:
    """Return what is left out, in counts.

    Parameters
    ----------
    scores
        The gathered tables.
    axes, found
        The names, and the points of each label.
    level
        The noise floor of each label, NaN for one without; None where there is no floor.
    skipped
        Whether what the graph leaves out on purpose is told too.
    """
    rows = "blocks" if axes.blocks else "rows"
    told = [
        f"{start_text(one.label)}{count} {what}"
        for one in found
        for count, what in (
            (one.without_x, f"rows left out, whose {axes.x} is no finite number"),
            (one.without_value, f"{rows} left out, whose {axes.metric} is no finite number"),
        )
        if count
    ]
    lacking = [str(one.label) for one in found if len(one.curve) == 0]
    told += [f"without a curve: {', '.join(lacking)}"] if any(lacking) else []
    bare = [str(one.label) for one in found if level is not None and not _known(level, one)]
    told += [f"without a noise floor: {', '.join(bare)}"] if bare else []
    absent = (one for one in scores.absent if skipped or one.kind != "skipped")
    return told + absences(absent, axes.compare)


class _Said:
    """Sentences on the curves of one figure."""

    def __init__(
        self, axes: Axes, marked: Marks, level: Mapping[Label, float] | None, unit: str
    ) -> None:
        self._axes, self._marked, self._level, self._unit = axes, marked, level, unit

    def lowest(self, drawn: Sequence[Points]) -> list[str]:
        places = [(one, one.curve[int(np.argmin(one.value[one.curve]))]) for one in drawn]
        return [f"Lowest: {self._points(places)}."]

    def marks(self, drawn: Sequence[Points], mark: Mark, tolerance: float) -> list[str]:
        of = {
            kind: [(one, self._marked.places[one.label]) for one in drawn if self._is(one, kind)]
            for kind in ("shared", "minimum", "knee")
        }
        told = []
        if of["shared"]:
            told.append(
                f"All {len(drawn)} curves have a local minimum within {tolerance:g} of "
                f"{self._axes.x} {self._marked.shared:g}, the fewest of which this holds: "
                f"{self._points(of['shared'])}."
            )
        elif mark == "shared":
            told.append(
                f"No local minimum is shared within {tolerance:g} {self._axes.x}:"
                f" {self._minima(drawn)}."
            )
        if of["minimum"]:
            told.append(f"Lowest local minimum: {self._points(of['minimum'])}.")
        if of["knee"]:
            told.append(f"Knees, marked instead: {self._points(of['knee'])}.")
        bare = [_name(one) for one in drawn if one.label not in self._marked.places]
        if bare:
            told.append(f"Neither a minimum to mark nor a knee: {', '.join(bare)}.")
        return told

    def floor(self, one: Points) -> str:
        level = (self._level or {})[one.label]
        curve = one.curve
        reached = one.x[curve][at_most(one.value[curve], level)]
        start = f"{start_text(one.label)}noise alone gives {self._number(level)}; "
        if not len(reached):
            return f"{start}no point of the curve is as low."
        return (
            f"{start}{len(reached)} of {len(curve)} points of the curve are at or below it, "
            f"first at {self._axes.x} {reached[0]:g}."
        )

    def _is(self, one: Points, kind: str) -> bool:
        return self._marked.kinds.get(one.label) == kind

    def _minima(self, drawn: Sequence[Points]) -> str:
        return "; ".join(
            f"{_name(one)} has " + (f"some at {_list(one.x[places])}" if len(places) else "none")
            for one, places in ((one, self._marked.minima[one.label]) for one in drawn)
        )

    def _points(self, places: Iterable[tuple[Points, int]]) -> str:
        return ", ".join(
            f"{_name(one)} at {one.x[place]:g} ({self._number(one.value[place])}"
            f"{self._reach(one, place)})".strip()
            for one, place in places
        )

    def _reach(self, one: Points, place: int) -> str:
        below = at_most(one.value[place], (self._level or {}).get(one.label, math.nan))
        return ", not above the noise floor" if below else ""

    def _number(self, value: float) -> str:
        return f"{self._axes.metric} {value:.3g} {self._unit}".rstrip()


def _known(level: Mapping[Label, float] | None, one: Points) -> bool:
    return level is not None and math.isfinite(level[one.label])


def _name(one: Points) -> str:
    return str(one.label) or "the curve"


def _list(numbers: Iterable[float]) -> str:
    return ", ".join(f"{number:g}" for number in numbers)
