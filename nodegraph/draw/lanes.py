"""Where wires run sideways between two layers: in lanes, so that each can be followed."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from heapq import heappop, heappush

from nodegraph.draw.net import Segment

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
