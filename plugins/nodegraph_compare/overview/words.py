"""Numbers and names of an overview as a reader sees them, in HTML."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import escape

from nodegraph_compare.inference import LEVEL
from nodegraph_tables.numbers import SMALLEST, SPACE, percent, shares_text, span_text
from nodegraph_tables.style import unit_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from nodegraph import Label, Origin
    from nodegraph_compare.overview.value import GroupOverview, Metric, Overview

MOST_CARDS = 8
"""Groups with a card each."""

UNCLEAR = "with no clear change"

_MOST_IN_SIGHT = 4
_MOST_NAMES = 3


def in_unit(values: Sequence[float], unit: str) -> str:
    """Return numbers from first to last with their unit, escaped; shares in percent."""
    return str(escape(span_text(values, unit)))


def signed(value: float, unit: str, mean: float) -> str:
    """Return a difference with its sign, to the digits of the mean that it is to."""
    shown = round(value, 3) if abs(mean) >= SMALLEST else value
    if value and not shown:
        return f"under {in_unit([SMALLEST], unit)}"
    return f"{'+' if shown >= 0 else ''}{in_unit([shown], unit)}"


def beside_text(values: Sequence[float], metric: Metric) -> str:
    """Return means of the metrics shown next to the first, from first to last, in few digits."""
    return shares_text(values) if metric.unit == "share" else in_unit(values, metric.unit)


def strong(text: object) -> str:
    """Return an emphasised name, escaped."""
    return f"<strong>{escape(str(text))}</strong>"


def method_names(overview: Overview, places: Iterable[int]) -> list[str]:
    """Return the names of methods, each marked with what it is a name of.

    A number is named with what it is a value of: ``threshold 2``.
    """
    return [
        f'<strong data-method="{escape(str(label))}">{escape(_name(overview, label))}</strong>'
        for label in (overview.methods[place] for place in places)
    ]


def _name(overview: Overview, label: Label) -> str:
    return str(label) if isinstance(label, str) else f"{overview.compare} {label}"


def few(texts: Sequence[str], most: int = _MOST_NAMES) -> str:
    """Return the first texts: ``a, b, c and 4 more``."""
    more = len(texts) - most
    return ", ".join(texts[:most]) + (f" and {more} more" if more > 0 else "")


def either(texts: Sequence[str]) -> str:
    """Return texts as alternatives: ``a, b or c``."""
    return " or ".join(filter(None, [", ".join(texts[:-1]), *texts[-1:]]))


def both(texts: Sequence[str]) -> str:
    """Return texts as a list: ``a, b and c``."""
    return " and ".join(filter(None, [", ".join(texts[:-1]), *texts[-1:]]))


def with_units(overview: Overview, origin: Origin) -> Overview:
    """Return an overview whose labels are texts with their units: ``5 frames``, ``2 %``."""
    units = [origin.unit(axis) for axis in overview.within]
    return replace(
        overview,
        groups=tuple(
            replace(group, labels=tuple(map(label_text, group.labels, units)))
            for group in overview.groups
        ),
    )


def label_text(label: Label, unit: str = "") -> str:
    """Return a label as a reader sees it: numbers without useless digits, with their unit."""
    if isinstance(label, bool) or not isinstance(label, (int, float)):
        return str(label)
    if unit == "share":
        return f"{100 * label:.10g}{SPACE}%"
    if label == 1 and len(unit) > 1:
        unit = unit.removesuffix("s")  # 1 frame
    return f"{label:.12g}{SPACE}{unit_text(unit)}".rstrip(SPACE)


def unit_means(group: GroupOverview, metric: str) -> NDArray[np.float64]:
    """Return (K,) the means over units of the means of their blocks; NaN where there is none."""
    errors = group.errors[metric].astype(np.float64)
    means = np.full(errors.shape[1], np.nan)
    for method, values in enumerate(errors.T):
        used = np.isfinite(values) & (group.unit >= 0)
        if used.any():
            count = np.bincount(group.unit[used])
            sums = np.bincount(group.unit[used], values[used])
            means[method] = (sums[count > 0] / count[count > 0]).mean()
    return means


def changes(group: GroupOverview) -> dict[int, tuple[int, str]]:
    """Return the step before each step, and whether this one lowers or raises the mean."""
    known = np.flatnonzero(np.isfinite(group.mean)).tolist()
    return {
        step: (before, ("lowers" if group.mean[step] < group.mean[before] else "raises")
               if group.stands and group.p_of_step[step] <= LEVEL else UNCLEAR)
        for before, step in pairwise(known)
    }  # fmt: skip


def change_text(overview: Overview, group: GroupOverview, before: int, step: int) -> str:
    """Return the distance between the means of two steps: ``36 %``, or ``0.12 mm``."""
    first, second = float(group.mean[before]), float(group.mean[step])
    if overview.ratio and first > 0:
        return percent(abs(second / first - 1))
    return in_unit([abs(second - first)], overview.metric.unit)


def count_text(count: int, several: str) -> str:
    """Return a number of things: ``10 gaps``, ``1 gap``."""
    return f"{count:,} {escape(several if count != 1 else several.removesuffix('s'))}"


def title_html(overview: Overview, group: GroupOverview) -> str:
    """Return the labels of a group in which groups differ: ``length 5``."""
    return escape(", ".join(title_parts(overview, group)))


def title_parts(overview: Overview, group: GroupOverview, skip: int = 0) -> list[str]:
    """Return the labels of a group along the axes in which groups differ, but for the first few."""
    axes = varying(overview)[skip:]
    return [f"{overview.within[axis]} {group.labels[axis]}" for axis in axes]


def varying(overview: Overview) -> list[int]:
    """Return the places in `within` of the axes along which groups differ; all, if none does."""
    axes = [
        axis
        for axis in range(len(overview.within))
        if len({group.labels[axis] for group in overview.groups}) > 1
    ]
    return axes or list(range(len(overview.within)))


def has_panels(overview: Overview) -> bool:
    """Whether only the cards of one label of the first axis are in sight."""
    count = len(overview.groups)
    return _MOST_IN_SIGHT < count <= MOST_CARDS and len(varying(overview)) > 1


def why_none(group: GroupOverview) -> str:
    """Return why a group has no verdict."""
    if group.objection:
        return f"the rules for missing blocks disagree: {group.objection}"
    return group.caution
