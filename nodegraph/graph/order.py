"""An order in which every node comes after what feeds it."""

from __future__ import annotations

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
    import networkx as nx

    network: nx.DiGraph[str] = nx.DiGraph()
    network.add_nodes_from(wires)
    for name, feeds in wires.items():
        network.add_edges_from((source, name) for source, _ in feeds if source in wires)
    if not nx.is_directed_acyclic_graph(network):
        for knot in list(nx.strongly_connected_components(network)):
            edges = list(network.subgraph(knot).edges)
            _note_cycle(network.subgraph(knot), wires, problems)
            network.remove_edges_from(edges)
    position = {name: index for index, name in enumerate(wires)}
    return list(nx.lexicographical_topological_sort(network, position.__getitem__))


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
