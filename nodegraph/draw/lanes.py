"""Lanes between layers, in which segments run sideways."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from heapq import heappop, heappush

from nodegraph.draw.layering import Segment, ends_of

LANE = 10.0
"""The distance between lanes."""

# The least width of a segment that runs sideways, and the distance of two in one lane.
_SIDEWAYS = 16.0
_APART = 8.0

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


def lanes(gap: Sequence[Segment], middles: Sequence[float]) -> dict[Segment, int]:
    """Return the lane, from the top, of each segment that runs far enough sideways.

    Segments to the right are ordered from the rightmost start, segments to the left from the
    leftmost, so that a wire crosses none that turned before it. If a segment starts where
    another ends, it turns first: otherwise the two would look like a single line.
    """
    bundles = sorted(_bundles(gap, middles), key=_turn)
    above = _above(bundles)
    lane_of: dict[int, int] = {}
    reach: list[list[_Bundle]] = []
    for number in _ordered(above):
        least = max((lane_of[other] + 1 for other in above[number] if other in lane_of), default=0)
        free = (n for n in range(least, len(reach)) if _is_free(bundles[number], reach[n]))
        lane_of[number] = next(free, max(least, len(reach)))
        reach += [[] for _ in range(lane_of[number] + 1 - len(reach))]
        reach[lane_of[number]].append(bundles[number])
    return {
        segment: lane for number, lane in lane_of.items() for segment in bundles[number].segments
    }


def lane_count(taken: Mapping[Segment, int]) -> int:
    """Return how many lanes are taken."""
    return max(taken.values(), default=-1) + 1


def _above(bundles: Sequence[_Bundle]) -> list[set[int]]:
    """Return for each bundle those that start where it ends, which must turn first."""
    begins = sorted((x, number) for number, bundle in enumerate(bundles) for x in bundle.begins)
    above: list[set[int]] = [set() for _ in bundles]
    for number, bundle in enumerate(bundles):
        for x in bundle.ends:
            first = bisect_left(begins, (x - _APART, 0))
            last = bisect_left(begins, (x + _APART, 0))
            above[number] |= {other for _, other in begins[first:last]} - {number}
    return above


def _ordered(above: Sequence[set[int]]) -> Iterator[int]:
    """Yield the bundles in order, each after those above it; cycles are broken at the first."""
    below: list[list[int]] = [[] for _ in above]
    for number, blockers in enumerate(above):
        for other in blockers:
            below[other].append(number)
    waiting = [len(above_it) for above_it in above]
    ready = [number for number, count in enumerate(waiting) if not count]
    seen = set()
    for first in range(len(above)):
        if not ready and first not in seen:
            ready = [first]
        while ready:
            number = heappop(ready)
            if number not in seen:
                seen.add(number)
                yield number
                for other in below[number]:
                    waiting[other] -= 1
                    if not waiting[other]:
                        heappush(ready, other)


def _grouped(gap: Sequence[Segment]) -> list[tuple[Segment, ...]]:
    """Return the segments grouped by start, or by end where more of them meet there."""
    leaving: dict[_End, list[Segment]] = {}
    meeting: dict[_End, list[Segment]] = {}
    for segment in gap:
        leaving.setdefault((segment.upper, segment.upper_offset, segment.truth), []).append(segment)
        meeting.setdefault((segment.lower, segment.lower_offset, segment.truth), []).append(segment)
    bundles: dict[tuple[bool, _End], list[Segment]] = {}
    for segment in gap:
        begin = (segment.upper, segment.upper_offset, segment.truth)
        end = (segment.lower, segment.lower_offset, segment.truth)
        joins = len(meeting[end]) > len(leaving[begin])
        bundles.setdefault((joins, end if joins else begin), []).append(segment)
    return [tuple(dict.fromkeys(members)) for members in bundles.values()]


def _bundles(gap: Sequence[Segment], middles: Sequence[float]) -> list[_Bundle]:
    bundles = []
    for segments in _grouped([segment for segment in gap if _is_sideways(segment, middles)]):
        begins, ends = zip(*(ends_of(segment, middles) for segment in segments), strict=True)
        bundles.append(_Bundle(segments, frozenset(begins), frozenset(ends)))
    return bundles


def _turn(bundle: _Bundle) -> tuple[bool, float]:
    rightwards = sum(bundle.ends) / len(bundle.ends) > sum(bundle.begins) / len(bundle.begins)
    return rightwards, -max(bundle.begins) if rightwards else min(bundle.begins)


def _is_free(bundle: _Bundle, taken: Sequence[_Bundle]) -> bool:
    return all(
        bundle.right + _APART < other.left or other.right + _APART < bundle.left for other in taken
    )


def _is_sideways(segment: Segment, middles: Sequence[float]) -> bool:
    begin, end = ends_of(segment, middles)
    return abs(begin - end) > _SIDEWAYS
