"""Cells in layers, and the bends by which long wires pass the layers between."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from heapq import heappop, heappush
from math import sqrt
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
    """Cells as they were given, then bends.

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

    Wires that leave one port share their bends; so do those that meet in one port, where they
    are many.
    """
    count = max(depths, default=-1) + 1
    made = Net([[] for _ in range(count)], [one.width for one in cells], [[] for _ in range(count)])
    for number, depth in enumerate(depths):
        made.layers[depth].append(number)
    _Router(made, cells, wires, depths).route()
    return made


class _Router:
    def __init__(
        self, made: Net, cells: Sequence[Cell], wires: Sequence[Wire], depths: Sequence[int]
    ) -> None:
        self._made = made
        self._cells = cells
        self._wires = wires
        self._depths = depths
        self._leaving = Counter(_begin(one) for one in wires)
        self._meeting = Counter(_end(one) for one in wires)
        self._forks: dict[Hashable, list[Segment]] = {}
        self._joints: dict[Hashable, list[Segment]] = {}

    def route(self) -> None:
        for wire in self._wires:
            many = self._meeting[_end(wire)]
            together = many >= _MEET and many > self._leaving[_begin(wire)]
            route = self._joining(wire) if together else self._forking(wire)
            self._made.routes.append(route)
        forks = ([one.lower for one in chain] for chain in self._forks.values())
        joints = ([one.upper for one in reversed(chain)] for chain in self._joints.values())
        self._made.chains += [chain for chain in (*forks, *joints) if chain]

    def _forking(self, wire: Wire) -> list[Segment]:
        """Follow the bends of the port that the wire leaves, as far down as it needs."""
        first, last = self._depths[wire.source], self._depths[wire.target]
        chain = self._forks.setdefault(_begin(wire), [])
        begins = self._cells[wire.source].out_of(wire.source_port)
        for layer in range(first + 1 + len(chain), last):
            upper = chain[-1].lower if chain else wire.source
            bend = self._made.bend(layer)
            weight, offset = (8.0, 0.0) if chain else (2.0, begins)
            chain.append(self._add(layer - 1, upper, bend, offset, 0.0, weight, wire))
        used = chain[: last - first - 1]
        ends = self._cells[wire.target].into(wire.target_port)
        upper, offset = (used[-1].lower, 0.0) if used else (wire.source, begins)
        weight = self._share(wire) * (2.0 if used else 1.0)
        return [*used, self._add(last - 1, upper, wire.target, offset, ends, weight, wire)]

    def _joining(self, wire: Wire) -> list[Segment]:
        """Go to the bends of the port in which the wire ends, as high up as it needs."""
        first, last = self._depths[wire.source], self._depths[wire.target]
        chain = self._joints.setdefault(_end(wire), [])
        ends = self._cells[wire.target].into(wire.target_port)
        for layer in range(last - 1 - len(chain), first, -1):
            lower = chain[-1].upper if chain else wire.target
            bend = self._made.bend(layer)
            weight, offset = (8.0, 0.0) if chain else (2.0, ends)
            chain.append(self._add(layer, bend, lower, 0.0, offset, weight, wire))
        used = chain[: last - first - 1][::-1]
        begins = self._cells[wire.source].out_of(wire.source_port)
        lower, offset = (used[0].upper, 0.0) if used else (wire.target, ends)
        weight = self._share(wire)
        return [self._add(first, wire.source, lower, begins, offset, weight, wire), *used]

    def _share(self, wire: Wire) -> float:
        """Return how much a wire pulls: one among many must not bend their common line."""
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
        made = Segment(upper, lower, begins, ends, weight, wire.truth)
        self._made.gaps[gap].append(made)
        return made


def _begin(wire: Wire) -> tuple[Hashable, ...]:
    return wire.source, wire.source_port, wire.truth


def _end(wire: Wire) -> tuple[Hashable, ...]:
    return wire.target, wire.target_port, wire.truth


LANE = 10.0
_SIDEWAYS = 16.0
_APART = 8.0
_FEW_LANES = 4
_FEW_SEGMENTS = 10

_End = tuple[int, float, bool]


@dataclass(frozen=True)
class _Bundle:
    """Segments that begin, or end, in one place and so may run in one lane."""

    segments: tuple[Segment, ...]
    begins: frozenset[float]
    ends: frozenset[float]

    @cached_property
    def left(self) -> float:
        """The leftmost place."""
        return min(self.begins | self.ends)

    @cached_property
    def right(self) -> float:
        """The rightmost place."""
        return max(self.begins | self.ends)


def is_crowded(gaps: Sequence[Sequence[Segment]], middles: Sequence[float]) -> bool:
    """Return whether curves between layers would be too many to be told apart."""
    for gap in gaps:
        sideways = [one for one in gap if _is_sideways(one, middles)]
        if len(sideways) > _FEW_SEGMENTS or lane_count(lanes(sideways, middles)) > _FEW_LANES:
            return True
    return False


def lanes(gap: Sequence[Segment], middles: Sequence[float]) -> dict[Segment, int]:
    """Return the lane, from the top, of each segment that runs far enough sideways.

    Of segments to the right those that begin rightmost run on top, of those to the left the
    leftmost: so a wire that turns aside crosses none that turned before it. One that comes down
    where another goes down turns first, or they would look like one.
    """
    bundles = sorted(_bundles(gap, middles), key=_turn)
    above = _above(bundles)
    lane_of: dict[int, int] = {}
    reach: list[list[_Bundle]] = []
    for number in _ordered(above):
        least = max((lane_of[one] + 1 for one in above[number] if one in lane_of), default=0)
        free = (n for n in range(least, len(reach)) if _is_free(bundles[number], reach[n]))
        lane_of[number] = next(free, max(least, len(reach)))
        reach += [[] for _ in range(lane_of[number] + 1 - len(reach))]
        reach[lane_of[number]].append(bundles[number])
    return {one: lane for number, lane in lane_of.items() for one in bundles[number].segments}


def lane_count(taken: Mapping[Segment, int]) -> int:
    """Return how many lanes are taken."""
    return max(taken.values(), default=-1) + 1


def _above(bundles: Sequence[_Bundle]) -> list[set[int]]:
    """Return for each bundle those that come down where it goes down."""
    begins = sorted((x, number) for number, one in enumerate(bundles) for x in one.begins)
    found: list[set[int]] = [set() for _ in bundles]
    for number, one in enumerate(bundles):
        for x in one.ends:
            first = bisect_left(begins, (x - _APART, 0))
            last = bisect_left(begins, (x + _APART, 0))
            found[number] |= {other for _, other in begins[first:last]} - {number}
    return found


def _ordered(above: Sequence[set[int]]) -> Iterator[int]:
    """Yield the bundles in order, but each after those above it; in circles as they come."""
    below: list[list[int]] = [[] for _ in above]
    for number, others in enumerate(above):
        for other in others:
            below[other].append(number)
    waiting = [len(one) for one in above]
    ready = [number for number, count in enumerate(waiting) if not count]
    done = set()
    for first in range(len(above)):
        if not ready and first not in done:
            ready = [first]
        while ready:
            number = heappop(ready)
            if number not in done:
                done.add(number)
                yield number
                for other in below[number]:
                    waiting[other] -= 1
                    if not waiting[other]:
                        heappush(ready, other)


def ends_of(segment: Segment, middles: Sequence[float]) -> tuple[float, float]:
    """Return where a segment begins and ends."""
    return (
        middles[segment.upper] + segment.upper_offset,
        middles[segment.lower] + segment.lower_offset,
    )


def bundled(gap: Sequence[Segment]) -> list[tuple[Segment, ...]]:
    """Return the segments by where they begin, or by where they end if there more of them meet."""
    leaving: dict[_End, list[Segment]] = {}
    meeting: dict[_End, list[Segment]] = {}
    for one in gap:
        leaving.setdefault((one.upper, one.upper_offset, one.truth), []).append(one)
        meeting.setdefault((one.lower, one.lower_offset, one.truth), []).append(one)
    bundles: dict[tuple[bool, _End], list[Segment]] = {}
    for one in gap:
        begin = (one.upper, one.upper_offset, one.truth)
        end = (one.lower, one.lower_offset, one.truth)
        joins = len(meeting[end]) > len(leaving[begin])
        bundles.setdefault((joins, end if joins else begin), []).append(one)
    return [tuple(dict.fromkeys(one)) for one in bundles.values()]


def _bundles(gap: Sequence[Segment], middles: Sequence[float]) -> list[_Bundle]:
    found = []
    for segments in bundled([one for one in gap if _is_sideways(one, middles)]):
        begins, ends = zip(*(ends_of(one, middles) for one in segments), strict=True)
        found.append(_Bundle(segments, frozenset(begins), frozenset(ends)))
    return found


def _turn(bundle: _Bundle) -> tuple[bool, float]:
    rightwards = sum(bundle.ends) / len(bundle.ends) > sum(bundle.begins) / len(bundle.begins)
    return rightwards, -max(bundle.begins) if rightwards else min(bundle.begins)


def _is_free(bundle: _Bundle, taken: Sequence[_Bundle]) -> bool:
    return all(
        bundle.right + _APART < one.left or one.right + _APART < bundle.left for one in taken
    )


def _is_sideways(segment: Segment, middles: Sequence[float]) -> bool:
    begin, end = ends_of(segment, middles)
    return abs(begin - end) > _SIDEWAYS


Link = tuple[int, int]


def depths_of(count: int, links: Sequence[Link]) -> list[int]:
    """Return each node's layer: below all that feeds it, and no higher than its readers need."""
    above, below = neighbours(count, links)
    order = in_order(count, links)
    depths = [0] * count
    for one in order:
        depths[one] = max((depths[other] + 1 for other in above[one]), default=0)
    for one in reversed(order):
        if below[one] and len(below[one]) >= len(above[one]):
            depths[one] = min(depths[other] for other in below[one]) - 1
    return depths


