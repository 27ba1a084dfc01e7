"""A value of any type as a digest of what must be equal and a few numbers for the rest."""

from __future__ import annotations

import base64
import hashlib
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph.store.codec import array_together

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph.store import Packed


COUNT = 4
"""Of numbers: that all of them miss nine tenths of a difference happens once in 5,000 times."""

LARGE = 2.0**896
"""The sums of numbers below it, as many as memory holds, are far from the largest of all."""

_BLOCK = 65_536
_STEP = np.sqrt(3.0) / 2**15
_KEPT = slice(2, 8)
"""The six upper bytes of a little-endian double: eleven digits, and eight letters in base 64."""


def project(name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the root mean square size of an array along `COUNT` directions.

    Parameters
    ----------
    name
        Chooses the directions: arrays are compared under one name.
    values : (N,) array of float64
        Finite, and below `LARGE`.

    Returns
    -------
    (COUNT,) array of float64
        ``sum(w * values) / sqrt(N)``; linear in the values, zeros for none.
    """
    total = np.zeros(COUNT)
    if not values.size:
        return total
    key = _key(name)
    for block, start in enumerate(range(0, values.size, _BLOCK)):
        part = values[start : start + _BLOCK]
        total += part @ _weights(key, block, part.size)
    return np.asarray(total / np.sqrt(values.size))


def along_one(name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the values with the weights of the first direction, to be summed in parts."""
    key = _key(name)
    weighted = np.empty(values.size)
    for block, start in enumerate(range(0, values.size, _BLOCK)):
        part = values[start : start + _BLOCK]
        weighted[start : start + _BLOCK] = part * _weights(key, block, part.size)[:, 0]
    return weighted


def distance(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Return about how far two arrays are apart (root mean square), from their projections."""
    apart = np.abs(one - other)
    largest = float(apart.max())
    if not np.isfinite(largest):
        return np.inf
    # so that no square overflows
    return largest * float(np.sqrt(np.mean((apart / largest) ** 2))) if largest else 0.0


def as_text(projections: NDArray[np.float64]) -> str:
    """Return projections as a word."""
    content = projections.astype("<f8").view(np.uint8).reshape(-1, 8)[:, _KEPT]
    return base64.b64encode(content.tobytes()).decode("ascii")


def from_text(text: str) -> NDArray[np.float64]:
    """Return the projections of a word, to eleven digits.

    Raises
    ------
    ValueError
        If it is no such word.
    """
    content = np.zeros((COUNT, 8), np.uint8)
    content[:, _KEPT] = np.frombuffer(base64.b64decode(text, validate=True), np.uint8).reshape(
        COUNT, 6
    )
    found = content.view("<f8").ravel().astype(np.float64)
    if not np.isfinite(found).all():
        raise ValueError("a projection is no finite number")
    return found


def _key(name: str) -> int:
    return int.from_bytes(hashlib.sha256(name.encode()).digest()[:16], "little")


def _weights(key: int, block: int, size: int) -> NDArray[np.float64]:
    """Return (size, COUNT) weights; every version of NumPy gives the same ones.

    They are uniform and not signs alone, or two values that change places would show in none of
    the projections once in sixteen times.
    """
    words = np.random.Philox(key=key, counter=block << 64).random_raw(size)
    pieces = words.astype("<u8").view("<u2").reshape(size, COUNT)
    return np.asarray((pieces.astype(np.float64) - (2**15 - 0.5)) * _STEP)


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
        array = array_together(self._buffers[plain[1]], *plain[2:])
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


MOST = 64
"""Parts of an axis at most."""

FEWEST = 2

_ROUNDING = 2.0**-22
"""Of a number of this module: it is kept in four bytes."""

_LARGEST = 1e30
"""A part is the root of its size times as large, and that size may have sixteen digits."""

_CLEARLY = 0.25
"""Of the part that differs most: parts that differ by less are not among those named as such."""


@dataclass(frozen=True)
class Parts:
    """An array, part by part along its first axes.

    Attributes
    ----------
    shape : tuple of int
    sums : tuple of array of float64
        For each of the first axes, a number per part of it: the product of that part with
        pseudo-random weights of variance 1, over the root of its size.
    """

    shape: tuple[int, ...]
    sums: tuple[NDArray[np.float64], ...]

    @property
    def text(self) -> str:
        """It in two words, the first one being the shape."""
        sizes = "x".join(map(str, self.shape))
        counts = ",".join(str(one.size) for one in self.sums)
        content = np.concatenate(self.sums).astype("<f4").tobytes()
        return f"{sizes} {counts} {base64.b64encode(content).decode('ascii')}"

    @classmethod
    def read(cls, text: str) -> Parts:
        """Return what its text says.

        Raises
        ------
        ValueError
            If it says nothing.
        """
        sizes, counts, content = text.split(" ")
        numbers = np.frombuffer(base64.b64decode(content, validate=True), "<f4").astype(np.float64)
        ends = np.cumsum([int(one) for one in counts.split(",")])
        if ends[-1] != numbers.size:
            raise ValueError("not as many numbers as there should be")
        shape = tuple(int(one) for one in sizes.split("x"))
        return cls(shape, tuple(np.split(numbers, ends[:-1])))

    def apart(self, other: Parts, least: float) -> tuple[list[Span], ...]:
        """Return, for each of the first axes, which of its members differ.

        Parameters
        ----------
        other
            Of the same shape and with as many parts.
        least
            Size of a difference that counts.
        """
        return tuple(
            list(_spans(np.abs(one - here), np.maximum(least, _ROUNDING * np.abs(one)), members))
            for one, here, members in zip(self.sums, other.sums, self.shape, strict=False)
            if one.size == here.size
        )


@dataclass(frozen=True)
class Span:
    """Members of an axis that stand together: first, last, and whether they differ most."""

    first: int
    last: int
    most: bool


def parts_of(name: str, array: NDArray[Any], axes: int, most: int) -> Parts | None:
    """Return an array part by part; None if it has numbers that are too large for four bytes.

    Parameters
    ----------
    name
        Chooses the weights, as for `nodegraph.lock.sketch.project`.
    array
        Of floats; what is missing or infinite counts as 0.
    axes
        How many of the first axes are taken.
    most
        Parts of each at most.
    """
    values = np.nan_to_num(array.astype(np.float64), posinf=0.0, neginf=0.0)
    if np.abs(values).max(initial=0.0) > _LARGEST:
        return None
    weighted = along_one(name, values.ravel()).reshape(values.shape)
    return Parts(values.shape, tuple(_sums(weighted, axis, most) for axis in range(axes)))


def _sums(weighted: NDArray[np.float64], axis: int, most: int) -> NDArray[np.float64]:
    members = weighted.shape[axis]
    if not weighted.size:
        return np.zeros(0)
    starts = _starts(members, min(members, most))
    others = tuple(one for one in range(weighted.ndim) if one != axis)
    sizes = np.diff([*starts, members]) * (weighted.size // members)
    return np.asarray(np.add.reduceat(weighted.sum(axis=others), starts) / np.sqrt(sizes))


def _starts(members: int, parts: int) -> list[int]:
    return [part * members // parts for part in range(parts)]


def _spans(apart: NDArray[np.float64], least: NDArray[np.float64], members: int) -> Iterator[Span]:
    """Yield the members that differ; neighbours that are alike in that as one."""
    differ = np.flatnonzero(apart > least)
    if not differ.size:
        return
    clear = apart > _CLEARLY * apart.max()
    ends = [*_starts(members, apart.size), members]
    first = int(differ[0])
    for part, following in zip(differ, [*differ[1:], -1], strict=True):
        if following != part + 1 or clear[following] != clear[part]:
            yield Span(ends[first], ends[part + 1] - 1, bool(clear[part]))
            first = int(following)
