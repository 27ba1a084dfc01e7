"""Parts that the figures of comparisons share."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

WIDE = 10.0
"""Times that values span, from which on a scale is logarithmic."""

_ROOM = 0.06
_MOST_TICKS = 5


class Span(NamedTuple):
    """A scale on which all means are in sight.

    Attributes
    ----------
    kind : {"linear", "log", "symlog"}
        ``symlog`` is logarithmic above `smallest` and linear below, down to 0.
    low, high : float
        Where it ends.
    smallest : float
        The smallest positive mean.
    """

    kind: Literal["linear", "log", "symlog"]
    low: float
    high: float
    smallest: float

    def along(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return distances along the scale, in decades where it is logarithmic."""
        if self.kind == "linear":
            return values
        ratio = values / self.smallest
        above = np.log10(np.maximum(ratio, 1e-300))
        return above if self.kind == "log" else np.where(ratio > 1.0, 1.0 + above, ratio)

    def back(self, place: float) -> float:
        """Return the value at a distance along the scale."""
        if self.kind == "linear":
            return place
        above = place if self.kind == "log" else place - 1.0
        if self.kind == "symlog" and above < 0.0:
            return self.smallest * place
        return float(self.smallest * 10.0**above)


def span_of(mean: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64]) -> Span:
    """Return the scale of means: logarithmic where they are more than ten times apart.

    The ends of intervals are in sight unless one reaches far beyond the others: out of the range
    of the means by more than a third of it and more than three times the median length.

    Parameters
    ----------
    mean, low, high : (N,) arrays of float64
        NaN counts for nothing.
    """
    known = np.isfinite(mean)
    mean, low, high = mean[known], low[known], high[known]
    if not len(mean):
        return Span("linear", 0.0, 1.0, 1.0)
    positive = mean[mean > 0.0]
    if len(positive) and mean.min() >= 0.0 and mean.max() > WIDE * positive.min():
        kind: Literal["log", "symlog"] = "log" if mean.min() > 0.0 else "symlog"
        scale, least = Span(kind, 0.0, 0.0, float(positive.min())), 0.3
        low = np.where(low > 0.0, low, np.nan)
    else:
        scale, least = Span("linear", 0.0, 0.0, 1.0), 0.1 * float(np.abs(mean).max()) or 1.0
    places, *ends = (scale.along(each) for each in (mean, low, high))
    first, last = float(places.min()), float(places.max())
    size = max(last - first, least)
    reached = np.concatenate(ends)
    lengths = np.abs(reached - np.tile(places, 2))
    usual = np.isfinite(lengths) & (lengths > 0.0)
    beyond = max(size / 3, 3 * float(np.median(lengths[usual])) if usual.any() else 0.0)
    near = reached[(reached > first - beyond) & (reached < last + beyond)]
    first, last = (float(edge) for edge in (min([first, *near]), max([last, *near])))
    room = _ROOM * max(last - first, least)
    return scale._replace(low=scale.back(first - room), high=scale.back(last + room))


def set_span(axis: Axes, span: Span) -> None:
    """Give an axis a scale along x, with plain numbers at a few round places."""
    if span.kind == "symlog":
        axis.set_xscale("symlog", linthresh=span.smallest)
    else:
        axis.set_xscale(span.kind)
    axis.set_xlim(span.low, span.high)
    axis.xaxis.set_minor_locator(NullLocator())
    if span.kind == "linear":
        axis.xaxis.set_major_locator(MaxNLocator(_MOST_TICKS - 1, steps=[1, 2, 2.5, 5, 10]))
        return
    axis.xaxis.set_major_locator(FixedLocator(_round_places(span)))
    axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def _round_places(span: Span) -> list[float]:
    least = span.low if span.kind == "log" else span.smallest
    first, last = math.floor(math.log10(least)), math.ceil(math.log10(span.high))
    zero = [0.0] if span.kind == "symlog" else []
    for steps, every in (((1, 2, 5), 1), ((1, 3), 1), ((1,), 1), ((1,), 2), ((1,), 4)):
        places = [step * 10.0**power for power in range(first, last + 1, every) for step in steps]
        inside = [place for place in places if least <= place <= span.high]
        if len(inside) <= _MOST_TICKS:
            break
    return [*zero, *inside]


def reach(
    mean: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the ends of the bars; an infinite end is left out, as it would set the scale.

    Parameters
    ----------
    mean, low, high : (N,) arrays of float64

    Returns
    -------
    (2, N) array of float64
        Below and above the mean.
    """
    reach = np.stack([mean - low, high - mean])
    return np.where(np.isfinite(reach), np.clip(reach, 0.0, None), 0.0)


def without_drawing(why: str) -> Figure:
    """Return a figure with the reason why nothing is drawn."""
    figure = Figure(figsize=(4.2, 1.2))
    figure.text(0.5, 0.5, why, ha="center", va="center")
    return figure
