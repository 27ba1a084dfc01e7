"""A value of a run, found by its record alone: neither its graph nor its inputs need be there."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from nodegraph.errors import NodegraphError, nearest
from nodegraph.execute.outcome import Outcome
from nodegraph.execute.value_table import value_table
from nodegraph.formatting import name_at
from nodegraph.plan import Combination
from nodegraph.runs.record import Cell, Record, RecordedStep
from nodegraph.store import DamagedEntry, Entry, Store, Upkeep

if TYPE_CHECKING:
    import pandas as pd


def recorded_value(record: Record, name: str, at: Mapping[str, object], store: Store) -> object:
    """Return a value of a node, or the rows of several tables as one.

    Parameters
    ----------
    record
    name
        A node, for its first output, or ``node.port``.
    at
        A label, or its text, for axes of the node. Tables at all labels of the others become one,
        with a column for each axis of the node; of other values, one must be left.
    store
        Where the results of the run are stored.

    Raises
    ------
    NodegraphError
        If the run has no such value, has several that are not tables, or one is no longer stored.
    """
    node, port = _node_and_port(record, name)
    _check_labels(record, node, at)
    cells = [
        (cell, step)
        for step in record.steps
        for cell in step.cells
        if cell.node == node
        and all(str(cell.labels[axis]) == str(label) for axis, label in at.items())
    ]
    if not cells:
        raise NodegraphError(f"{name_at(node, at)}: {_why_not_planned(record, node, at)}")
    if len(cells) == 1:
        return _value(record, *cells[0], port, store)
    return _rows(record, node, port, at, cells, store)


class StoredValues:
    """The stored values of recorded steps, found by their key or, in a lock, by their digests.

    Parameters
    ----------
    store
        Listed when the first step without a key is looked for.
    """

    def __init__(self, store: Store) -> None:
        self._store = store

    def of(self, step: RecordedStep) -> tuple[object, ...]:
        """Return the values of a step; nothing if they are not stored."""
        entry = self._store.find(step.key) if step.key else self._by_digests(step)
        try:
            return self._store.load(entry) if entry is not None else ()
        except DamagedEntry:
            return ()

    def _by_digests(self, step: RecordedStep) -> Entry | None:
        known = (entry for entry in self._by_node.get(step.use, ()) if any(step.digests))
        return next((entry for entry in known if _begin(entry.digests, step.digests)), None)

    @cached_property
    def _by_node(self) -> Mapping[str, list[Entry]]:
        by_node: dict[str, list[Entry]] = defaultdict(list)
        for kept in Upkeep(self._store.folder).entries():
            by_node[kept.entry.node].append(kept.entry)
        return by_node


def _begin(digests: Sequence[str], starts: Sequence[str]) -> bool:
    pairs = zip(digests, starts, strict=False)
    return len(digests) == len(starts) and all(whole.startswith(start) for whole, start in pairs)


def _value(record: Record, cell: Cell, step: RecordedStep, port: str, store: Store) -> object:
    place = name_at(cell.node, cell.labels)
    if not step.has_result:
        raise NodegraphError(f"{place} was {step.state}: {step.reason}")
    outputs = record.method(step).outputs
    if port and port not in outputs:
        raise NodegraphError(f"{step.use} has no output {port!r}; {nearest(port, outputs)}")
    position = outputs.index(port) if port else 0
    values = StoredValues(store).of(step)
    if position >= len(values):
        raise NodegraphError(
            f"{place}: its value is not in the store {store.folder}; to compute it again, run: "
            f"{record.command}"
        )
    return values[position]


def _rows(
    record: Record,
    node: str,
    port: str,
    at: Mapping[str, object],
    cells: list[tuple[Cell, RecordedStep]],
    store: Store,
) -> pd.DataFrame:
    import pandas as pd

    axes = {axis: record.axes[axis] for axis in record.nodes[node].axes}
    values: dict[Combination, object] = {}
    absent: dict[Combination, Outcome] = {}
    for cell, step in cells:
        combination = tuple(cell.labels[axis] for axis in axes)
        if not step.has_result:
            absent[combination] = Outcome(step.state, reason=step.reason)
            continue
        values[combination] = _value(record, cell, step, port, store)
        if not isinstance(values[combination], pd.DataFrame):
            break
    else:
        return value_table(node, port or node, axes, values, absent)
    several = [axis for axis in axes if len({cell.labels[axis] for cell, _ in cells}) > 1]
    texts = (f"{axis} ({', '.join(map(str, axes[axis]))})" for axis in several)
    example = ",".join(f"{axis}={axes[axis][0]}" for axis in several)
    raise NodegraphError(
        f"{name_at(node, at)} has {len(cells)} values; choose a label of each axis, such as "
        f"--at {example}; axes: {', '.join(texts)}"
    )


def _node_and_port(record: Record, name: str) -> tuple[str, str]:
    node, point, port = name.rpartition(".")
    # nodes of a graph used as a node have points in their names
    if name in record.nodes or not point:
        node, port = name, ""
    if node not in record.nodes:
        raise NodegraphError(f"the run has no node {node!r}; {nearest(node, record.nodes)}")
    methods = record.nodes[node].methods.values()
    outputs = {output for method in methods for output in method.outputs}
    if port and port not in outputs:
        raise NodegraphError(f"{node!r} has no output {port!r}; {nearest(port, sorted(outputs))}")
    return node, port


def _check_labels(record: Record, node: str, at: Mapping[str, object]) -> None:
    axes = record.nodes[node].axes
    for axis, label in at.items():
        if axis not in axes:
            raise NodegraphError(f"{node!r} has no axis {axis!r}; {nearest(axis, axes)}")
        if str(label) not in map(str, record.axes[axis]):
            hint = nearest(label, record.axes[axis])
            raise NodegraphError(f"{axis!r} has no label {label!r}; {hint}")


def _why_not_planned(record: Record, node: str, at: Mapping[str, object]) -> str:
    for skipped in record.skipped:
        named = skipped.labels.items()
        if node in skipped.counts and all(
            axis not in at or str(at[axis]) in map(str, labels) for axis, labels in named
        ):
            return skipped.reason
    return "the run has no such combination"
