"""Values of a run on pages: shown, packed for a chart, computed when they are not stored."""

from __future__ import annotations

import json
import reprlib
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, NamedTuple
from urllib.parse import urlencode

from nodegraph.errors import NodegraphError, Refusal, listed, nearest
from nodegraph.execute.results import NotStored, Run, Values
from nodegraph.formatting import labels_of, name_at
from nodegraph.node.ports import Label
from nodegraph.plugin.hook_types import Rendered
from nodegraph.plugin.registry import Registry
from nodegraph.report.origin import RunOrigin, render_in_run
from nodegraph.runs.export import Exporter, exporters_of
from nodegraph.runs.record import Cell
from nodegraph.serve.progress import IN_ORDER, StepState
from nodegraph.validation_errors import adapter_of, first_error

Query = Mapping[str, str]
"""The query of an address."""

AT = "at."
"""Beginning of the names in a query that are axes."""


@dataclass(frozen=True)
class Shown:
    """A value of a node, to be shown.

    Attributes
    ----------
    node, labels : str
    rendered : Rendered
    seconds : float
        Duration of its step.
    kind : str
        Its type.
    exporters : mapping of suffix to exporter
        Files that it can be written as.
    """

    node: str
    labels: str
    rendered: Rendered
    seconds: float
    kind: str
    exporters: Mapping[str, Exporter]


def labels_in(query: Query) -> dict[str, str]:
    """Return the labels in a query: ``at.length=5``."""
    return {name.removeprefix(AT): text for name, text in query.items() if name.startswith(AT)}


class Combination(NamedTuple):
    """One combination of a node, as a list shows it.

    Attributes
    ----------
    labels : str
        Labels of the axes along which the node has several; else its name.
    address : str
        The query of its value; empty without one.
    state : str
    message : str
        Why there is no value, with the place if it failed.
    """

    labels: str
    address: str
    state: str
    message: str


class Combinations:
    """The combinations of a node with their states.

    Parameters
    ----------
    run
        Its name.
    states
        States of the steps of all nodes.
    query
        ``node``, and ``state`` and labels as far as they are chosen.

    Attributes
    ----------
    rows : list of Combination
        Those that are chosen; what has failed comes first.
    axes : dict of axis to labels
        Along which the node has several.
    states : list of str
        In which some of all its combinations are.
    """

    def __init__(self, run: str, states: Iterable[StepState], query: Query) -> None:
        of_node = [each for each in states if each.cell.node == query["node"]]
        labels: dict[str, dict[str, None]] = {}
        for each in of_node:
            for axis, label in each.cell.labels.items():
                labels.setdefault(axis, {})[str(label)] = None
        self.axes = {axis: list(known) for axis, known in labels.items() if len(known) > 1}
        found = {each.state for each in of_node}
        self.states = [str(state) for state in IN_ORDER if state in found]
        chosen = {name: text for name, text in labels_in(query).items() if text}
        self.rows = [
            Combination(
                self._text(each.cell),
                _address(run, each.cell) if each.has_value else "",
                each.state,
                each.message,
            )
            for state in self.states
            for each in of_node
            if each.state == state
            and query.get("state", "") in ("", state)
            and all(str(each.cell.labels.get(axis)) == text for axis, text in chosen.items())
        ]

    def _text(self, cell: Cell) -> str:
        labels = {axis: label for axis, label in cell.labels.items() if axis in self.axes}
        return labels_of(labels) or cell.node


def _address(run: str, cell: Cell) -> str:
    labels = {f"{AT}{axis}": label for axis, label in cell.labels.items()}
    return urlencode({"run": run, "node": cell.node, **labels})


def shown(run: Run, query: Query) -> Shown:
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
    text = labels_of(labels)
    title = f"{name} {text}".strip()
    origin = RunOrigin(run, values.node, labels)
    return Shown(
        values.node,
        text,
        render_in_run(value, title, origin) or _viewed(value, title, registry),
        outcome.seconds,
        type(value).__name__,
        exporters_of(value, registry),
    )


