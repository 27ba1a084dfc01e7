"""Numbered nodes and links between them: what comes after what, and how deep."""

from __future__ import annotations

from collections.abc import Sequence

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
