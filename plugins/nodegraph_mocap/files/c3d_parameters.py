"""The parameter section of a C3D file: groups of named values.

Layout after the C3D file format user guide (https://www.c3d.org). A section that is damaged is
refused with the byte at which it is, because every number of the recording depends on it.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

BLOCK = 512
INTEL, DEC, MIPS = 84, 85, 86
TEXT, BYTE, INTEGER, FLOAT = -1, 1, 2, 4


@dataclass(frozen=True)
class Processor:
    """How the machine that wrote a file writes numbers."""

    code: int

    def __post_init__(self) -> None:
        if self.code not in (INTEL, DEC, MIPS):
            raise ValueError(f"it was written by a processor of unknown kind {self.code}")

    @property
    def order(self) -> str:
        """Byte order, as `struct` and NumPy write it."""
        return ">" if self.code == MIPS else "<"

    def integer(self, data: bytes) -> int:
        """Return an unsigned integer."""
        return int.from_bytes(data, "big" if self.code == MIPS else "little")

    def integers(self, data: bytes | memoryview) -> NDArray[np.int16]:
        """Return 16-bit signed integers."""
        return np.frombuffer(data, f"{self.order}i2")

    def floats(self, data: bytes | memoryview) -> NDArray[np.floating[Any]]:
        """Return 32-bit floating-point numbers.

        DEC stores the two halves of a number the other way round, and an exponent that is
        larger by two.
        """
        if self.code == DEC:
            halves = np.frombuffer(data, "<u2").reshape(-1, 2)[:, ::-1]
            with np.errstate(invalid="ignore"):  # of bits that are no number
                return halves.copy().view("<f4").ravel().astype(np.float64) / 4
        return np.frombuffer(data, f"{self.order}f4")


@dataclass(frozen=True)
class Parameter:
    """One entry: its kind (`TEXT`, `BYTE`, `INTEGER`, `FLOAT`), its shape and its bytes."""

    kind: int
    shape: tuple[int, ...]
    data: bytes
    processor: Processor

    @property
    def numbers(self) -> tuple[float, ...]:
        """Its values; integers count from 0 to 65535, texts have none."""
        if self.kind == FLOAT:
            return tuple(self.processor.floats(self.data).tolist())
        if self.kind == TEXT:
            return ()
        pieces = range(0, len(self.data), self.kind)
        return tuple(float(self.processor.integer(self.data[at : at + self.kind])) for at in pieces)

    @property
    def texts(self) -> tuple[str, ...]:
        """Its texts, without the spaces that pad them; numbers have none."""
        if self.kind != TEXT or not self.data:
            return ()
        width = self.shape[0] if self.shape else 1
        pieces = range(0, len(self.data), width)
        return tuple(_text(self.data[at : at + width]) for at in pieces)


Parameters = Mapping[tuple[str, str], Parameter]
"""Entries by group and name, both in capitals."""


def read_parameters(content: bytes, start: int) -> Parameters:
    """Read the section that starts at that byte.

    Raises
    ------
    ValueError
        If it is damaged.
    """
    processor = Processor(content[start + 3])
    groups: dict[int, str] = {}
    found: dict[tuple[int, str], Parameter] = {}
    for place, number, name, body in _entries(content, start + 4, processor):
        if number < 0:
            groups[-number] = name
        else:
            found[number, name] = _parameter(body, place, processor)
    return {
        (groups[number], name): value for (number, name), value in found.items() if number in groups
    }


def _entries(
    content: bytes, place: int, processor: Processor
) -> Iterator[tuple[int, int, str, bytes]]:
    while place + 2 <= len(content):
        length, number = struct.unpack("<bb", content[place : place + 2])
        if length == 0:
            return
        step_at = place + 2 + abs(length)
        step = processor.integer(content[step_at : step_at + 2])
        end = step_at + step if step else len(content)
        if number == 0 or step_at + 2 > len(content) or end > len(content) or 0 < step < 3:
            raise ValueError(f"its parameter section is damaged at byte {place}")
        name = _text(content[place + 2 : step_at]).upper()
        yield place, number, name, content[step_at + 2 : end]
        if step == 0:
            return
        place = end
    raise ValueError("its parameter section has no end")


def _parameter(body: bytes, place: int, processor: Processor) -> Parameter:
    kind = struct.unpack("<b", body[:1])[0]
    rank = body[1] if len(body) > 1 else 0
    shape = tuple(body[2 : 2 + rank])
    length = math.prod(shape) * abs(kind)
    data = body[2 + rank : 2 + rank + length]
    if kind not in (TEXT, BYTE, INTEGER, FLOAT) or len(shape) < rank or len(data) < length:
        raise ValueError(f"the parameter at byte {place} is damaged")
    return Parameter(kind, shape, data, processor)


def _text(data: bytes) -> str:
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return text.strip(" \0\t\r\n")
