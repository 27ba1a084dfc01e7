"""How long a mesh's unit is, judged by the size that the head would have."""

from __future__ import annotations

import warnings
from pathlib import Path

from nodegraph_mocap.units import MILLIMETRES

_LEAST, _MOST = 100.0, 500.0
"""Millimetres that a head, a face or a bust may measure, the longest way along an axis."""

_USUAL = ("m", "cm", "mm")
"""At most one of them gives a plausible size, as they lie further apart than its bounds."""


def unit_of_mesh(path: Path, extent: float, *, assumed: str, stated: bool) -> str:
    """Return the unit in which a head's mesh was most likely written.

    That is the one assumed if it is stated or gives a plausible size, or else the one of metres,
    centimetres and millimetres that does; if none does, the one assumed. A warning says what was
    taken, where the assumed one is neither stated nor plausible, and where the size is not
    plausible at all.

    Parameters
    ----------
    path
        The file, for the warning.
    extent
        The mesh's longest side, along an axis, in its own unit.
    assumed
        The unit that the file's form, or somebody, says.
    stated
        Whether this file, or the user, says so and not only the form: then nothing is guessed.
    """
    unit = assumed
    if not (stated or _plausible(extent, assumed)):
        unit = next((one for one in _USUAL if _plausible(extent, one)), assumed)
    size = f"{extent * MILLIMETRES[unit]:.4g} mm"
    if not _plausible(extent, unit):
        _warn(path, f"the mesh is {size} long in {unit}, which no head is; set `unit`?")
    elif unit != assumed:
        wrong = f"{extent * MILLIMETRES[assumed]:.4g} mm"
        _warn(path, f"the head would be {wrong} long in {assumed}; {unit} is taken, giving {size}")
    return unit


def _plausible(extent: float, unit: str) -> bool:
    return _LEAST <= extent * MILLIMETRES[unit] <= _MOST


def _warn(path: Path, said: str) -> None:
    warnings.warn(f"{path}: {said}", stacklevel=5)
