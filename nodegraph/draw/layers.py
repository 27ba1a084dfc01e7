"""Cells in layers, and the segments and bends of the wires between them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from math import sqrt
from typing import Any

import networkx as nx

Point = tuple[float, float]
BEND_WIDTH = 12.0

# Space around each cell by which the size of a drawing is estimated.
_SPACE_BESIDE = 44.0
_SPACE_BELOW = 60.0
# The aspect ratio of a wide drawing, the width that none is too narrow for, and by how much a
# layer may be wider.
_ASPECT = 1.4
_ALWAYS_NARROW_ENOUGH = 1150.0
_TOO_WIDE = 1.15
# A hub has at least this many wires in or out, or one wire for this many cells.
_FEWEST = 8
_SHARE = 20
# Number of wires into one port from which they share bends, and from which each weighs less.
_MEET = 4
_FEW = 3.0


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

    def input_offset(self, port: Hashable) -> float:
        """Return the distance to the right of the middle at which wires into a port end."""
        return self.inputs[port] - self.width / 2

    def output_offset(self, port: Hashable) -> float:
        """Return the distance to the right of the middle at which wires out of a port begin."""
        return self.outputs[port] - self.width / 2


@dataclass(frozen=True, slots=True)
class Wire:
    """A connection between ports of two cells; wires of truth share lines only with each other."""

    source: int
    source_port: Hashable
    target: int
    target_port: Hashable
    truth: bool = False


PIN = Cell(BEND_WIDTH, 0.0, {"": BEND_WIDTH / 2}, {"": BEND_WIDTH / 2})
"""Stands for the place where a wire crosses the frame around cells."""


def layers_of(
    cells: Sequence[Cell], wires: Sequence[Wire], entries: int = 0, exits: int = 0
) -> list[int]:
    """Return the layer of each cell.

    Parameters
    ----------
    cells, wires
        The wires form no cycle.
    entries, exits
        How many cells, the first and the last, stand above and below all others.
    """
    inner = range(entries, len(cells) - exits)
    network: nx.MultiDiGraph[int] = nx.MultiDiGraph()
    network.add_nodes_from(inner)
    network.add_edges_from(
        (wire.source, wire.target)
        for wire in wires
        if wire.source in inner and wire.target in inner
    )
    depths = _depths({cell: cells[cell] for cell in inner}, network)
    first = 1 if entries else 0
    last = max(depths.values(), default=-1) + 1 + first
    return [0] * entries + [first + depths[cell] for cell in inner] + [last] * exits


def depths_of(network: nx.MultiDiGraph[int]) -> dict[int, int]:
    """Return the layer of each node: below its sources, and no higher than its readers need.

    A node with fewer readers than sources stays where its sources are: lower, it would make
    more wires longer than shorter.
    """
    depths = {
        node: depth
        for depth, generation in enumerate(nx.topological_generations(network))
        for node in generation
    }
    for node in reversed(depths):
        if network.out_degree(node) >= max(1, network.in_degree(node)):
            depths[node] = min(depths[reader] for reader in network.succ[node]) - 1
    return depths


def _depths(cells: Mapping[int, Cell], network: nx.MultiDiGraph[int]) -> dict[int, int]:
    depths = depths_of(network)
    widths = {number: cell.width + _SPACE_BESIDE for number, cell in cells.items()}
    limit, widest = _limit(cells), max(_layer_widths(widths, depths), default=0.0)
    if widest <= _TOO_WIDE * limit:
        return depths
    even = widest / max(2, round(widest / limit)) + max(cell.width for cell in cells.values())
    return _Rows(widths, network, even).by_parts() or _Rows(widths, network, even).by_cells()


def _limit(cells: Mapping[int, Cell]) -> float:
    """Return the width of a drawing of the cells that is not much wider than high."""
    area = sum(
        (cell.width + _SPACE_BESIDE) * (cell.height + _SPACE_BELOW) for cell in cells.values()
    )
    return max(_ALWAYS_NARROW_ENOUGH, sqrt(_ASPECT * area))


def _layer_widths(widths: Mapping[int, float], depths: Mapping[int, int]) -> list[float]:
    sums = [0.0] * (max(depths.values(), default=-1) + 1)
    for cell, width in widths.items():
        sums[depths[cell]] += width
    return sums


class _Rows:
    """Layers filled up to a width, as far as single cells allow."""

    def __init__(
        self, widths: Mapping[int, float], network: nx.MultiDiGraph[int], limit: float
    ) -> None:
        self._widths = widths
        self._network = network
        self._limit = limit
        self._depths: dict[int, int] = {}
        self._used: list[float] = []
        self._begin = 0

    def by_cells(self) -> dict[int, int]:
        """Put each cell, right after its sources, into the first layer with enough room."""
        upwards: nx.DiGraph[int] = nx.DiGraph()
        upwards.add_nodes_from(cell for cell in self._widths if not self._network.succ[cell])
        for cell in self._widths:
            upwards.add_edges_from((cell, source) for source in self._network.pred[cell])
        for cell in nx.dfs_postorder_nodes(upwards):
            self._put_below(cell)
        return self._depths

    def by_parts(self) -> dict[int, int] | None:
        """Put parts side by side, then below; None if a part is too wide or parts form a cycle."""
        parts = self._parts()
        part_of = {cell: number for number, part in enumerate(parts) for cell in part}
        links = {(part_of[source], part_of[target]) for source, target in self._network.edges()}
        order: nx.DiGraph[int] = nx.DiGraph()
        order.add_nodes_from(range(len(parts)))
        order.add_edges_from(sorted(link for link in links if link[0] != link[1]))
        if not nx.is_directed_acyclic_graph(order):
            return None
        fits = all(self._put_part(parts[number]) for number in nx.topological_sort(order))
        return self._depths if fits else None

    def _parts(self) -> list[list[int]]:
        """Return the connected parts of the network without its hubs, and each hub by itself."""
        many = max(_FEWEST, len(self._widths) // _SHARE)
        hubs = {
            cell
            for cell in self._widths
            if max(self._network.in_degree(cell), self._network.out_degree(cell)) >= many
        }
        joined: nx.Graph[int] = nx.Graph()
        joined.add_nodes_from(self._widths)
        joined.add_edges_from(edge for edge in self._network.edges() if hubs.isdisjoint(edge))
        return [sorted(part) for part in nx.connected_components(joined)]

    def _put_part(self, part: Sequence[int]) -> bool:
        """Put the cells of a part into layers; return whether none of these is too wide."""
        if len(part) == 1:
            self._put_below(part[0])
            return True
        depths = depths_of(self._network.subgraph(part))
        widths = _layer_widths({cell: self._widths[cell] for cell in part}, depths)
        if not self._fits(depths, widths):
            self._begin = len(self._used)
        for cell in part:
            self._put(cell, self._begin + depths[cell])
        return max(widths) <= self._limit

    def _fits(self, depths: Mapping[int, int], widths: Sequence[float]) -> bool:
        """Return whether a part fits next to the previous part, below its sources."""
        below = all(
            self._depths[source] < self._begin + depth
            for cell, depth in depths.items()
            for source in self._network.pred[cell]
            if source not in depths
        )
        return below and all(
            self._has_room(self._begin + depth, width) for depth, width in enumerate(widths)
        )

    def _put_below(self, cell: int) -> None:
        depth = max((self._depths[source] + 1 for source in self._network.pred[cell]), default=0)
        while not self._has_room(depth, self._widths[cell]):
            depth += 1
        self._put(cell, depth)

    def _has_room(self, depth: int, width: float) -> bool:
        is_empty = depth >= len(self._used) or not self._used[depth]
        return is_empty or self._used[depth] + width <= self._limit

    def _put(self, cell: int, depth: int) -> None:
        self._used += [0.0] * (depth + 1 - len(self._used))
        self._used[depth] += self._widths[cell]
        self._depths[cell] = depth


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
