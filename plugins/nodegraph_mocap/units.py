"""Units of length that recordings come in."""

from __future__ import annotations

import warnings

MILLIMETRES = {"mm": 1.0, "cm": 10.0, "dm": 100.0, "m": 1000.0, "in": 25.4, "inch": 25.4}


def to_millimetres(unit: str) -> float:
    """Return how many millimetres a unit is; an unknown one is taken for mm, with a warning."""
    name = unit.strip().lower()
    if name not in MILLIMETRES:
        said = f"unit of length {unit!r} is unknown" if name else "no unit of length is given"
        warnings.warn(f"{said}; millimetres are assumed", stacklevel=2)
    return MILLIMETRES.get(name, 1.0)
