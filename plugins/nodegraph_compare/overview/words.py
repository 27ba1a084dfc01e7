"""Numbers and names of an overview as a reader sees them, in HTML."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING

from nodegraph_tables.style import unit_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from nodegraph_compare.overview.value import GroupOverview, Overview

MOST_CARDS = 8
"""Groups with a card each."""

_MOST_IN_SIGHT = 4
_NAMED = 3
_SMALLEST = 1e-3
_LARGEST = 1e6
MINUS = "\N{MINUS SIGN}"
SPACE = "\N{NO-BREAK SPACE}"


def number(value: float) -> str:
    """Return a number as the charts do: three decimals below 1, two below 10, fewer above."""
    size = abs(value)
    if not math.isfinite(value):
        return "\N{EN DASH}" if math.isnan(value) else "\N{INFINITY}"
    if not size:
        return "0"
    if not _SMALLEST <= size < _LARGEST:
        digits, _, power = f"{value:.1e}".partition("e")
        return f"{digits}e{int(power):+d}".replace("-", MINUS)
    decimals = 3 if size < 1 else 2 if size < 10 else 1 if size < 100 else 0
    return f"{value:.{decimals}f}".replace("-", MINUS)


def in_unit(values: Sequence[float], unit: str) -> str:
    """Return numbers from first to last with their unit, escaped; shares in percent."""
    if unit == "share":
        values, unit = [100 * value for value in values], "%"
    texts = dict.fromkeys(map(number, values))
    text = f"{' to '.join(texts)}{SPACE}{unit_text(unit)}"
    return escape(text.rstrip(SPACE))


def signed(value: float, unit: str, mean: float) -> str:
    """Return a difference with its sign, to the digits of the mean that it is to."""
    shown = round(value, 3) if abs(mean) >= _SMALLEST else value
    if value and not shown:
        return f"under {in_unit([_SMALLEST], unit)}"
    return f"{'+' if shown >= 0 else ''}{in_unit([shown], unit)}"


def percent(share: float) -> str:
    """Return a share: ``8 %``, ``0.4 %``, and ``less than 0.1 %``."""
    if 0 < share < 1e-3:
        return f"less than 0.1{SPACE}%"
    return f"{100 * share:.{0 if share >= 0.0095 or not share else 1}f}{SPACE}%"


def duration(seconds: float) -> str:
    """Return a time: ``1.1 ms``, ``140 ms``, ``2.3 s``."""
    if seconds < 1:
        return f"{1000 * seconds:.{1 if seconds < 0.01 else 0}f}{SPACE}ms"
    return f"{seconds:.1f}{SPACE}s"


def strong(text: object) -> str:
    """Return a name that stands out, escaped."""
    return f"<strong>{escape(str(text))}</strong>"


def method_names(overview: Overview, places: Iterable[int]) -> list[str]:
    """Return the names of methods, each marked with what it is a name of."""
    return [
        f'<strong data-method="{escape(name)}">{escape(name)}</strong>'
        for name in (str(overview.methods[place]) for place in places)
    ]


def few(texts: Sequence[str], most: int = _NAMED) -> str:
    """Return the first texts: ``a, b, c and 4 more``."""
    more = len(texts) - most
    return ", ".join(texts[:most]) + (f" and {more} more" if more > 0 else "")


def either(texts: Sequence[str]) -> str:
    """Return texts as alternatives: ``a, b or c``."""
    return " or ".join(filter(None, [", ".join(texts[:-1]), *texts[-1:]]))


def both(texts: Sequence[str]) -> str:
    """Return texts as a list: ``a, b and c``."""
    return " and ".join(filter(None, [", ".join(texts[:-1]), *texts[-1:]]))


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
