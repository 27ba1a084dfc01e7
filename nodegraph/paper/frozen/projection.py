"""A long array as a few numbers that tell how far another one is from it.

Each number is the array's product with pseudo-random weights of mean 0 and variance 1. Of two
arrays, the numbers differ by about as much as the arrays do: the square of a difference has the
expectation ``sum((a - b)**2)`` (Achlioptas 2003, Database-friendly random projections).
"""

from __future__ import annotations

import base64
import hashlib
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

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
