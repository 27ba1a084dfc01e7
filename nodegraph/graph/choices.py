"""What the command or the caller chooses: inputs, axes, and labels to keep."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from nodegraph.errors import Place, Problems, nearest
from nodegraph.graph.model import Axis
from nodegraph.graphfile.axes import read_given_axis
from nodegraph.graphfile.spec import GraphSpec, Variable, Written
from nodegraph.node.ports import Label, Port


@dataclass(frozen=True)
class Choices:
    """Values for inputs, labels for axes, and which labels to keep.

    Attributes
    ----------
    inputs : mapping
        Input -> value.
    axes : mapping
        Axis -> a list of labels, or a mapping of labels to values, or a generator.
    only : mapping
        Axis, or node with alternatives -> the labels to keep.
    folder : Path
        Where relative paths among them start.
    folders : mapping
        Input or axis -> where relative paths in its value start instead.
    """

    inputs: Mapping[str, Any] = field(default_factory=dict)
    axes: Mapping[str, Any] = field(default_factory=dict)
    only: Mapping[str, tuple[Label, ...]] = field(default_factory=dict)
    folder: Path = field(default_factory=Path.cwd)
    folders: Mapping[str, Path] = field(default_factory=dict)

    def updated(self, later: Choices) -> Choices:
        """Return these choices with later ones on top."""
        return Choices(
            {**self.inputs, **later.inputs},
            {**self.axes, **later.axes},
            {**self.only, **later.only},
            later.folder,
            {**self.folders, **later.folders},
        )


class Names:
    """The inputs and axes of a graph with the choices made: what ``$name`` stands for."""

    def __init__(
        self,
        spec: GraphSpec,
        ports: Mapping[str, Port],
        choices: Choices,
        problems: Problems,
    ) -> None:
        self._spec = spec
        self._ports = ports
        self._choices = choices
        self._problems = problems
        self.used: set[str] = set()
        self.unknown: set[Variable] = set()
        self.inputs = self._inputs()
        self.axes = {name: self._axis(name) for name in spec.axes}

    def add_alternatives(self, node: str, labels: tuple[str, ...]) -> Axis:
        """Return the axis that a node's alternatives are, without what was not to be kept."""
        if node in self._choices.axes:
            place = Place(f"--axis {node}")
            self._problems.add(place, f"{node!r} is a node", f"write --only {node}=...")
        self.axes[node] = self._kept(node, Axis(node, labels))
        return self.axes[node]

    def check_choices(self) -> None:
        """Note choices that name nothing of the graph, and axes and inputs that nothing uses."""
        self._check_known("--set", "input", self._choices.inputs, tuple(self._spec.inputs))
        self._check_known("--axis", "axis", self._choices.axes, tuple(self.axes))
        self._check_known("--only", "axis", self._choices.only, tuple(self.axes))
        for kind, parts in (("axis", self._spec.axes), ("input", self._spec.inputs)):
            for name, part in parts.items():
                if name not in self.used and name.isidentifier():
                    message = f"nothing uses the {kind} {name!r}"
                    where = (
                        f"in: ${name}" if name in self._ports else f"${name} as a setting's value"
                    )
                    self._problems.add(part.place, message, f"write {where}")

    def axis_of(self, variable: Variable) -> str | None:
        """Return the axis a variable names, or None for an input or an unknown name."""
        name = variable.name
        self.used.add(name)
        if name in self._spec.axes:
            if not self.axes[name].labels:
                self.unknown.add(variable)
            return name
        if name in self._ports:
            message = f"{variable} is a port ({self._ports[name].type.__name__}), not a value"
            self._refuse(variable, message, f"write in: ${name}")
        elif name not in self.inputs:
            there = [f"${one}" for one in (*self._spec.inputs, *self._spec.axes)]
            hint = nearest(f"${name}", there)
            self._refuse(variable, f"no input or axis {name!r}", hint)
        elif variable.field and not isinstance(self.inputs[name], dict):
            message = f"{variable}: the input {name!r} has no fields, {self.inputs[name]!r}"
            self._refuse(variable, message, "an axis, or an input that is a mapping, has fields")
        return None

    def use(self, settings: Iterable[Written]) -> None:
        """Look up what settings name that are not read here."""
        for written in settings:
            for variable in written.variables():
                self.axis_of(variable)

    def _refuse(self, variable: Variable, message: str, hint: str) -> None:
        self.unknown.add(variable)
        self._problems.add(variable.place, message, hint)

    def value(self, variable: Variable, labels: Mapping[str, Label]) -> Any:
        """Return what a variable stands for at these labels."""
        name, axis = variable.name, self.axes.get(variable.name)
        value = axis.values.get(labels[name]) if axis is not None else self.inputs.get(name)
        if not variable.field:
            return value
        if not isinstance(value, dict) or variable.field not in value:
            fields = list(value) if isinstance(value, dict) else []
            what = f"label {labels[name]!r}" if axis is not None else f"the input {name!r}"
            message = f"{variable}: {what} has no field {variable.field!r}"
            self._problems.add(variable.place, message, nearest(variable.field, fields))
            return None
        return value[variable.field]

    def folder(self, variable: Variable) -> Path:
        """Return where a relative path that a variable holds starts."""
        if self._option(variable):
            return self._choices.folders.get(variable.name, self._choices.folder)
        axis = self._spec.axes.get(variable.name)
        return (axis and axis.folder) or self._spec.folder

    def place(self, written: Written) -> Place:
        """Return where a setting's value was written: in the file, or in the command."""
        option = self._option(written.value) if isinstance(written.value, Variable) else ""
        return Place(f"{option} {written.value.name}") if option else written.place

    def _option(self, variable: Variable) -> str:
        """Return the option that chose what a variable stands for, if one did."""
        if variable.name in self._choices.inputs:
            return "--set"
        return "--axis" if variable.name in self._choices.axes else ""

    @property
    def graph_folder(self) -> Path:
        """Where relative paths in the graph file start."""
        return self._spec.folder

    def _inputs(self) -> dict[str, Any]:
        inputs = self._spec.inputs.items()
        given = {name: one.value for name, one in inputs if name not in self._ports}
        return {**given, **{k: v for k, v in self._choices.inputs.items() if k in given}}

    def _axis(self, name: str) -> Axis:
        written = self._spec.axes[name]
        labels, values = written.labels, written.values
        if name in self._choices.axes:
            chosen = read_given_axis(name, self._choices.axes[name], self._problems)
            labels, values = chosen.labels, chosen.values
        removed = frozenset(written.labels) - frozenset(labels)
        return self._kept(name, Axis(name, labels, dict(zip(labels, values, strict=True)), removed))

    def _kept(self, name: str, axis: Axis) -> Axis:
        chosen = self._choices.only.get(name)
        if chosen is None:
            return axis
        place = Place(f"--only {name}")
        if not chosen:
            self._problems.add(place, "no label is kept", nearest("", axis.labels))
        for label in chosen:
            if label not in axis.labels:
                self._problems.add(place, f"no label {label!r}", nearest(label, axis.labels))
        labels = tuple(label for label in axis.labels if label in chosen)
        removed = axis.removed | (frozenset(axis.labels) - frozenset(labels))
        return Axis(name, labels or axis.labels, axis.values, removed)

    def _check_known(
        self, option: str, what: str, chosen: Mapping[str, Any], known: tuple[str, ...]
    ) -> None:
        for name in chosen:
            if name not in known:
                message = f"the graph has no {what} {name!r}"
                self._problems.add(Place(f"{option} {name}"), message, nearest(name, known))
