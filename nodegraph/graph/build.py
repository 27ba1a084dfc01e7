"""Spec + registry + choices -> typed graph; every check happens here, and all are told at once."""

from __future__ import annotations

from nodegraph.errors import Problems
from nodegraph.gc_pause import no_collection
from nodegraph.graph.builder import Builder
from nodegraph.graph.choices import Choices
from nodegraph.graph.leaks import check_leaks
from nodegraph.graph.model import Flat, Graph
from nodegraph.graph.settings import check_named
from nodegraph.graph.subgraphs import Subgraphs
from nodegraph.graphfile.spec import GraphSpec
from nodegraph.plugin.registry import Registry


@no_collection()
def build(spec: GraphSpec, registry: Registry, choices: Choices | None = None) -> Graph:
    """Return the typed graph that a spec describes, with the nodes of the graphs that it uses.

    Raises
    ------
    GraphError
        With every mistake: unknown names, wrong settings, misfits, cycles; then unknown columns
        and leaks, which only a graph without those can show.
    """
    written = spec.written or spec
    problems = Problems(written.problems)
    flat = Subgraphs(written.graphs, registry, problems).flat(written, problems)
    _refuse_ports(flat, problems)
    graph = Builder(flat, registry, choices or Choices(), problems).build()
    problems.raise_any()
    check_named(graph, problems)
    check_leaks(graph, problems)
    problems.raise_any()
    return graph


def _refuse_ports(flat: Flat, problems: Problems) -> None:
    for name, port in flat.ports.items():
        message = (
            f"{flat.spec.file} takes {name!r} ({port.type.__name__}) from the graph that uses it; "
            "it cannot run by itself"
        )
        instead = f"in another graph: {{use: {flat.spec.file}, in: {{{name}: node}}}}"
        problems.add(flat.spec.inputs[name].place, message, instead)
