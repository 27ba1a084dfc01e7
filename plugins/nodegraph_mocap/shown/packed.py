"""Arrays in one compressed blob, for a script in a page: small where neighbours are alike.

A blob is gzip over: the length of the head in four bytes, the head as JSON, the arrays one after
the other. Numbers are little-endian. ``player/data.js`` reads what is written here.
"""

from __future__ import annotations

import gzip
import json
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_STEPS = 2**30
"""How far from 0 a number may be, in steps; sums of two still fit 32 bits."""

_LEVEL = 6


class Blob:
    """Collects arrays; what each method returns is how the head names the array."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._length = 0

    def steps(
        self, values: NDArray[np.float64], step: float, like: NDArray[np.int32] | None = None
    ) -> tuple[dict[str, Any], NDArray[np.int32]]:
        """Add numbers, rounded to whole steps, each row as differences along itself.

        What is NaN repeats the number before it: where it is must be kept elsewhere. The four
        bytes of the differences lie apart, so that the upper ones, nearly always equal, vanish in
        the compression; and so do rows that are those of `like`.

        Parameters
        ----------
        values
            (rows, length), none farther from 0 than `MOST_STEPS` steps.
        step
            What one step is; a number is off by half of it at most.
        like
            Steps of the same shape from which to tell the differences.

        Returns
        -------
        dict, (rows, length) array of int32
            How the head names the array, and its steps.
        """
        whole = np.rint(held(values) / step).astype(np.int32)
        told = np.diff(whole if like is None else whole - like, axis=1, prepend=np.int32(0))
        planes = np.ascontiguousarray(told.astype("<i4")).view(np.uint8).reshape(-1, 4).T
        place = self._add(planes.tobytes())
        return {"at": place, "rows": whole.shape[0], "length": whole.shape[1], "step": step}, whole

    def small(self, values: NDArray[np.uint8]) -> int:
        """Add whole numbers from 0 to 255."""
        return self._add(np.ascontiguousarray(values).tobytes())

    def exact(self, values: NDArray[np.float64]) -> dict[str, int]:
        """Add numbers as float32, about seven digits of each."""
        return {"at": self._add(values.astype("<f4").tobytes()), "length": values.size}

    def packed(self, head: Any) -> bytes:
        """Return everything, under a head that names the arrays."""
        text = json.dumps(head, separators=(",", ":"), allow_nan=False).encode()
        # numbers of four bytes can be read in place only where they begin at a multiple of four
        text += b" " * (-len(text) % 4)
        content = b"".join([len(text).to_bytes(4, "little"), text, *self._parts])
        return gzip.compress(content, compresslevel=_LEVEL, mtime=0)

    def _add(self, content: bytes) -> int:
        place = self._length
        content += bytes(-len(content) % 4)
        self._parts.append(content)
        self._length += len(content)
        return place


def held(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (rows, length) numbers in which NaN repeats the one before it; 0 before the first."""
    known = ~np.isnan(values)
    if known.all():
        return values
    last = np.maximum.accumulate(np.where(known, np.arange(values.shape[1]), 0), axis=1)
    return np.nan_to_num(np.take_along_axis(values, last, axis=1))
