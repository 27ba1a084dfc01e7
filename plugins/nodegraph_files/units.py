"""Units of length that recordings come in."""

from __future__ import annotations

import warnings

MILLIMETRES = {
    "um": 0.001,
    "mm": 1.0,
    "cm": 10.0,
    "dm": 100.0,
    "m": 1000.0,
    "in": 25.4,
    "inch": 25.4,
    "ft": 304.8,
}
_WRITTEN_OUT = {"millimet": "mm", "centimet": "cm", "decimet": "dm", "met": "m"}
_ALIKE = {
    "µm": "um",
    "inches": "inch",
    "foot": "ft",
    "feet": "ft",
    **{
        start + end: unit
        for start, unit in _WRITTEN_OUT.items()
        for end in ("er", "re", "ers", "res")
    },
}


def millimetres_in(unit: str) -> float | None:
    """Return how many millimetres a unit is, or None if it is unknown."""
    name = unit.strip().lower()
    return MILLIMETRES.get(_ALIKE.get(name, name))


def to_millimetres(unit: str) -> float:
    """Return how many millimetres a unit is; an unknown one is taken for mm, with a warning."""
    factor = millimetres_in(unit)
    if factor is None:
        problem = (
            f"unit of length {unit!r} is unknown" if unit.strip() else "no unit of length given"
        )
        warnings.warn(f"{problem}; millimetres are assumed", stacklevel=3)
        return 1.0
    return factor
