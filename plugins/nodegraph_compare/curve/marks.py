"""Places on curves that are worth a mark: minima, knees, and where an error is small enough."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from nodegraph_compare.ties import ROUNDING, apart, at_most

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.curve.points import Points
    from nodegraph_compare.curve.scale import Scale

Mark = Literal["none", "minimum", "shared"] | float


def local_minima(value: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the places of a curve's interior local minima.

    A minimum is lower than the point before and the point after it, so neither end is one. Of
    neighbouring points with one value, lower than those around them, the first is the minimum.
    """
    if not len(value):
        return np.empty(0, dtype=np.intp)
    starts = np.flatnonzero(np.concatenate([[True], np.diff(value) != 0]))
    level = value[starts]
    inner = (level[1:-1] < level[:-2]) & (level[1:-1] < level[2:])
    return starts[1:-1][inner]


def shared_minimum(minima: Sequence[NDArray[np.float64]], tolerance: float) -> float | None:
    """Return the smallest minimum that every curve has one within `tolerance` of, if any.

    Parameters
    ----------
    minima
        The x of each curve's local minima.
    tolerance
        In units of x.
    """
    for x in np.unique(np.concatenate(minima)) if minima else ():
        # differences of places such as 0.8 - 0.6 do not come out exactly
        near = [np.abs(places - x) <= tolerance + ROUNDING * np.abs(x) for places in minima]
        if all(close.any() for close in near):
            return float(x)
    return None


def knee(x: NDArray[np.float64], value: NDArray[np.float64]) -> int | None:
    """Return the place of a curve's knee: the point farthest below the chord of its ends.

    ``argmax_i (y_1 + (y_n - y_1) (x_i - x_1) / (x_n - x_1) - y_i)``, the first of equals; none
    where no point lies below the chord. Measured along y, which gives the same place as the
    distance to the chord (Satopää et al. 2011, with sensitivity 0 and no smoothing).
    """
    if len(x) < 3:
        return None
    chord = value[0] + (value[-1] - value[0]) * (x - x[0]) / (x[-1] - x[0])
    below = apart(chord, value)
    place = int(np.argmax(below[1:-1])) + 1
    return place if below[place] > 0 else None


@dataclass(frozen=True)
class Marks:
    """The marks on curves.

    Attributes
    ----------
    minima : mapping of label to array of int
        The places of the curve's local minima among its points.
    shared : float or None
        The smallest x near which every curve has a minimum; None where there is none, or where
        `mark` does not look for any.
    places : mapping of label to int
        The marked point of each label.
    kinds : mapping of label to str
        ``shared``, ``minimum``, ``knee`` or ``enough``.
    """

    minima: Mapping[Label, NDArray[np.intp]]
    shared: float | None
    places: Mapping[Label, int]
    kinds: Mapping[Label, str]


def marks(
    curves: Sequence[Points],
    mark: Mark,
    tolerance: float,
    level: Mapping[Label, float] | None,
    scale: Scale,
) -> Marks:
    """Return the marks on the curves of all labels that have one.

    Parameters
    ----------
    curves
        The points of each label.
    mark
        ``shared``, ``minimum``, or ``none``, for which the minima alone are found; a number, for
        the point of each curve from which on none is larger.
    tolerance
        How far apart minima may lie and still be shared, in units of x.
    level
        The noise floor of each label, NaN for one without; None where there is no floor.
    scale
        On which knees are looked for.
    """
    minima = {
        points.label: points.curve[local_minima(points.value[points.curve])] for points in curves
    }
    drawn = [points for points in curves if len(points.curve)]
    shared = None
    if mark == "shared":
        shared = shared_minimum([points.x[minima[points.label]] for points in drawn], tolerance)
    places, kinds = {}, {}
    for points in drawn if mark != "none" else ():
        if isinstance(mark, str):
            place, kind = _minimum(points, minima[points.label], shared, mark)
            if place is None:
                place, kind = _knee(points, (level or {}).get(points.label, np.nan), scale), "knee"
        else:
            place, kind = within_from(points, mark), "enough"
        if place is not None:
            places[points.label], kinds[points.label] = place, kind
    return Marks(minima, shared, places, kinds)


def within_from(points: Points, most: float) -> int | None:
    """Return the place on a curve from which on no value is larger; None where the last is."""
    above = np.flatnonzero(~at_most(points.value[points.curve], most))
    within = points.curve[above[-1] + 1 :] if len(above) else points.curve
    return int(within[0]) if len(within) else None


def _minimum(
    points: Points, minima: NDArray[np.intp], shared: float | None, mark: Mark
) -> tuple[int | None, str]:
    if shared is not None and len(minima):
        return int(minima[np.argmin(np.abs(apart(points.x[minima], np.asarray(shared))))]), "shared"
    if mark == "minimum" and len(minima):
        return int(minima[np.argmin(points.value[minima])]), "minimum"
    return None, ""


def _knee(points: Points, floor: float, scale: Scale) -> int | None:
    """Return the place of the knee as drawn, what noise hides being level with the noise."""
    curve = points.curve
    place = knee(points.x[curve], scale.along(np.fmax(points.value[curve], floor)))
    return None if place is None else int(curve[place])
