"""Segments of wires between layers, and the bends by which long wires pass the layers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field

from nodegraph.draw.layers import BEND_WIDTH, Cell, Wire

# Number of wires into one port from which they share bends, and from which each weighs less.
_MEET = 4
_FEW = 3.0


@dataclass(frozen=True, slots=True)
class Segment:
    """A piece of a wire between neighbouring layers; offsets count from the cells' middles."""

    upper: int
    lower: int
    upper_offset: float = 0.0
    lower_offset: float = 0.0
    weight: float = 1.0
    truth: bool = False


@dataclass
class Net:
    """Cells, then bends, in layers; cells and bends are numbered together.

    Attributes
    ----------
    layers : list of list of int
        The cells of each layer, from the top.
    widths : list of float
    gaps : list of list of Segment
        The segments below each layer.
    chains : list of list of int
        Bends of long wires, each list from the top.
    routes : list of list of Segment
        For each wire its segments, from the top.
    """

    layers: list[list[int]]
    widths: list[float]
    gaps: list[list[Segment]]
    chains: list[list[int]] = field(default_factory=list)
    routes: list[list[Segment]] = field(default_factory=list)

    def bend(self, layer: int) -> int:
        """Add a bend to the middle of a layer and return its number."""
        self.widths.append(BEND_WIDTH)
        cells = self.layers[layer]
        cells.insert(len(cells) // 2, len(self.widths) - 1)
        return len(self.widths) - 1


def net(cells: Sequence[Cell], wires: Sequence[Wire], depths: Sequence[int]) -> Net:
    """Return the cells in their layers, with bends.

    Wires out of one port share their bends; so do wires into one port, if there are many.
    """
    count = max(depths, default=-1) + 1
    network = Net(
        [[] for _ in range(count)], [cell.width for cell in cells], [[] for _ in range(count)]
    )
    for number, depth in enumerate(depths):
        network.layers[depth].append(number)
    _Router(network, cells, wires, depths).route()
    return network


class _Router:
    def __init__(
        self, network: Net, cells: Sequence[Cell], wires: Sequence[Wire], depths: Sequence[int]
    ) -> None:
        self._net = network
        self._cells = cells
        self._wires = wires
        self._depths = depths
        self._leaving = Counter(_begin(wire) for wire in wires)
        self._meeting = Counter(_end(wire) for wire in wires)
        self._forks: dict[Hashable, list[Segment]] = {}
        self._joints: dict[Hashable, list[Segment]] = {}

    def route(self) -> None:
        for wire in self._wires:
            many = self._meeting[_end(wire)]
            together = many >= _MEET and many > self._leaving[_begin(wire)]
            route = self._join(wire) if together else self._fork(wire)
            self._net.routes.append(route)
        forks = ([segment.lower for segment in chain] for chain in self._forks.values())
        joints = ([segment.upper for segment in reversed(chain)] for chain in self._joints.values())
        self._net.chains += [chain for chain in (*forks, *joints) if chain]

    def _fork(self, wire: Wire) -> list[Segment]:
        """Route along the bends of the source port, adding bends further down as needed."""
        first, last = self._depths[wire.source], self._depths[wire.target]
        chain = self._forks.setdefault(_begin(wire), [])
        begins = self._cells[wire.source].output_offset(wire.source_port)
        for layer in range(first + 1 + len(chain), last):
            upper = chain[-1].lower if chain else wire.source
            bend = self._net.bend(layer)
            weight, offset = (8.0, 0.0) if chain else (2.0, begins)
            chain.append(self._add(layer - 1, upper, bend, offset, 0.0, weight, wire))
        used = chain[: last - first - 1]
        ends = self._cells[wire.target].input_offset(wire.target_port)
        upper, offset = (used[-1].lower, 0.0) if used else (wire.source, begins)
        weight = self._share(wire) * (2.0 if used else 1.0)
        return [*used, self._add(last - 1, upper, wire.target, offset, ends, weight, wire)]

    def _join(self, wire: Wire) -> list[Segment]:
        """Route along the bends of the target port, adding bends further up as needed."""
        first, last = self._depths[wire.source], self._depths[wire.target]
        chain = self._joints.setdefault(_end(wire), [])
        ends = self._cells[wire.target].input_offset(wire.target_port)
        for layer in range(last - 1 - len(chain), first, -1):
            lower = chain[-1].upper if chain else wire.target
            bend = self._net.bend(layer)
            weight, offset = (8.0, 0.0) if chain else (2.0, ends)
            chain.append(self._add(layer, bend, lower, 0.0, offset, weight, wire))
        used = chain[: last - first - 1][::-1]
        begins = self._cells[wire.source].output_offset(wire.source_port)
        lower, offset = (used[0].upper, 0.0) if used else (wire.target, ends)
        weight = self._share(wire)
        return [self._add(first, wire.source, lower, begins, offset, weight, wire), *used]

    def _share(self, wire: Wire) -> float:
        """Return the weight of a wire: one of many must not bend their common line."""
        many = max(self._meeting[_end(wire)], self._leaving[_begin(wire)])
        return min(1.0, (_FEW / many) ** 2)

    def _add(
        self,
        gap: int,
        upper: int,
        lower: int,
        begins: float,
        ends: float,
        weight: float,
        wire: Wire,
    ) -> Segment:
        segment = Segment(upper, lower, begins, ends, weight, wire.truth)
        self._net.gaps[gap].append(segment)
        return segment


def _begin(wire: Wire) -> tuple[Hashable, ...]:
    return wire.source, wire.source_port, wire.truth


def _end(wire: Wire) -> tuple[Hashable, ...]:
    return wire.target, wire.target_port, wire.truth


def ends_of(segment: Segment, middles: Sequence[float]) -> tuple[float, float]:
    """Return where a segment begins and ends."""
    return (
        middles[segment.upper] + segment.upper_offset,
        middles[segment.lower] + segment.lower_offset,
    )
