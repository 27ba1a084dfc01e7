"""A run in a folder: its record, and its values as far as they are stored."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.errors import NodegraphError, nearest
from nodegraph.execute.call import Outcome
from nodegraph.execute.value_table import value_table
from nodegraph.formatting import name_at
from nodegraph.node.ports import Label
from nodegraph.plan import Combination
from nodegraph.runs.record import RecordedStep
from nodegraph.runs.record_files import read_record
from nodegraph.store import DamagedEntry, Store

if TYPE_CHECKING:
    import pandas as pd


class SavedRun:
    """A run in a folder.

    Parameters
    ----------
    folder

    Attributes
    ----------
    record : Record

    Raises
    ------
    NodegraphError
        If the folder has no record, or none that this version can read.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.record = read_record(folder)

    def value(self, name: str, at: Mapping[str, object], store: Store) -> object:
        """Return a value of a node, or the rows of several tables as one.

        Parameters
        ----------
        name
            A node, for its first output, or ``node.port``.
        at
            A label, or its text, for axes of the node. Tables at all labels of the others become
            one, with a column for each axis of the node; of other values, one must be left.
        store
            Where the results of the run are stored.

        Raises
        ------
        NodegraphError
            If the run has no such value, has several that are not tables, or one is no longer
            stored.
        """
        node, port = self._node_and_port(name)
        matches = self._matches(node, at)
        if len(matches) == 1:
            return self._value(node, port, *matches[0], store)
        return self._rows(node, port, at, matches, store)

    def _value(
        self, node: str, port: str, labels: Mapping[str, Label], step: RecordedStep, store: Store
    ) -> object:
        if not step.has_result:
            raise NodegraphError(f"{name_at(node, labels)} was {step.state}: {step.reason}")
        outputs = self.record.method(step).outputs
        if port and port not in outputs:
            raise NodegraphError(f"{step.use} has no output {port!r}; {nearest(port, outputs)}")
        position = outputs.index(port) if port else 0
        values = stored_values(step, store)
        if position >= len(values):
            raise NodegraphError(
                f"{name_at(node, labels)}: its value is not in the store {store.folder}; to "
                f"compute it again, run: {self.record.command}"
            )
        return values[position]

    def _rows(
        self,
        node: str,
        port: str,
        at: Mapping[str, object],
        matches: Sequence[tuple[Mapping[str, Label], RecordedStep]],
        store: Store,
    ) -> pd.DataFrame:
        import pandas as pd

        labels = self.record.axes
        axes = {axis: labels[axis] for axis in self.record.nodes[node].axes}
        values: dict[Combination, object] = {}
        absent: dict[Combination, Outcome] = {}
        for cell, step in matches:
            combination = tuple(cell[axis] for axis in axes)
            if not step.has_result:
                absent[combination] = Outcome(step.state, reason=step.reason)
                continue
            values[combination] = self._value(node, port, cell, step, store)
            if not isinstance(values[combination], pd.DataFrame):
                break
        else:
            return value_table(node, port or node, axes, values, absent)
        free = [axis for axis in axes if axis not in at]
        several = [axis for axis in free if len({cell[axis] for cell, _ in matches}) > 1]
        texts = (f"{axis} ({', '.join(map(str, labels[axis]))})" for axis in several)
        example = ",".join(f"{axis}={labels[axis][0]}" for axis in several)
        raise NodegraphError(
            f"{name_at(node, at)} has {len(matches)} values; choose a label of each axis, such as "
            f"--at {example}; axes: {', '.join(texts)}"
        )

    def _node_and_port(self, name: str) -> tuple[str, str]:
        nodes = self.record.nodes
        node, point, port = name.rpartition(".")
        if name in nodes or not point:  # nodes of a graph used as a node have points in their names
            node, port = name, ""
        if node not in nodes:
            raise NodegraphError(
                f"{self.folder}: the run has no node {node!r}; {nearest(node, nodes)}"
            )
        outputs = {output for method in nodes[node].methods.values() for output in method.outputs}
        if port and port not in outputs:
            raise NodegraphError(
                f"{node!r} has no output {port!r}; {nearest(port, sorted(outputs))}"
            )
        return node, port

    def _matches(
        self, node: str, at: Mapping[str, object]
    ) -> list[tuple[Mapping[str, Label], RecordedStep]]:
        self._check_labels(node, at)
        matches = [(labels, step) for labels, step in self._steps(node) if _matches(labels, at)]
        if not matches:
            reasons = (
                skipped.reason
                for skipped in self.record.skipped
                if node in skipped.counts and _may_be_at(skipped.labels, at)
            )
            reason = next(reasons, "the run has no such combination")
            raise NodegraphError(f"{name_at(node, at)}: {reason}")
        return matches

    def _steps(self, node: str) -> Iterator[tuple[Mapping[str, Label], RecordedStep]]:
        """Yield labels and step of every combination of a node."""
        for step in self.record.steps:
            for cell in step.cells:
                if cell.node == node:
                    yield cell.labels, step

    def _check_labels(self, node: str, at: Mapping[str, object]) -> None:
        axes = self.record.nodes[node].axes
        for axis, label in at.items():
            if axis not in axes:
                raise NodegraphError(f"{node!r} has no axis {axis!r}; {nearest(axis, axes)}")
            labels = self.record.axes[axis]
            if str(label) not in map(str, labels):
                raise NodegraphError(f"{axis!r} has no label {label!r}; {nearest(label, labels)}")


def stored_values(step: RecordedStep, store: Store) -> tuple[object, ...]:
    """Return the values of a step; nothing if they are not stored."""
    entry = store.find(step.key) if step.key else None
    try:
        return store.load(entry) if entry is not None else ()
    except DamagedEntry:
        return ()


def _may_be_at(labels: Mapping[str, Collection[Label]], at: Mapping[str, object]) -> bool:
    return all(str(at[axis]) in map(str, of) for axis, of in labels.items() if axis in at)


def _matches(labels: Mapping[str, Label], at: Mapping[str, object]) -> bool:
    return all(str(labels.get(axis)) == str(label) for axis, label in at.items())
