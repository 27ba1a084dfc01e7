"""Units of length that files come in, stated or judged by the size of what is recorded."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from nodegraph import quoted

if TYPE_CHECKING:
    from numpy.typing import NDArray

UnitSetting = Literal["auto", "um", "mm", "cm", "dm", "m", "in", "ft"]
AUTO: UnitSetting = "auto"

MILLIMETRES = {
    "um": 0.001,
    "mm": 1.0,
    "cm": 10.0,
    "dm": 100.0,
    "m": 1000.0,
    "in": 25.4,
    "ft": 304.8,
}
_WRITTEN_OUT = {"micromet": "um", "millimet": "mm", "centimet": "cm", "decimet": "dm", "met": "m"}
_ALIKE = {
    "µm": "um",
    "inch": "in",
    "inches": "in",
    "foot": "ft",
    "feet": "ft",
    # C3D files give four letters at times
    **{"mill": "mm", "cent": "cm", "deci": "dm", "mete": "m", "metr": "m"},
    **{
        start + end: unit
        for start, unit in _WRITTEN_OUT.items()
        for end in ("er", "re", "ers", "res")
    },
}
_USUAL = ("m", "cm", "mm")

_FEWEST_MARKERS = 4  # of fewer, the distances say nothing about the size
_MOST_FRAMES = 200  # that are looked at


@dataclass(frozen=True)
class Size:
    """The range of plausible sizes: the longest side along an axis, in millimetres."""

    least: float
    most: float

    def includes(self, extent: float, unit: str) -> bool:
        """Return whether an extent in that unit is plausible."""
        return self.least <= extent * MILLIMETRES[unit] <= self.most

    def unit_of(self, extent: float, assumed: str) -> str:
        """Return the unit assumed, or a usual one if that alone gives a plausible size."""
        if self.includes(extent, assumed):
            return assumed
        plausible = [unit for unit in _USUAL if self.includes(extent, unit)]
        return plausible[0] if len(plausible) == 1 else assumed


HEAD = Size(100.0, 500.0)
FACE_OR_BODY = Size(40.0, 5000.0)
"""Also a part of a face, or several bodies."""
FACE = Size(100.0, 400.0)
BODY = Size(700.0, 2500.0)


@dataclass(frozen=True)
class LengthUnit:
    """The unit of the lengths in a recording's file.

    Attributes
    ----------
    name : str
        One of `MILLIMETRES`.
    problem : str
        Why it is only assumed; empty if the file or the user states it.
    """

    name: str
    problem: str = ""

    def convert(self, positions: NDArray[np.float64]) -> None:
        """Convert (T, M, 3) positions to millimetres, in place.

        A unit that is only assumed gives way to the usual one that makes the markers as large as
        a face or a body, if the assumed one does not; a warning says which was taken.
        """
        name = self.name
        if self.problem:
            extent = extent_of(positions)
            name = FACE_OR_BODY.unit_of(extent, name)
            size = f", by which the markers span {extent * MILLIMETRES[name]:.4g} mm"
            warnings.warn(
                f"{self.problem}; {name} is assumed{size if np.isfinite(extent) else ''}",
                stacklevel=4,
            )
        if MILLIMETRES[name] != 1.0:
            positions *= MILLIMETRES[name]


def extent_of(positions: NDArray[np.float64]) -> float:
    """Return the longest side of the markers' bounding box along an axis, the median of frames.

    NaN if no frame has four markers.
    """
    step = -(-len(positions) // _MOST_FRAMES) or 1
    some = positions[::step]
    there = np.count_nonzero(~np.isnan(some[..., 0]), axis=1) >= _FEWEST_MARKERS
    some = some[there]
    if not len(some):
        return np.nan
    with np.errstate(over="ignore"):  # such lengths are refused where the recording is read
        # fmax and fmin pass over NaN
        sides = np.fmax.reduce(some, axis=1) - np.fmin.reduce(some, axis=1)
        return float(np.median(sides.max(axis=1)))


def unit_named(text: str) -> str | None:
    """Return the unit, one of `MILLIMETRES`, that a text names, or None."""
    name = text.strip().lower()
    name = _ALIKE.get(name, name)
    return name if name in MILLIMETRES else None


def unit_from(setting: str, stated: str, *, assumed: str = "mm") -> LengthUnit:
    """Return the unit that the user sets, or else a file states, or else the one assumed."""
    name = unit_named(stated) if setting == AUTO else setting
    if name is not None:
        return LengthUnit(name)
    is_stated = bool(stated.strip())
    problem = f"unit of length {quoted(stated)} is unknown" if is_stated else "no unit of length"
    return LengthUnit(assumed, problem)