def in_order(count: int, links: Sequence[Link]) -> list[int]:
    """Return the nodes so that each comes after what feeds it, without those that never can."""
    above, below = neighbours(count, links)
    waiting = [len(one) for one in above]
    order = [one for one in range(count) if not waiting[one]]
    for one in order:  # grows while it is read
        for reader in below[one]:
            waiting[reader] -= 1
            if not waiting[reader]:
                order.append(reader)
    return order


def depth_first(above: Sequence[Sequence[int]], below: Sequence[Sequence[int]]) -> list[int]:
    """Return the nodes so that what feeds one reader stands together, before it."""
    order: list[int] = []
    seen: set[int] = set()
    for last in (one for one, readers in enumerate(below) if not readers):
        pending = [(last, iter(above[last]))]
        seen.add(last)
        while pending:
            one, feeding = pending[-1]
            following = next((other for other in feeding if other not in seen), None)
            if following is None:
                order.append(one)
                pending.pop()
            else:
                seen.add(following)
                pending.append((following, iter(above[following])))
    return order


def neighbours(count: int, links: Sequence[Link]) -> tuple[list[list[int]], list[list[int]]]:
    """Return for each node what feeds it, and what reads it."""
    above: list[list[int]] = [[] for _ in range(count)]
    below: list[list[int]] = [[] for _ in range(count)]
    for source, target in links:
        above[target].append(source)
        below[source].append(target)
    return above, below


