"""Numbers as a reader sees them outside of tables: on cards, in sentences, as in charts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from nodegraph_tables.style import SHARE, SMALLEST_CHANCE, scale_of, unit_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

MINUS = "\N{MINUS SIGN}"
SPACE = "\N{NO-BREAK SPACE}"
SMALLEST, LARGEST = 1e-3, 1e6
"""Smaller and larger numbers are shown with a power of ten."""

MANY_TIMES = 2.0
"""From here on a number is so many times another, and not so many percent above it."""

_WHOLE = 0.95
"""Percent from which on shares are shown in whole ones."""

ROUNDING = 1e-15
"""Share of the largest number that is no more than the last digit of its sum."""


def number_text(value: float, unit: str = "") -> str:
    r"""Return a number: three decimals below 1, two below 10, fewer above; shares in percent.

    `page.number` of the scripts of a report writes numbers by the same rule.

    Examples
    --------
    >>> number_text(213.0), number_text(12.34), number_text(0.49712)
    ('213', '12.3', '0.497')
    """
    return span_text([value], unit)


def span_text(values: Sequence[float], unit: str = "") -> str:
    """Return numbers from first to last with their unit; equal ones once, shares in percent.

    Counts, which are of type int, stand as they are.
    """
    scale = scale_of(unit)
    texts = dict.fromkeys(
        f"{value:,}" if isinstance(value, int) else _digits(scale * value) for value in values
    )
    return f"{' to '.join(texts)}{SPACE}{unit_text(unit)}".rstrip(SPACE)


def difference_text(pairs: Sequence[tuple[float, float]], unit: str = "") -> str:
    """Return by how much numbers are above others, in the digits of the larger ones.

    Examples
    --------
    >>> difference_text([(0.333, 0.3114)]), difference_text([(12.34, 9.876)])
    ('0.022', '2.5')
    >>> difference_text([(30, 12)]), difference_text([(0.1004, 0.0998)])
    ('18', 'under 0.001')
    """
    texts = dict.fromkeys(_difference(*_scaled(pair, unit), unit) for pair in pairs)
    return f"{' to '.join(texts)}{SPACE}{unit_text(unit)}".rstrip(SPACE)


def apart_text(values: Sequence[float], unit: str = "") -> str:
    """Return by how much the larger of two numbers is above the other."""
    return difference_text([(max(values), min(values))], unit)


def change_percent(value: float, to: float) -> str:
    r"""Return how far a number is from one above 0, as a share of that.

    Examples
    --------
    >>> change_percent(0.1306, 0.1204), change_percent(0.5, 2.0)
    ('8\xa0%', '75\xa0%')
    """
    return percent(abs(value / to - 1.0))


def above_text(value: float, to: float) -> str:
    r"""Return how far a number is above one above 0: in percent, or how many times it is that.

    Examples
    --------
    >>> above_text(0.1306, 0.1204), above_text(24.0, 8.85)
    ('8\xa0%', '2.7 times')
    """
    return f"{value / to:,.1f} times" if value >= MANY_TIMES * to else change_percent(value, to)


def is_seen(value: float, to: float, unit: str = "") -> bool:
    """Whether numbers, as these are shown, are more than one apart in their last digit.

    Examples
    --------
    >>> is_seen(0.128, 0.126), is_seen(0.1953, 0.1944)
    (True, False)
    """
    value, to = _scaled((value, to), unit)
    decimals = _common_decimals(value, to, unit)
    if decimals is None:
        return value != to
    return abs(round(value, decimals) - round(to, decimals)) > 1.5 * 10.0**-decimals


def to_digits_of(mean: float, values: Sequence[float]) -> list[float]:
    """Return numbers to the digits that a mean is shown with."""
    return [round(value, 3) if abs(mean) >= SMALLEST else value for value in values]


def without_rounding(values: Sequence[Any]) -> list[Any]:
    """Return numbers of one kind, with 0 for what rounding has left of them: 1e-31 beside 30.

    Numbers that are all whole are of type int.
    """
    sizes = [abs(value) for value in values if isinstance(value, float) and math.isfinite(value)]
    least = ROUNDING * max(sizes, default=0.0)
    if len(sizes) == len(values) and all(abs(value - round(value)) <= least for value in values):
        return [round(value) for value in values]
    return [0.0 if isinstance(value, float) and abs(value) < least else value for value in values]


def chance_text(p: float) -> str:
    """Return a p for a sentence: ``p = 0.0340``, ``p < 0.0001``."""
    text = chance_digits(p)
    return f"p {text}" if text.startswith("<") else f"p = {text}"


def chance_digits(p: float) -> str:
    """Return a p in four decimals: ``0.0340``, ``< 0.0001``."""
    return f"< {SMALLEST_CHANCE:g}" if p < SMALLEST_CHANCE else f"{p:.4f}"


def percent(share: float) -> str:
    """Return a share in few digits: ``8 %``, ``0.4 %``, ``under 0.1 %`` and ``above -0.1 %``."""
    size = abs(share)
    if 0 < size < 5e-4:
        return f"{'under ' if share > 0 else f'above {MINUS}'}0.1{SPACE}%"
    decimals = 0 if 100 * size >= _WHOLE or not size else 1
    return f"{100 * share:.{decimals}f}{SPACE}%".replace("-", MINUS)


def shares_text(shares: Sequence[float]) -> str:
    """Return shares from first to last in few digits: ``0 to 0.3 %``."""
    first, *rest = dict.fromkeys(map(percent, shares))
    return " to ".join([first.removesuffix(f"{SPACE}%") if rest else first, *rest])


def ends_text(values: Iterable[float], unit: str = "") -> str:
    """Return the least and the largest of numbers, shares in few digits."""
    ends = sorted({*values})
    ends = [ends[0], ends[-1]]
    return shares_text(ends) if unit == SHARE else span_text(ends, unit)


def ranged(text: str, axes: Sequence[str]) -> str:
    """Return numbers of groups with that by which they range: ``1 to 2 mm by length``.

    Without that a range would read like an interval.

    Parameters
    ----------
    text
        One number, or the least and the largest.
    axes
        Along which the groups differ.
    """
    by = axes[0] if len(axes) == 1 else "group"
    return f"{text} by {by}" if " to " in text else text


def _digits(value: float) -> str:
    size = abs(value)
    if not math.isfinite(value):
        return "\N{EN DASH}" if math.isnan(value) else "\N{INFINITY}"
    if not size:
        return "0"
    if not SMALLEST <= size < LARGEST:
        digits, _, power = f"{value:.1e}".partition("e")
        return f"{digits}e{int(power):+d}".replace("-", MINUS)
    return f"{value:,.{_decimals(size)}f}".replace("-", MINUS)


def _decimals(size: float) -> int:
    return 3 if size < 1 else 2 if size < 10 else 1 if size < 100 else 0


def _scaled(pair: tuple[float, float], unit: str) -> tuple[float, float]:
    """Return two numbers in their unit; counts, which are of type int, as they are."""
    value, to = (each if isinstance(each, int) else scale_of(unit) * each for each in pair)
    return value, to


def _common_decimals(value: float, to: float, unit: str) -> int | None:
    """Return the decimals with which two numbers are shown; None for counts and powers of ten."""
    largest = max(abs(value), abs(to))
    counts = isinstance(value, int) and isinstance(to, int)
    if counts or not SMALLEST <= largest < LARGEST:
        return None
    # shares are shown in fewer digits
    return int(largest < _WHOLE) if unit == SHARE else _decimals(largest)


def _difference(value: float, to: float, unit: str) -> str:
    difference, decimals = value - to, _common_decimals(value, to, unit)
    if isinstance(difference, int):
        return f"{difference:,}".replace("-", MINUS)
    if value == to or decimals is None:
        return _digits(difference)
    least = 10.0**-decimals
    # numbers that look the same are not said to be apart
    if abs(difference) < least / 2 or round(value, decimals) == round(to, decimals):
        return f"under {least:g}"
    return f"{difference:,.{decimals}f}".replace("-", MINUS)
