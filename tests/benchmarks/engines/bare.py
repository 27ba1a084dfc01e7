"""A bare networkx engine, the lower bound: a sort, a type check of wires, calls, release."""

from __future__ import annotations

import networkx as nx

from tests.benchmarks.work import Build, Run, Work


def bare(work: Work, count: int) -> Build:
    def build() -> Run:
        network: nx.DiGraph[int] = nx.DiGraph()
        network.add_nodes_from(
            (at, {"takes": work.kind, "gives": work.kind}) for at in range(count + 1)
        )
        network.add_edges_from((at, at + 1) for at in range(count))
        for source, target in network.edges:
            if not issubclass(network.nodes[source]["gives"], network.nodes[target]["takes"]):
                raise TypeError(f"{source} does not fit {target}")
        order = [(at, list(network.predecessors(at))) for at in nx.topological_sort(network)]

        def run() -> object:
            values: dict[int, object] = {}
            for at, needs in order:
                values[at] = work.step(values.pop(needs[0])) if needs else work.first()
            return values[count]

        return run

    return build
