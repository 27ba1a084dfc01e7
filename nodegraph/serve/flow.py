"""What flows on a link of the graph: how many values, of which types, and the facts of some."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress

from nodegraph.errors import NodegraphError, listed
from nodegraph.execute.results import NotStored, Run
from nodegraph.formatting import number_of
from nodegraph.node.ports import Port
from nodegraph.plan import Output, outputs_in
from nodegraph.plugin.hook_types import Fact

_MOST_READ = 12
"""Values that are read for their facts, as evenly as possible among all of them."""


def flow(run: Run, link: str) -> list[str]:
    """Return what flows on a link, in a few phrases; nothing is computed for it.

    Parameters
    ----------
    run
    link
        ``gaps.hidden error.hidden``: an output, and the port that it feeds.

    Raises
    ------
    NodegraphError
        If the graph has no such link.
    """
    outputs = [each for each in _outputs(run, link) if run.outcomes[each.step].state.has_value]
    some = _evenly(outputs, _MOST_READ)
    values = []
    for output in some:
        with suppress(NotStored):
            values.append(run.shown_of(output.step)[output.position])
    types = dict.fromkeys(_ports(run, each)[each.position].type.__name__ for each in outputs)
    phrases = [", ".join([number_of(len(outputs), "value"), *types]), *_facts(run, values)]
    if len(values) < len(some):
        phrases.append(f"{len(some) - len(values)} of {len(some)} looked up are not stored")
    if values and run.cache is not None:
        of_all = f" {len(values)} of {len(outputs):,}" if len(values) < len(outputs) else ""
        phrases.append(f"read{of_all} from {run.cache.store.folder}")
    return phrases


def _outputs(run: Run, link: str) -> list[Output]:
    """Return the outputs that a link carries, each once."""
    plan = run.plan
    for source, target, wire in plan.graph.wires():
        if f"{source}.{wire.output} {target}.{wire.port}" == link:
            break
    else:
        raise NodegraphError(f"the graph has no link {link!r}")
    steps = set(plan.cells[source].values())
    inputs = (plan.steps[index].inputs for index in plan.cells[target].values())
    feeds = (of_step[wire.port] for of_step in inputs if wire.port in of_step)
    port = wire.reference.port  # empty for the first
    return [
        output
        for output in dict.fromkeys(outputs_in(feeds))
        if output.step in steps
        and (_ports(run, output)[output.position].name == port if port else not output.position)
    ]


def _ports(run: Run, output: Output) -> tuple[Port, ...]:
    return run.plan.steps[output.step].method.node.outputs


def _evenly(outputs: Sequence[Output], most: int) -> list[Output]:
    if len(outputs) <= most:
        return list(outputs)
    return [outputs[at * (len(outputs) - 1) // (most - 1)] for at in range(most)]


def _facts(run: Run, values: Sequence[object]) -> list[str]:
    """Return the facts of values, each with its range; tables are left out."""
    found: dict[str, list[Fact]] = {}
    for value in values:
        kind = run.plan.graph.registry.hooks.kind(type(value), "facts")
        for fact in kind.facts(value) if kind is not None and kind.facts is not None else ():
            if not isinstance(fact.value, Mapping):
                found.setdefault(fact.name, []).append(fact)
    return [
        f"{name} {_range(facts)}" + (f" (in {len(facts)})" if len(facts) < len(values) else "")
        for name, facts in found.items()
    ]


def _range(facts: Sequence[Fact]) -> str:
    texts = dict.fromkeys(fact.value for fact in facts if isinstance(fact.value, str))
    if texts:
        return listed(texts)
    numbers = sorted(
        fact.value if isinstance(fact.value, (int, float)) else len(fact.value) for fact in facts
    )
    low, high = numbers[0], numbers[-1]
    text = Fact("", high, facts[0].unit).text
    return text if low == high else f"{Fact('', low).text} to {text}"
