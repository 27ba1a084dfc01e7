"""What every reader of recordings does: units, names of markers, samples that are missing."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

MILLIMETRES = {
    "um": 0.001,
    "µm": 0.001,
    "mm": 1.0,
    "millimeter": 1.0,
    "millimetre": 1.0,
    "cm": 10.0,
    "centimeter": 10.0,
    "centimetre": 10.0,
    "dm": 100.0,
    "m": 1000.0,
    "meter": 1000.0,
    "metre": 1000.0,
    "in": 25.4,
    "inch": 25.4,
    "inches": 25.4,
    "ft": 304.8,
    "foot": 304.8,
    "feet": 304.8,
}


def millimetres_per(unit: str) -> float | None:
    """Return how many millimetres a unit of length is, or None for an unknown unit."""
    name = unit.strip().casefold()
    return MILLIMETRES.get(name, MILLIMETRES.get(name.removesuffix("s")))


def whole_samples(positions: NDArray[np.float64], *, zeros_missing: bool) -> NDArray[np.float64]:
    """Make every sample either a position or wholly missing, and tell what was dropped.

    Parameters
    ----------
    positions
        (T, M, 3); changed in place.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing.

    Returns
    -------
    (T, M, 3) array
        The same array.
    """
    finite = np.isfinite(positions)
    if not finite.all():
        infinite = np.isinf(positions).any(axis=2)
        partly = finite.any(axis=2) & ~finite.all(axis=2) & ~infinite
        positions[~finite.all(axis=2)] = np.nan
        _tell(infinite, "with an infinite coordinate count as missing")
        _tell(partly, "with only one or two coordinates count as missing")
    if zeros_missing:
        zeros = ~positions.any(axis=2)
        positions[zeros] = np.nan
        _tell(zeros, "at exactly (0, 0, 0) count as missing")
    return positions


def unique_names(labels: Sequence[str], count: int) -> tuple[str, ...]:
    """Return one name per marker: a marker without a name, or with another's, gets its own.

    A subject's prefix (``subject:marker``) that all labels share is taken off.
    """
    spare = [label for label in labels[count:] if label]
    if spare:
        warnings.warn(
            f"{len(spare)} labels more than the {count} markers were left out: "
            f"{_listed(spare)}",
            stacklevel=3,
        )
    wanted = _without_subject([*labels[:count], *[""] * (count - len(labels))])
    names: dict[str, None] = {}
    renamed = []
    taken = set(wanted)
    for place, label in enumerate(wanted, start=1):
        name = label
        if not label or label in names:
            name = _free(label, place, taken)
            renamed.append(f"{label!r} -> {name!r}")
        names[name] = None
        taken.add(name)
    if renamed:
        warnings.warn(
            f"{len(renamed)} markers had no name, or another's: {_listed(renamed)}", stacklevel=3
        )
    return tuple(names)


def _free(label: str, place: int, taken: set[str]) -> str:
    name = f"{label}_{place}" if label else f"unnamed_{place}"
    while name in taken:
        name += "_"
    return name


def _without_subject(labels: list[str]) -> list[str]:
    parts = [label.partition(":") for label in labels]
    subjects = Counter(subject for subject, colon, marker in parts if colon and marker)
    shared = len(subjects) == 1 and subjects.total() == len(labels)
    return [marker for _, _, marker in parts] if shared else labels


def _tell(samples: NDArray[np.bool_], what: str) -> None:
    count = np.count_nonzero(samples)
    if count:
        frame, marker = np.argwhere(samples)[0]
        warnings.warn(
            f"{count} samples {what}; the first in frame {frame}, marker number {marker + 1}",
            stacklevel=4,
        )


def _listed(texts: Sequence[str]) -> str:
    shown = ", ".join(texts[:10])
    return f"{shown}, and {len(texts) - 10} more" if len(texts) > 10 else shown
