"""Layers of a picture that would be far too wide: what stands side by side is set in rows.

Parts that only a few cells join, such as the pipelines of many recordings that one table
compares, stay whole: as many as fit stand side by side, the next begin below them.
"""

from __future__ import annotations

from collections.abc import Sequence

from nodegraph.draw.cells import Cell
from nodegraph.draw.depths import Link, depth_first, depths_of, in_order, neighbours

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