SPACE_BESIDE = 44.0
_FEWEST = 8
_SHARE = 20


def narrowed(cells: Sequence[Cell], links: Sequence[Link], limit: float) -> list[int]:
    """Return layers of which none is wider than the limit, as far as single cells allow."""
    widths = [one.width + SPACE_BESIDE for one in cells]
    return _Rows(widths, links, limit).by_parts() or _Rows(widths, links, limit).by_cells()


class _Rows:
    def __init__(self, widths: Sequence[float], links: Sequence[Link], limit: float) -> None:
        self._widths = widths
        self._links = links
        self._limit = limit
        self._above, self._below = neighbours(len(widths), links)
        self._depths = [0] * len(widths)
        self._used: list[float] = []
        self._begin = 0

    def by_cells(self) -> list[int]:
        """Set what feeds one reader together, each cell into the first layer that has room."""
        for one in depth_first(self._above, self._below):
            self._set_below(one)
        return self._depths

    def by_parts(self) -> list[int] | None:
        """Set parts side by side, then below; None where a part is too wide for that."""
        parts = self._parts()
        part_of = {one: number for number, part in enumerate(parts) for one in part}
        between = {(part_of[source], part_of[target]) for source, target in self._links}
        order = in_order(len(parts), sorted(one for one in between if one[0] != one[1]))
        inner: list[list[Link]] = [[] for _ in parts]
        for source, target in self._links:
            if part_of[source] == part_of[target]:
                inner[part_of[source]].append((source, target))
        well = all(self._set_part(parts[one], inner[one]) for one in order)
        return self._depths if well and len(order) == len(parts) else None

    def _parts(self) -> list[list[int]]:
        """Return what hangs together without the cells that join very many."""
        many = max(_FEWEST, len(self._widths) // _SHARE)
        found: list[list[int]] = []
        seen: set[int] = set()
        for first in range(len(self._widths)):
            if first not in seen:
                seen.add(first)
                part = [first]
                for one in part:  # grows while it is read
                    around = [] if self._joins(one, many) else self._above[one] + self._below[one]
                    near = [n for n in dict.fromkeys(around) if n not in seen]
                    part += [other for other in near if not self._joins(other, many)]
                    seen.update(part)
                found.append(sorted(part))
        return found

    def _joins(self, one: int, many: int) -> bool:
        return max(len(self._above[one]), len(self._below[one])) >= many

    def _set_part(self, part: Sequence[int], links: Sequence[Link]) -> bool:
        if len(part) == 1:
            self._set_below(part[0])
            return True
        place = {one: number for number, one in enumerate(part)}
        depths = depths_of(len(part), [(place[source], place[target]) for source, target in links])
        wide = [0.0] * (max(depths) + 1)
        for one, depth in zip(part, depths, strict=True):
            wide[depth] += self._widths[one]
        if not self._fits(part, depths, wide):
            self._begin = len(self._used)
        for one, depth in zip(part, depths, strict=True):
            self._set(one, self._begin + depth)
        return max(wide) <= self._limit

    def _fits(self, part: Sequence[int], depths: Sequence[int], wide: Sequence[float]) -> bool:
        """Return whether a part can stand beside the one before it."""
        fed = all(
            self._depths[other] < self._begin + depth
            for one, depth in zip(part, depths, strict=True)
            for other in self._above[one]
            if other not in part
        )
        return fed and all(self._room(self._begin + n, one) for n, one in enumerate(wide))

    def _set_below(self, one: int) -> None:
        depth = max((self._depths[other] + 1 for other in self._above[one]), default=0)
        while not self._room(depth, self._widths[one]):
            depth += 1
        self._set(one, depth)

    def _room(self, depth: int, wide: float) -> bool:
        free = depth >= len(self._used) or not self._used[depth]
        return free or self._used[depth] + wide <= self._limit

    def _set(self, one: int, depth: int) -> None:
        self._used += [0.0] * (depth + 1 - len(self._used))
        self._used[depth] += self._widths[one]
        self._depths[one] = depth


_ASPECT = 1.6
_ALWAYS_NARROW_ENOUGH = 1800.0
_TOO_WIDE = 1.4
_SPACE_BELOW = 60.0


def layers_of(
    cells: Sequence[Cell], wires: Sequence[Wire], entries: int = 0, exits: int = 0
) -> list[int]:
    """Return each cell's layer.

    Parameters
    ----------
    cells, wires
        The wires do not run in a circle.
    entries, exits
        How many cells, the first and the last, stand above and below all others.
    """
    inner = range(entries, len(cells) - exits)
    links = [
        (one.source - entries, one.target - entries)
        for one in wires
        if one.source in inner and one.target in inner
    ]
    depths = _depths([cells[one] for one in inner], links)
    first = 1 if entries else 0
    last = max(depths, default=-1) + 1 + first
    return [0] * entries + [first + depth for depth in depths] + [last] * exits


def _depths(members: Sequence[Cell], links: Sequence[tuple[int, int]]) -> list[int]:
    depths = depths_of(len(members), links)
    limit, wide = _widest(members), _width(members, depths)
    if wide <= _TOO_WIDE * limit:
        return depths
    even = wide / max(2, round(wide / limit)) + max(one.width for one in members)
    return narrowed(members, links, even)


def _widest(cells: Sequence[Cell]) -> float:
    """Return how wide a drawing of the cells may be, that it is not much wider than high."""
    area = sum((one.width + SPACE_BESIDE) * (one.height + _SPACE_BELOW) for one in cells)
    return max(_ALWAYS_NARROW_ENOUGH, sqrt(_ASPECT * area))


def _width(cells: Sequence[Cell], depths: Sequence[int]) -> float:
    widths = [0.0] * (max(depths, default=-1) + 1)
    for one, depth in zip(cells, depths, strict=True):
        widths[depth] += one.width + SPACE_BESIDE
    return max(widths, default=0.0)
