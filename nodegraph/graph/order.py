"""An order in which every node comes after what feeds it."""

from __future__ import annotations

import heapq
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from nodegraph.errors import Place, Problems

if TYPE_CHECKING:
    import networkx as nx


def sorted_names(wires: Mapping[str, Sequence[tuple[str, Place]]], problems: Problems) -> list[str]:
    """Return the nodes in order, as the file has them where it can.

    Parameters
    ----------
    wires
        For each node, what feeds it and where the file says so. Unknown names are passed over.
    problems
        Where a cycle is noted, with the way around it. What is part of one comes in any order,
        so that the rest can be checked.
    """
    needs = {name: {one for one, _ in feeds if one in wires} for name, feeds in wires.items()}
    order = _in_order(needs)
    if len(order) == len(wires):
        return order
    return _in_order(_without_cycles(needs, wires, problems))


def _in_order(needs: Mapping[str, set[str]]) -> list[str]:
    """Return the names, each after its needs and as early as it stands; none of a cycle."""
    names = list(needs)
    waiting = [len(feeds) for feeds in needs.values()]
    readers: dict[str, list[int]] = {name: [] for name in names}
    for index, feeds in enumerate(needs.values()):
        for one in feeds:
            readers[one].append(index)
    ready = [index for index, count in enumerate(waiting) if not count]
    order: list[str] = []
    while ready:
        name = names[heapq.heappop(ready)]
        order.append(name)
        for reader in readers[name]:
            waiting[reader] -= 1
            if not waiting[reader]:
                heapq.heappush(ready, reader)
    return order


def _without_cycles(
    needs: Mapping[str, set[str]],
    wires: Mapping[str, Sequence[tuple[str, Place]]],
    problems: Problems,
) -> dict[str, set[str]]:
    """Note a way around each knot of nodes that feed each other; return what else they need."""
    import networkx as nx  # late: to import it takes as long as to check most graphs

    network: nx.DiGraph[str] = nx.DiGraph()
    network.add_nodes_from(needs)
    network.add_edges_from((one, name) for name, feeds in needs.items() for one in feeds)
    left = dict(needs)
    for knot in nx.strongly_connected_components(network):
        _note_cycle(network.subgraph(knot), wires, problems)
        left |= {name: needs[name] - knot for name in knot}
    return left


def _note_cycle(
    knot: nx.DiGraph[str], wires: Mapping[str, Sequence[tuple[str, Place]]], problems: Problems
) -> None:
    """Note one way around a set of nodes that feed each other."""
    import networkx as nx

    if not knot.number_of_edges():
        return
    around = [source for source, _ in nx.find_cycle(knot, source=min(knot))]
    last, first = around[-1], around[0]
    place = next(place for source, place in wires[first] if source == last)
    problems.add(place, f"{first!r} feeds itself: {' -> '.join([*around, first])}")
