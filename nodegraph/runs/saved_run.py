"""A run in a folder: its record, and its values as far as they are stored."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

from nodegraph.errors import NodegraphError, nearest
from nodegraph.formatting import name_at
from nodegraph.node.ports import Label
from nodegraph.runs.record import RecordedStep
from nodegraph.runs.record_files import read_record
from nodegraph.store import DamagedEntry, Store


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

    def value(self, name: str, at: Mapping[str, object], store: Store) -> Any:
        """Return a value of a node.

        Parameters
        ----------
        name
            A node, for its first output, or ``node.port``.
        at
            A label, or its text, for each axis of the node that has several.
        store
            Where the results of the run are stored.

        Raises
        ------
        NodegraphError
            If the run has no such value, or it is no longer stored.
        """
        node, port = self._node_and_port(name)
        step = self._step(node, at)
        if not step.has_result:
            raise NodegraphError(f"{name_at(node, at)} was {step.state}: {step.reason}")
        outputs = self.record.method(step).outputs
        if port and port not in outputs:
            raise NodegraphError(f"{step.use} has no output {port!r}; {nearest(port, outputs)}")
        position = outputs.index(port) if port else 0
        values = stored_values(step, store)
        if position >= len(values):
            raise NodegraphError(
                f"{name_at(node, at)}: its value is not in the store {store.folder}; to compute it "
                f"again, run: {self.record.command}"
            )
        return values[position]

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

    def _step(self, node: str, at: Mapping[str, object]) -> RecordedStep:
        self._check_labels(node, at)
        matches = [(labels, step) for labels, step in self._steps(node) if _matches(labels, at)]
        if len(matches) > 1:
            free = [axis for axis in self.record.nodes[node].axes if axis not in at]
            several = [axis for axis in free if len({labels[axis] for labels, _ in matches}) > 1]
            labels = self.record.axes
            hint = " ".join(f"{axis} ({', '.join(map(str, labels[axis]))})" for axis in several)
            raise NodegraphError(
                f"{name_at(node, at)} has {len(matches)} values; choose with --at: {hint}"
            )
        if not matches:
            reasons = (
                skipped.reason
                for skipped in self.record.skipped
                if node in skipped.counts and _may_be_at(skipped.labels, at)
            )
            reason = next(reasons, "the run has no such combination")
            raise NodegraphError(f"{name_at(node, at)}: {reason}")
        return matches[0][1]

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


def stored_values(step: RecordedStep, store: Store) -> tuple[Any, ...]:
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
