"""A run that lies in a folder: what it was made of, and its values as far as they are stored."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from nodegraph.errors import NodegraphError, nearest
from nodegraph.formatting import name_at
from nodegraph.node.ports import Label
from nodegraph.runs.folder import RECORD
from nodegraph.runs.record import FORMAT
from nodegraph.state import State
from nodegraph.store import DamagedEntry, Store


class FinishedRun:
    """A run as its folder tells it.

    Parameters
    ----------
    folder
        Where it was written.

    Attributes
    ----------
    record : mapping
        What ``run.json`` holds.

    Raises
    ------
    NodegraphError
        If there is no run, or none that this version can read.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.record = _record(folder)

    def value(self, name: str, at: Mapping[str, object], store: Store) -> Any:
        """Return one value: of a node's first output, or of another one by ``node.port``.

        Parameters
        ----------
        name
        at
            A label, or its text, for each of the node's axes that has several.
        store
            Where the run's results are kept.

        Raises
        ------
        NodegraphError
            If the run has no such value, with what there is instead; if it is no longer stored,
            with the command that computes it again.
        """
        node, port = self._named(name)
        step = self._step(node, at)
        if not State(step["state"]).has_value:
            raise NodegraphError(f"{name_at(node, at)} was {step['state']}: {step.get('reason')}")
        position = self._position(step, port)
        entry = store.find(step["key"]) if step.get("key") else None
        try:
            values = None if entry is None else store.load(entry)
        except DamagedEntry:
            values = None
        if values is None or position >= len(values):
            raise NodegraphError(
                f"{name_at(node, at)}: its value is not in the store {store.folder}; compute it "
                f"again: {self.record['command']}"
            )
        return values[position]

    def outputs(self, step: Mapping[str, Any]) -> list[str]:
        """Return the names of the outputs of a recorded step."""
        methods = self.record["nodes"][step["node"]]["methods"].values()
        return next(list(one["outputs"]) for one in methods if one["use"] == step["use"])

    def _named(self, name: str) -> tuple[str, str]:
        """Return node and port; the nodes of a graph that is used have points in their names."""
        nodes = self.record["nodes"]
        node, point, port = name.rpartition(".")
        if name in nodes or not point:
            node, port = name, ""
        if node not in nodes:
            raise NodegraphError(
                f"{self.folder}: the run has no node {node!r}; {nearest(node, nodes)}"
            )
        there = {one for method in nodes[node]["methods"].values() for one in method["outputs"]}
        if port and port not in there:
            raise NodegraphError(f"{node!r} has no output {port!r}; {nearest(port, sorted(there))}")
        return node, port

    def _step(self, node: str, at: Mapping[str, object]) -> Mapping[str, Any]:
        found = [(labels, step) for labels, step in self._steps(node) if _fits(labels, at)]
        self._check_labels(node, at)
        if len(found) > 1:
            open_axes = [axis for axis in self.record["nodes"][node]["axes"] if axis not in at]
            several = [one for one in open_axes if len({labels[one] for labels, _ in found}) > 1]
            hint = " ".join(f"{axis} ({self._there(axis)})" for axis in several)
            raise NodegraphError(
                f"{name_at(node, at)} has {len(found)} values; say by --at: {hint}"
            )
        if not found:
            raise NodegraphError(f"{name_at(node, at)}: {self._why_none(node, at)}")
        return found[0][1]

    def _steps(self, node: str) -> Iterator[tuple[Mapping[str, Label], Mapping[str, Any]]]:
        """Yield labels and step of every combination of a node."""
        for step in self.record["steps"]:
            for one in (step, *step.get("also", ())):
                if one["node"] == node:
                    yield one["labels"], step

    def _check_labels(self, node: str, at: Mapping[str, object]) -> None:
        axes = self.record["nodes"][node]["axes"]
        for axis, label in at.items():
            if axis not in axes:
                raise NodegraphError(f"{node!r} has no axis {axis!r}; {nearest(axis, axes)}")
            labels = self.record["axes"][axis]
            if str(label) not in map(str, labels):
                raise NodegraphError(f"{axis!r} has no label {label!r}; {nearest(label, labels)}")

    def _there(self, axis: str) -> str:
        return ", ".join(map(str, self.record["axes"][axis]))

    def _why_none(self, node: str, at: Mapping[str, object]) -> str:
        for one in self.record["skipped"]:
            if one["node"] == node and _fits(one["labels"], at):
                return str(one["reason"])
        return "the run has no such combination"

    def _position(self, step: Mapping[str, Any], port: str) -> int:
        outputs = self.outputs(step)
        if port and port not in outputs:
            raise NodegraphError(f"{step['use']} has no output {port!r}; {nearest(port, outputs)}")
        return outputs.index(port) if port else 0


def _record(folder: Path) -> dict[str, Any]:
    from nodegraph.runs.record import misfit

    path = folder / RECORD
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):
        raise NodegraphError(
            f"{path}: there is no finished run; run the graph, or name the folder of a run"
        ) from None
    except (OSError, ValueError, RecursionError) as error:
        raise NodegraphError(f"{path} cannot be read ({error}); run the graph again") from error
    if not isinstance(found, dict):
        raise NodegraphError(f"{path} is not the record of a run; run the graph again")
    if found.get("format") != FORMAT:
        raise NodegraphError(
            f"{path} is of format {found.get('format')}, and only {FORMAT} can be read; run the "
            "graph again"
        )
    if wrong := misfit(found):
        raise NodegraphError(f"{path} cannot be read ({wrong}); run the graph again")
    return found


def _fits(labels: Mapping[str, Label], at: Mapping[str, object]) -> bool:
    return all(str(labels.get(axis)) == str(label) for axis, label in at.items())
