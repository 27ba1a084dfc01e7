"""Build the typed graph of a spec; all errors are reported at once."""

from __future__ import annotations

from dataclasses import replace

from nodegraph.errors import GraphError, Problems, quoted
from nodegraph.gc_pause import gc_paused
from nodegraph.graph.model import Choices, Graph
from nodegraph.graphfile.spec import GraphSpec
from nodegraph.plugin.registry import Registry


@gc_paused()
def build(spec: GraphSpec, registry: Registry, choices: Choices | None = None) -> Graph:
    """Return the typed graph of a spec, in which the graphs that it uses are inlined.

    Raises
    ------
    GraphError
        With every error: unknown names, invalid settings, type mismatches, cycles; then unknown
        columns and leaks, for which the graph must be free of the others.
    """
    # these import networkx, for which commands without a graph should not wait
    from nodegraph.graph.assembly import Assembler
    from nodegraph.graph.leaks import check_leaks
    from nodegraph.graph.mixing import mixing_notices
    from nodegraph.graph.settings import check_names_in_settings
    from nodegraph.graph.used_graphs import UsedGraphs

    written = spec.written or spec
    problems = Problems(written.problems)
    flat = UsedGraphs(written.graphs, registry, problems).flat(written, problems)
    for name, port in flat.ports.items():
        message = (
            f"{flat.spec.file} takes {quoted(name)} ({port.type.__name__}) from the graph that "
            "uses it; it cannot run by itself"
        )
        instead = f"in another graph: {{use: {flat.spec.file}, in: {{{name}: node}}}}"
        problems.add(flat.spec.inputs[name].place, message, instead)
    graph = Assembler(flat, registry, (choices or Choices()).listed, problems).graph()
    if graph is None:
        raise GraphError(problems.all())
    check_names_in_settings(graph, problems)
    check_leaks(graph, problems)
    problems.raise_any()
    return replace(graph, notices=(*graph.notices, *mixing_notices(graph)))
