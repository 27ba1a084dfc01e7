"""Sentences on what the charts of an overview show."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.overview.words import (
    both,
    count_text,
    duration,
    in_unit,
    method_names,
    percent,
    title_parts,
    varying,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.overview.value import GroupOverview, Overview

_NEAR = 1.1
_FEWEST_ROWS = 3


def shown_group(overview: Overview) -> int:
    """Return the group that charts of one group begin with: the last in sight with numbers."""
    _, row = _along(overview)
    known = [group for group in row if np.isfinite(group.mean).any()]
    return overview.groups.index((known or row)[-1])


def ranking_finding(overview: Overview) -> str:
    """Return who climbs and who falls along the last axis, and how far methods lie apart."""
    axis, row = _along(overview)
    if len(row) < 2:
        group = overview.groups[shown_group(overview)]
        spread = _spread(overview, [group])
        return f"From the best to the worst is a factor of {spread}." if spread else ""
    first, last = row[0], row[-1]
    places = [_places(overview, group) for group in (first, last)]
    both_known = np.isfinite(places[0]) & np.isfinite(places[1])
    change = np.where(both_known, places[1] - places[0], 0.0)
    moves = []
    for place, verb in ((int(np.argmin(change)), "climbs"), (int(np.argmax(change)), "falls")):
        if change[place] * (1 if verb == "falls" else -1) >= 1:
            (name,) = method_names(overview, [place])
            moves.append(
                f"{name} {verb} from place {places[0][place]:.0f} to {places[1][place]:.0f}"
            )
    name = overview.within[axis]
    ends = f"From {name} {first.labels[axis]} to {last.labels[axis]}"
    text = f"{escape(ends)} {both(moves) or 'the order stays'}."
    spread = _spread(overview, row)
    return f"{text} From the best to the worst is a factor of {spread}." if spread else text


def cost_finding(overview: Overview, seconds: Mapping[Label, float]) -> str:
    """Return what the best costs, and what else is near it and cheaper."""
    group = overview.groups[shown_group(overview)]
    if not group.best or not overview.ratio:
        return ""
    best = group.best[0]
    times = np.array([seconds.get(method, np.nan) for method in overview.methods])
    if not np.isfinite(times[best]):
        return ""
    start = _start(overview, group)
    (name,) = method_names(overview, [best])
    worse = group.mean / group.mean[best]
    worse = 1 / worse if overview.metric.better == "higher" else worse
    near = (worse <= _NEAR) & (times < times[best])
    if not near.any():
        text = f"{start}nothing within 10 % of {name} is faster ({duration(times[best])})."
    else:
        place = int(np.nanargmin(np.where(near, times, np.nan)))
        (other,) = method_names(overview, [place])
        text = (
            f"{start}{name} takes {duration(times[best])}; {other}, "
            f"{percent(max(worse[place] - 1, 0.0))} behind, {duration(times[place])}."
        )
    cheapest = int(np.nanargmin(np.where(np.isfinite(worse), times, np.nan)))
    if cheapest != best and not near[cheapest]:
        (other,) = method_names(overview, [cheapest])
        text += (
            f" {other} is fastest, {duration(times[cheapest])} at {worse[cheapest]:.2f} times the "
            "error."
        )
    return text


def place_finding(overview: Overview, column: str) -> str:
    """Return at which labels of a column of the blocks the best method errs most, and least."""
    group = overview.groups[shown_group(overview)]
    if not group.best:
        return ""
    best = group.best[0]
    errors = group.errors[overview.metric.name][:, best].astype(np.float64)
    codes = group.rows[column]
    used = np.isfinite(errors) & (group.unit >= 0)
    count = np.bincount(codes[used], minlength=len(overview.columns[column]))
    total = np.bincount(codes[used], weights=errors[used], minlength=len(count))
    means = np.where(count > 0, total / np.maximum(count, 1), np.nan)
    if np.count_nonzero(count) < 2:
        return ""
    high, low = int(np.nanargmax(means)), int(np.nanargmin(means))
    (name,) = method_names(overview, [best])
    unit = overview.metric.unit
    ends = [
        f"{escape(str(overview.columns[column][at]))} ({in_unit([means[at]], unit)})"
        for at in (high, low)
    ]
    words = ("highest", "lowest") if overview.metric.better == "higher" else ("hardest", "easiest")
    typical = count_text(int(np.median(count[count > 0])), overview.blocks)
    return (
        f"{_start(overview, group)}{words[0]} for {name} is {ends[0]}, {words[1]} {ends[1]}; "
        f"about {typical} stand behind each."
    )


def block_finding(overview: Overview) -> str:
    """Return whether few blocks make the mean of the best method."""
    group = overview.groups[shown_group(overview)]
    if not group.best:
        return ""
    best = group.best[0]
    used = group.unit >= 0
    errors = group.errors[overview.metric.name][:, best].astype(np.float64)
    counted = errors[used]
    if len(counted) < _FEWEST_ROWS:
        return ""
    (name,) = method_names(overview, [best])
    unit = overview.metric.unit
    side = "at least" if overview.metric.better == "higher" else "within"
    worst = counted.min() if overview.metric.better == "higher" else counted.max()
    text = (
        f"{_start(overview, group)}half of the {count_text(len(counted), overview.blocks)} come "
        f"out {side} {in_unit([float(np.median(counted))], unit)} by {name}, the worst at "
        f"{in_unit([float(worst)], unit)}."
    )
    suspect = np.zeros(len(errors), dtype=bool)
    suspect[list(group.suspect)] = True
    if (suspect & used).any() and counted.min() >= 0 and counted.sum() > 0:
        share = float(errors[suspect & used].sum() / counted.sum())
        several = f"{len(group.suspect)} suspect {escape(overview.blocks)}"
        text += (
            f' <span class="overview-suspect">\N{WHITE DIAMOND} {several}</span> '
            f"({percent(len(group.suspect) / len(errors))}) make {percent(share)} of it."
        )
    return text


def _along(overview: Overview) -> tuple[int, list[GroupOverview]]:
    """Return the last axis of the groups, and the groups along it with the others' first labels."""
    axes = varying(overview)
    if not axes:
        return 0, list(overview.groups)
    first = overview.groups[0].labels
    return axes[-1], [
        group
        for group in overview.groups
        if all(group.labels[axis] == first[axis] for axis in axes[:-1])
    ]


def _places(overview: Overview, group: GroupOverview) -> NDArray[np.float64]:
    """Return (K,) the places of methods by their means, 1 for the best."""
    sign = -1.0 if overview.metric.better == "higher" else 1.0
    order = np.argsort(np.argsort(sign * group.mean)) + 1.0
    return np.where(np.isfinite(group.mean), order, np.nan)


def _spread(overview: Overview, groups: list[GroupOverview]) -> str:
    """Return the largest over the smallest mean of each group; empty where it means nothing."""
    if not overview.ratio:
        return ""
    factors = [
        float(np.nanmax(group.mean) / np.nanmin(group.mean))
        for group in groups
        if np.count_nonzero(np.isfinite(group.mean)) > 1
    ]
    return ", ".join(f"{factor:.{1 if factor < 10 else 0}f}" for factor in factors)


def _start(overview: Overview, group: GroupOverview) -> str:
    title = ", ".join(title_parts(overview, group))
    return f"{escape(title)}: " if title else ""
