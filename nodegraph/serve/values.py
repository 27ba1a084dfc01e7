"""Values of a run on pages: shown, packed for a chart, computed when they are not stored."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from nodegraph.errors import NodegraphError, nearest
from nodegraph.execute.results import Values
from nodegraph.formatting import labels_of, name_at
from nodegraph.node.ports import Label
from nodegraph.plugin.hook_types import Rendered
from nodegraph.runs.export import Exporter, exporters_of
from nodegraph.runs.reopen import ReopenedRun

Query = Mapping[str, str]
"""The query of an address."""

AT = "at."
"""Beginning of the names in a query that are axes."""

_LONGEST = 4000


@dataclass(frozen=True)
class Shown:
    """A value of a node, to be shown.

    Attributes
    ----------
    title : str
    rendered : Rendered
    seconds : float
        That its step took.
    kind : str
        Its type.
    exporters : mapping of suffix to exporter
        Files that it can be written as.
    """

    title: str
    rendered: Rendered
    seconds: float
    kind: str
    exporters: Mapping[str, Exporter]


def labels_in(query: Query) -> dict[str, str]:
    """Return the labels in a query: ``at.length=5``."""
    return {name.removeprefix(AT): text for name, text in query.items() if name.startswith(AT)}


def shown(run: ReopenedRun, query: Query) -> Shown:
    """Return the value that a query names.

    Parameters
    ----------
    run
    query
        ``node``, a node or one of its outputs, and a label for each axis that has several.

    Raises
    ------
    NotStored
        If it has to be computed.
    NodegraphError
        If there is no such value.
    """
    name = query.get("node", "")
    values = run[name]
    labels = exact_labels(run, values, labels_in(query))
    step = run.plan.cells[values.node][tuple(labels[axis] for axis in values.axes)]
    outcome = run.outcomes[step]
    if not outcome.state.has_value:
        raise NodegraphError(f"{name_at(name, labels)} was {outcome.state}: {outcome.reason}")
    value = values.shown_at(labels)
    registry = run.plan.graph.registry
    title = f"{name} {labels_of(labels)}".strip()
    return Shown(
        title,
        _rendered(run, value, title),
        outcome.seconds,
        type(value).__name__,
        exporters_of(value, registry),
    )


def exact_labels(
    run: ReopenedRun, values: Values, texts: Mapping[str, str]
) -> dict[str, Label]:
    """Return the labels of a value from their texts; axes with one label may be left out.

    Raises
    ------
    NodegraphError
        If they do not name one combination of the run.
    """
    for axis in texts:
        if axis not in values.axes:
            raise NodegraphError(f"{values.node!r} has no axis {axis!r}; {nearest(axis, values.axes)}")
    labels: dict[str, Label] = {}
    for axis in values.axes:
        known = {str(label): label for label in run.plan.graph.axes[axis].labels}
        text = texts.get(axis, next(iter(known)) if len(known) == 1 else "")
        if text not in known:
            raise NodegraphError(f"{axis!r} has no label {text!r}; {nearest(text, known)}")
        labels[axis] = known[text]
    combination = tuple(labels.values())
    if combination not in run.plan.cells[values.node]:
        reason = run.plan.skipped[values.node].get(combination, "the run has no such combination")
        raise NodegraphError(f"{name_at(values.node, labels)}: {reason}")
    return labels


def _rendered(run: ReopenedRun, value: Any, title: str) -> Rendered:
    for renderer in run.plan.graph.registry.hooks.renderers:
        if isinstance(value, renderer.type):
            return renderer.render(value, title)
    text = str(value)
    return Rendered("", text if len(text) <= _LONGEST else f"{text[:_LONGEST]} ...")
