"""A value of any type as a digest of what must be equal and a few numbers for the rest."""

from __future__ import annotations

import base64
import hashlib
import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph.store.arrays import decode_array

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph.store import Packed


TOLERANCE = 1e-9
"""Relative size of differences that another processor or library causes."""

FLOOR = 1e-3
"""Fraction of the size of its inputs below which a value may be their rounding errors."""

_SHRUNK = 2.0**-128
_MOST_UNITS = 2.0**900
"""Largest size of a value in its units, which are enlarged so that it does not overflow."""

_FEW = 64
"""Members of a list or mapping that are measured each by itself at most."""

COUNT = 4
"""Number of projections: all miss nine tenths of a difference once in 5,000 times."""

LARGE = 2.0**896
"""Sums of numbers below it do not overflow, however many memory holds."""

_EXACT_DIGITS = 8
_BLOCK = 65_536
_STEP = np.sqrt(3.0) / 2**15
_UPPER = slice(2, 8)
"""Six bytes of a little-endian double: eleven digits, and eight letters in base 64."""


def project(name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the root mean square size of an array along `COUNT` directions.

    Parameters
    ----------
    name
        Determines the directions; projections of one name can be compared.
    values : (N,) array of float64
        Finite, and below `LARGE`.

    Returns
    -------
    (COUNT,) array of float64
        ``sum(w * values) / sqrt(N)``; zeros for an empty array.
    """
    total = np.zeros(COUNT)
    if not values.size:
        return total
    key = int.from_bytes(hashlib.sha256(name.encode()).digest()[:16], "little")
    for block, start in enumerate(range(0, values.size, _BLOCK)):
        part = values[start : start + _BLOCK]
        total += part @ _weights(key, block, part.size)
    return np.asarray(total / np.sqrt(values.size))


def distance(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    """Estimate the root mean square difference of two arrays from their projections."""
    size = math.hypot(*(first - second)) / math.sqrt(COUNT)
    return size if math.isfinite(size) else math.inf


def _weights(key: int, block: int, size: int) -> NDArray[np.float64]:
    """Return (size, COUNT) weights, which do not depend on the version of NumPy.

    They are uniform: with signs alone, all projections would miss the exchange of two values once
    in sixteen times.
    """
    words = np.random.Philox(key=key, counter=block << 64).random_raw(size)
    pieces = words.astype("<u8").view("<u2").reshape(size, COUNT)
    return np.asarray((pieces.astype(np.float64) - (2**15 - 0.5)) * _STEP)


@dataclass(frozen=True)
class Leaf:
    """All floats at one place of a value.

    Attributes
    ----------
    size : float
        Root mean square of the finite ones.
    projections : (COUNT,) array of float64
        Projections of the numbers times `shrunk`.
    coarse : float
        Rounding error of the type in units of `TOLERANCE`; 1 for float64.
    shrunk : float
        A power of two that makes the numbers small enough for sums; 1 for most.
    """

    size: float
    projections: NDArray[np.float64]
    coarse: float = 1.0
    shrunk: float = 1.0


@dataclass(frozen=True)
class Sketch:
    """A summary of a value, from which another value of it can be compared.

    Attributes
    ----------
    exact : str
        Digest of types, shapes, texts, integers, booleans, and of which floats are NaN or
        infinite. The order of a mapping and the layout in memory do not count.
    leaves : mapping of place to Leaf
    """

    exact: str
    leaves: Mapping[str, Leaf]

    def text(self, scales: Mapping[str, float]) -> str:
        """Return the sketch in units of these sizes as a word."""
        exact = self.exact[:_EXACT_DIGITS]
        return f"{exact}-{_letters(self.against(scales).projections)}" if self.leaves else exact

    def compared(self, text: str, scales: Mapping[str, float]) -> tuple[bool, float]:
        """Compare with the word of another sketch in units of the same sizes.

        Returns
        -------
        bool
            Whether everything but the floats is equal.
        float
            The distance of the floats, relative to the value or its usual size.

        Raises
        ------
        ValueError
            If the word has another form.
        """
        exact, _, letters = text.partition("-")
        same = exact == self.exact[:_EXACT_DIGITS]
        if not (letters and self.leaves):
            return same, 0.0
        return same, self.against(scales).apart(_projections(letters))

    def against(self, scales: Mapping[str, float]) -> Measured:
        """Return the value in units of these sizes, one for each place."""
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
        """Return the distance of other projections, relative to the value or its usual size."""
        return distance(self.projections, other) / max(1.0, self.size)


def sketch(outputs: Mapping[str, Packed]) -> Sketch:
    """Return the sketch of the values of named outputs."""
    exact: list[object] = []
    floats: dict[str, list[NDArray[np.generic]]] = {}
    for name, packed in outputs.items():
        extraction = _FloatExtraction(packed.buffers, floats)
        exact.append([name, extraction.rest(json.loads(packed.head), name)])
    text = json.dumps(exact, separators=(",", ":"), sort_keys=True)
    digest = hashlib.sha256(text.encode()).hexdigest()
    return Sketch(digest, {place: _leaf(place, arrays) for place, arrays in floats.items()})


def _letters(projections: NDArray[np.float64]) -> str:
    content = projections.astype("<f8").view(np.uint8).reshape(-1, 8)[:, _UPPER]
    return base64.b64encode(content.tobytes()).decode("ascii")


def _projections(letters: str) -> NDArray[np.float64]:
    """Return the projections of a word, to eleven digits."""
    content = np.zeros((COUNT, 8), np.uint8)
    content[:, _UPPER] = np.frombuffer(base64.b64decode(letters, validate=True), np.uint8).reshape(
        COUNT, 6
    )
    return content.view("<f8").ravel().astype(np.float64)


def _below(size: float) -> float:
    """Return a power of two below a size, the same for sizes near it; 0 for 0."""
    return math.ldexp(1.0, (math.frexp(size)[1] - 1) // 64 * 64) if size else 0.0


def _leaf(place: str, arrays: list[NDArray[Any]]) -> Leaf:
    coarse = max(float(np.finfo(array.dtype).eps) / TOLERANCE for array in arrays)
    values = np.concatenate([array.astype(np.float64) for array in arrays])
    values[~np.isfinite(values)] = 0.0
    # divided by the largest, so that no square overflows
    largest = float(np.abs(values).max(initial=0.0))
    size = largest * float(np.sqrt(np.mean((values / largest) ** 2))) if largest else 0.0
    shrunk = 1.0 if largest < LARGE else _SHRUNK
    return Leaf(size, project(place, values * shrunk), max(1.0, coarse), shrunk)


class _FloatExtraction:
    """Separates the floats of a packed value from the rest."""

    def __init__(
        self, buffers: Iterable[memoryview], floats: dict[str, list[NDArray[np.generic]]]
    ) -> None:
        self._buffers = tuple(buffers)
        self._floats = floats

    def rest(self, plain: object, at: str) -> object:
        """Return a part of the value without its floats, as data for JSON."""
        if isinstance(plain, float):
            return self._without_numbers(np.array([plain]), at)
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
            fields = [self.rest(x, f"{at}.{name}") for name, x in zip(names, parts, strict=True)]
            return [word, plain[1], names, fields]
        if word == "stored":
            return [word, plain[1], self.rest(plain[2], at)]
        if word == "dict":
            return self._mapping(plain, at)
        return [word, *self._members(plain[1:], at)]

    def _members(self, parts: list[object], at: str) -> list[object]:
        few = len(parts) <= _FEW
        return [
            self.rest(part, f"{at}[{number}]" if few else f"{at}[]")
            for number, part in enumerate(parts)
        ]

    def _mapping(self, plain: list[object], at: str) -> object:
        items = zip(plain[1::2], plain[2::2], strict=True)
        pairs = sorted((json.dumps(key), item) for key, item in items)
        few = len(pairs) <= _FEW
        rest = [[key, self.rest(item, f"{at}[{key}]" if few else f"{at}[]")] for key, item in pairs]
        return ["dict", *rest]

    def _number(self, plain: list[Any], at: str) -> object:
        kind, content = ("<f8", plain[1]) if plain[0] == "float" else plain[1:]
        array = np.frombuffer(bytes.fromhex(content), kind)
        return self._without_numbers(array, at) if array.dtype.kind in "fc" else plain

    def _array(self, plain: list[Any], at: str) -> object:
        array = decode_array(self._buffers[plain[1]], *plain[2:])
        if array.dtype.kind in "fc":
            return self._without_numbers(array, at)
        content = hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()
        return ["array", array.dtype.str, list(array.shape), content]

    def _without_numbers(self, array: NDArray[np.generic], at: str) -> object:
        """Collect floats; return their type, shape, and which are not finite."""
        flat = array.ravel()
        if flat.dtype.kind == "c":
            flat = flat.view(flat.real.dtype)
        if flat.size:
            self._floats.setdefault(at, []).append(flat)
        return [array.dtype.str, list(array.shape), _not_finite(flat)]


def _not_finite(flat: NDArray[Any]) -> str:
    if np.isfinite(flat).all():
        return ""
    kinds = np.isnan(flat) + 2 * np.isposinf(flat) + 3 * np.isneginf(flat)
    return hashlib.sha256(kinds.astype(np.uint8).tobytes()).hexdigest()
