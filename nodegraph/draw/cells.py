"""What is laid out: cells with ports, and the wires between them."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import Any

Point = tuple[float, float]
BEND_WIDTH = 12.0


@dataclass(frozen=True, slots=True)
class Cell:
    """A rectangle that wires enter from above and leave below.

    Attributes
    ----------
    inputs, outputs : mapping of port to float
        How far from the left the port's wires end or begin.
    """

    width: float
    height: float
    inputs: Mapping[Any, float]
    outputs: Mapping[Any, float]

    def into(self, port: Hashable) -> float:
        """Return how far right of the middle wires into a port end."""
        return self.inputs[port] - self.width / 2

    def out_of(self, port: Hashable) -> float:
        """Return how far right of the middle wires out of a port begin."""
        return self.outputs[port] - self.width / 2


@dataclass(frozen=True, slots=True)
class Wire:
    """A way from an output of a cell to an input of another; truth shares no line with others."""

    source: int
    source_port: Hashable
    target: int
    target_port: Hashable
    truth: bool = False


PIN = Cell(BEND_WIDTH, 0.0, {"": BEND_WIDTH / 2}, {"": BEND_WIDTH / 2})
"""Where a wire passes the frame around cells."""
