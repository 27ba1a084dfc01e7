"""A value of any type as a digest of what must be equal and a few numbers for the rest."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph.paper.frozen.projection import COUNT, LARGE, distance, project
from nodegraph.store.arrays import array_together

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph.store import Packed

TOLERANCE = 1e-9
"""Relative size of differences that come from another processor or library, and from no change."""

FLOOR = 1e-3
"""Of the size of what a value is made of: what is smaller may be its rounding and nothing else."""

_SHRUNK = 2.0**-128
_MOST_UNITS = 2.0**900
"""A value is measured in larger units if it has more of them: that many more overflow."""

_FEW = 64
"""Up to so many members of a list or mapping are measured one by one, more of them together."""


@dataclass(frozen=True)
class Leaf:
    """All floats that lie at one place of a value.

    Attributes
    ----------
    size : float
        Root mean square of the finite ones.
    projections : (COUNT,) array of float64
        Of the numbers times `shrunk`.
    coarse : float
        By how much the type's own rounding exceeds `TOLERANCE`; 1 for float64.
    shrunk : float
        A power of two, by which the numbers are small enough for their sums; 1 for most.
    """

    size: float
    projections: NDArray[np.float64]
    coarse: float = 1.0
    shrunk: float = 1.0


@dataclass(frozen=True)
class Sketch:
    """What is known of a value without having it.

    Attributes
    ----------
    exact : str
        Digest of types, shapes, texts, whole numbers, truths, and of which floats are missing or
        infinite. The order of a mapping and of axes in memory does not count.
    leaves : mapping of place to Leaf
    """

    exact: str
    leaves: Mapping[str, Leaf]

    def against(self, scales: Mapping[str, float]) -> Measured:
        """Return the value in units of the given sizes, one for each place."""
        projections, size = np.zeros(COUNT), 0.0
        for place in sorted(self.leaves):
            leaf = self.leaves[place]
            shrunk = leaf.size * leaf.shrunk
            unit = leaf.coarse * ((scales.get(place) or 1.0) * leaf.shrunk)
            unit = max(unit, _below(shrunk) / _MOST_UNITS)
            projections += leaf.projections / unit
            size = math.hypot(size, shrunk / unit)
        return Measured(projections, size)


@dataclass(frozen=True)
class Measured:
    """All floats of a value in units of their usual size.

    Attributes
    ----------
    projections : (COUNT,) array of float64
    size : float
        About 1 for one place, the root of their number for several.
    """

    projections: NDArray[np.float64]
    size: float

    def apart(self, other: NDArray[np.float64]) -> float:
        """Return how far other projections are away, relative to the value or its usual size."""
        return distance(self.projections, other) / max(1.0, self.size)


def sketch(outputs: Mapping[str, Packed]) -> Sketch:
    """Return the sketch of values by their names."""
    exact: list[Any] = []
    found: dict[str, list[NDArray[Any]]] = {}
    for name, packed in outputs.items():
        taken = _Taken(packed.buffers, found)
        exact.append([name, taken.rest(json.loads(packed.head), name)])
    text = json.dumps(exact, separators=(",", ":"), sort_keys=True)
    digest = hashlib.sha256(text.encode()).hexdigest()
    return Sketch(digest, {place: _leaf(place, arrays) for place, arrays in found.items()})


def _below(size: float) -> float:
    """Return a power of two below a size, the same one for all sizes near it; 0 for 0."""
    return math.ldexp(1.0, (math.frexp(size)[1] - 1) // 64 * 64) if size else 0.0


def _leaf(place: str, arrays: list[NDArray[Any]]) -> Leaf:
    coarse = max(float(np.finfo(one.dtype).eps) / TOLERANCE for one in arrays)
    values = np.concatenate([one.astype(np.float64) for one in arrays])
    values[~np.isfinite(values)] = 0.0
    # the largest number comes out first, so that no square overflows
    largest = float(np.abs(values).max(initial=0.0))
    size = largest * float(np.sqrt(np.mean((values / largest) ** 2))) if largest else 0.0
    shrunk = 1.0 if largest < LARGE else _SHRUNK
    return Leaf(size, project(place, values * shrunk), max(1.0, coarse), shrunk)


class _Taken:
    """Takes the floats out of a value that was taken apart for storing."""

    def __init__(self, buffers: Iterable[Any], found: dict[str, list[NDArray[Any]]]) -> None:
        self._buffers = tuple(buffers)
        self._found = found

    def rest(self, plain: Any, at: str) -> Any:
        """Return what is left of a part without its floats, as data for JSON."""
        if isinstance(plain, float):
            return self._floats(np.array([plain]), at)
        if not isinstance(plain, list):
            return plain
        word = plain[0]
        if word == "array":
            return self._array(plain, at)
        if word == "number" or (word == "float" and len(plain) == 2):
            return self._number(plain, at)
        if word == "bytes":
            return ["bytes", hashlib.sha256(self._buffers[plain[1]]).hexdigest()]
        if word == "value":
            names, parts = plain[2], plain[3:]
            held = [self.rest(one, f"{at}.{n}") for n, one in zip(names, parts, strict=True)]
            return [word, plain[1], names, held]
        if word == "stored":
            return [word, plain[1], self.rest(plain[2], at)]
        if word == "dict":
            return self._mapping(plain, at)
        return [word, *self._members(plain[1:], at)]

    def _members(self, parts: list[Any], at: str) -> list[Any]:
        one_by_one = len(parts) <= _FEW
        return [
            self.rest(one, f"{at}[{number}]" if one_by_one else f"{at}[]")
            for number, one in enumerate(parts)
        ]

    def _mapping(self, plain: list[Any], at: str) -> Any:
        pairs = sorted((json.dumps(key), one) for key, one in zip(*_pairs(plain), strict=True))
        one_by_one = len(pairs) <= _FEW
        held = [
            [key, self.rest(one, f"{at}[{key}]" if one_by_one else f"{at}[]")] for key, one in pairs
        ]
        return ["dict", *held]

    def _number(self, plain: list[Any], at: str) -> Any:
        kind, content = ("<f8", plain[1]) if plain[0] == "float" else plain[1:]
        array = np.frombuffer(bytes.fromhex(content), kind)
        return self._floats(array, at) if array.dtype.kind in "fc" else plain

    def _array(self, plain: list[Any], at: str) -> Any:
        array = array_together(plain[2:], self._buffers[plain[1]])
        if array.dtype.kind in "fc":
            return self._floats(array, at)
        content = hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()
        return ["array", array.dtype.str, list(array.shape), content]

    def _floats(self, array: NDArray[Any], at: str) -> Any:
        """Keep floats, and return their type, their shape and which of them are no numbers."""
        flat = array.ravel()
        if flat.dtype.kind == "c":
            flat = flat.view(flat.real.dtype)
        if flat.size:
            self._found.setdefault(at, []).append(flat)
        return [array.dtype.str, list(array.shape), _lacking(flat)]


def _lacking(flat: NDArray[Any]) -> str:
    if np.isfinite(flat).all():
        return ""
    kinds = np.isnan(flat) + 2 * np.isposinf(flat) + 3 * np.isneginf(flat)
    return hashlib.sha256(kinds.astype(np.uint8).tobytes()).hexdigest()


def _pairs(plain: list[Any]) -> tuple[list[Any], list[Any]]:
    return plain[1::2], plain[2::2]
