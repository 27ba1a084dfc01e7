"""Reads a packet from its start to its end, and never beyond."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


class PacketReader:
    """A place in a packet.

    Parameters
    ----------
    packet
    order
        ``<`` for numbers that begin with their lowest byte, ``>`` for the highest.
    """

    def __init__(self, packet: bytes, order: str = "<") -> None:
        self._packet = packet
        self._order = order
        self._place = 0

    @property
    def left(self) -> int:
        """Number of bytes that follow."""
        return len(self._packet) - self._place

    def skip(self, count: int) -> int:
        """Pass over bytes, and return where they begin.

        Raises
        ------
        ValueError
            If fewer are left.
        """
        if not 0 <= count <= self.left:
            raise ValueError(f"{count} bytes expected at byte {self._place}, {self.left} are left")
        place = self._place
        self._place += count
        return place

    def numbers(self, codes: str) -> tuple[Any, ...]:
        """Return numbers by the format codes of `struct`."""
        layout = self._order + codes
        return struct.unpack_from(layout, self._packet, self.skip(struct.calcsize(layout)))

    def floats(self, count: int) -> NDArray[np.float64]:
        """Return the next numbers, which are float32."""
        start = self.skip(4 * count)
        return as_doubles(np.frombuffer(self._packet, f"{self._order}f4", count, start))

    def bytes(self, count: int) -> bytes:
        """Return the next bytes."""
        start = self.skip(count)
        return self._packet[start : start + count]

    def text(self, longest: int = 256) -> str:
        """Return UTF-8 text that ends with a zero byte.

        Raises
        ------
        ValueError
            If no such byte is among the next `longest`, or the text is not UTF-8.
        """
        end = self._packet.find(b"\0", self._place, self._place + longest + 1)
        if end < 0:
            raise ValueError(f"text that begins at byte {self._place} does not end")
        text = self.bytes(end - self._place).decode()
        self.skip(1)
        return text


def as_doubles(numbers: NDArray[np.generic]) -> NDArray[np.float64]:
    """Return numbers as float64; a NaN that is to give an alarm gives none."""
    with np.errstate(invalid="ignore"):
        return numbers.astype(np.float64)