def exact_labels(run: Run, values: Values, texts: Mapping[str, str]) -> dict[str, Label]:
    """Return the labels of a value from their texts; axes with one label may be left out.

    Raises
    ------
    NodegraphError
        If they do not name one combination of the run.
    """
    for axis in texts:
        if axis not in values.axes:
            raise NodegraphError(
                f"{values.node!r} has no axis {axis!r}; {nearest(axis, values.axes)}"
            )
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


@dataclass(frozen=True)
class BlockQuery:
    """The block of a comparison that is shown.

    Attributes
    ----------
    node : str
        The node that compares.
    compare : str
        The axis of the methods.
    methods : tuple of label
    block : mapping of column to label
        The labels that identify the block, those of its combination included.
    """

    node: str
    compare: str
    methods: tuple[Label | None, ...]
    block: Mapping[str, Label | None]

    @classmethod
    def of(cls, query: Query) -> BlockQuery:
        """Return the request in a query.

        Raises
        ------
        NodegraphError
            If it is not of that form.
        """
        from pydantic import ValidationError

        data: dict[str, object] = {**query}
        try:
            data |= {name: json.loads(query[name]) for name in ("methods", "block")}
            wanted: BlockQuery = adapter_of(BlockQuery).validate_python(data)
            return wanted
        except ValidationError as error:
            reason = first_error(error, data)
            raise NodegraphError(f"a block cannot be looked up: {reason}") from error
        except (KeyError, ValueError, RecursionError) as error:
            raise NodegraphError(f"a block cannot be looked up: {error!r}") from error


def packed(run: Run, query: Query) -> Mapping[str, object]:
    """Return the data of the view of a block; see `nodegraph.Detail`.

    Parameters
    ----------
    run
    query
        See `BlockQuery`; methods and block are JSON.

    Raises
    ------
    NotStored
        If what the block's scores read has to be computed.
    NodegraphError
        If there is no such block, or no plugin shows it.
    """
    wanted = BlockQuery.of(query)
    values = run[wanted.node]
    at = exact_labels(run, values, labels_in(query))
    origin = RunOrigin(run, wanted.node, at)
    known = {axis.name: axis.labels for axis in run.plan.graph.axes.values()}
    labels: dict[str, Any] = {
        axis: next((label for label in known.get(axis, ()) if str(label) == str(text)), text)
        for axis, text in wanted.block.items()
    }
    methods = {*map(str, wanted.methods)}
    steps = {
        method: step
        for method in known.get(wanted.compare, ())
        if str(method) in methods
        and (step := origin.step({**labels, wanted.compare: method})) is not None
    }
    needed = {output.step for step in steps.values() for output in step.reads()}
    ended = {index: run.outcomes[index].state for index in needed}
    missing = [
        index for index in sorted(needed) if ended[index].has_value and not run.has_at_hand(index)
    ]
    if missing:
        raise NotStored(run.plan.steps[index] for index in missing)
    inputs = {
        str(method): origin.inputs({**labels, wanted.compare: method}) or {}
        for method, step in steps.items()
        if all(ended[output.step].has_value for output in step.reads())
    }
    first = next((value for ports in inputs.values() for value in ports.values()), None)
    detail = origin.detail(first)
    content = detail.pack(labels, inputs) if detail is not None else None
    if content is not None:
        return content
    raise NodegraphError("there is nothing to show of this block")


def _viewed(value: object, title: str, registry: Registry) -> Rendered:
    """Return how a value appears that no plugin renders: as files are viewed, or as a summary."""
    viewer = registry.hooks.viewer(value)
    if viewer is not None:
        with suppress(Refusal):
            return viewer.view({title: value})
    return Rendered("", _summary(value))


def _summary(value: object) -> str:
    """Return a summary of a value that no plugin shows."""
    if not is_dataclass(value):
        return _part(value)
    return "\n".join(f"{each.name}: {_part(getattr(value, each.name))}" for each in fields(value))


def _part(value: object) -> str:
    if hasattr(value, "shape") and hasattr(value, "dtype"):
        return f"{' x '.join(map(str, value.shape))} {value.dtype}"
    if isinstance(value, (tuple, list)):
        return listed(value)
    return reprlib.repr(value)
