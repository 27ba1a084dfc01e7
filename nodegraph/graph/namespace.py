"""The inputs and axes of a graph: what ``$name`` stands for, with the choices applied."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path

from nodegraph.errors import Hint, Place, Problems, listed, nearest, quoted
from nodegraph.graph.axes import chosen_axis, restricted_axis
from nodegraph.graph.model import Axis, Choices
from nodegraph.graphfile.axes import FILE
from nodegraph.graphfile.spec import GraphSpec, Variable, Written
from nodegraph.node.ports import Label, Port


class Namespace:
    """The inputs and axes of one graph.

    Attributes
    ----------
    inputs : dict of name to value
        Without the ports of a graph used as a node, and inputs that are axes by choice.
    axes : dict of name to Axis
        The axes of the file, inputs that are axes by choice, then those of nodes with alternatives.
    used : set of str
        Names that something refers to.
    invalid : set of Variable
        Variables without a value; the error is recorded.
    """

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
        self.invalid: set[Variable] = set()
        defaults = {
            name: part.value
            for name, part in spec.inputs.items()
            if name not in ports and name not in choices.axes
        }
        overrides = {name: value for name, value in choices.inputs.items() if name in defaults}
        self.inputs: dict[str, object] = defaults | overrides
        varied = [name for name in spec.inputs if name in choices.axes and name not in ports]
        self._valued = (*spec.axes, *varied)
        self.axes = {
            name: chosen_axis(name, spec.axes.get(name), choices, problems) for name in self._valued
        }

    def add_alternatives(self, node: str, labels: tuple[str, ...]) -> None:
        """Add the axis of a node with alternatives."""
        if node in self._choices.axes:
            place = Place(f"--axis {node}")
            self._problems.add(place, f"{quoted(node)} is a node", f"write --only {node}=...")
        self.axes[node] = restricted_axis(Axis(node, labels), self._choices, self._problems)

    def check_choices(self) -> None:
        """Record choices of unknown names, and axes and inputs that nothing uses."""
        for name, value in self._choices.inputs.items():
            self._check_set(name, value)
        for option, names in (("--axis", self._choices.axes), ("--only", self._choices.only)):
            for name in names:
                if name not in self.axes:
                    message = f"the graph has no axis {quoted(name)}"
                    known = {**self.axes, **(self.inputs if option == "--axis" else {})}
                    what = "axes and inputs" if len(known) > len(self.axes) else "axes"
                    hint = nearest(name, known, what=what)
                    self._problems.add(Place(f"{option} {name}"), message, hint)
        # refused already: a method is not a value
        methods = {method.use for node in self._spec.nodes.values() for method in node.methods}
        for kind, parts in (("axis", self._spec.axes), ("input", self._spec.inputs)):
            for name, part in parts.items():
                is_used = name in self.used or f"${name}" in methods
                if not is_used and name.isidentifier():
                    message = f"nothing uses the {kind} {quoted(name)}"
                    text = listed([f"${name}"])
                    usage = f"in: {text}" if name in self._ports else f"{text} as a setting's value"
                    self._problems.add(part.place, message, f"write {usage}")

    def axis_of(self, variable: Variable) -> str | None:
        """Return the axis that a variable names, or None for an input or an unknown name."""
        name = variable.name
        self.used.add(name)
        if name in self._valued:
            if not self.axes[name].labels:
                self.invalid.add(variable)
            return name
        if name in self._ports:
            message = f"{variable} is a port ({self._ports[name].type.__name__}), not a value"
            self._reject(variable, message, f"write in: ${name}")
        elif name not in self.inputs:
            known = [f"${known}" for known in (*self._spec.inputs, *self._spec.axes)]
            hint = partial(nearest, f"${name}", known)
            self._reject(variable, f"no input or axis {quoted(name)}", hint)
        elif variable.field and not isinstance(self.inputs[name], dict):
            message = (
                f"{variable}: the input {quoted(name)} has no fields, {quoted(self.inputs[name])}"
            )
            self._reject(variable, message, "an axis, or an input that is a mapping, has fields")
        return None

    def use(self, settings: Iterable[Written]) -> None:
        """Resolve the names in settings whose values are not needed."""
        for written in settings:
            for variable in written.variables():
                self.axis_of(variable)

    def value(self, variable: Variable, labels: Mapping[str, Label]) -> object:
        """Return the value of a variable at these labels."""
        name, axis = variable.name, self.axes.get(variable.name)
        value = axis.values.get(labels[name]) if axis is not None else self.inputs.get(name)
        if not variable.field:
            # a label with fields stands for its file, where it has one
            if axis is not None and isinstance(value, dict) and FILE in value:
                return value[FILE]
            return value
        if not isinstance(value, dict) or variable.field not in value:
            fields = list(value) if isinstance(value, dict) else []
            owner = (
                f"label {quoted(labels[name])}" if axis is not None else f"the input {quoted(name)}"
            )
            message = f"{variable}: {owner} has no field {quoted(variable.field)}"
            self._problems.add(variable.place, message, nearest(variable.field, fields))
            return None
        return value[variable.field]

    def folder(self, written: Written) -> Path:
        """Return where a relative path in a setting's value starts."""
        variable = written.value
        if not isinstance(variable, Variable):
            return written.folder or self._spec.folder
        if self._option(variable):
            return self._choices.folders.get(variable.name, self._choices.folder)
        axis = self._spec.axes.get(variable.name)
        return (axis and axis.folder) or self._spec.folder

    def place(self, written: Written) -> Place:
        """Return where a setting's value is written: in the file, or in the command."""
        option = self._option(written.value) if isinstance(written.value, Variable) else ""
        return Place(f"{option} {written.value.name}") if option else written.place

    def _option(self, variable: Variable) -> str:
        """Return the option that sets a variable; empty if none does."""
        if variable.name in self._choices.inputs:
            return "--set"
        return "--axis" if variable.name in self._choices.axes else ""

    def _reject(self, variable: Variable, message: str, hint: Hint) -> None:
        self.invalid.add(variable)
        self._problems.add(variable.place, message, hint)

    def _check_set(self, name: str, value: object) -> None:
        node, dot, setting = name.partition(".")
        if name in self._spec.inputs and name not in self._valued:
            return
        if name in self._spec.inputs:
            message = f"{quoted(name)} is set, and is an axis as well"
            hint = f"leave out --set {name} or --axis {name}"
        elif name in self._valued:
            message, hint = f"{quoted(name)} is an axis", f"write --axis {name}={value}"
        elif name in self.axes:
            message, hint = f"{quoted(name)} is a node", f"write --only {name}={value}"
        elif dot and node in self._spec.nodes:
            message = f"{quoted(name)} is a setting of a node, and the graph has no such input"
            hint = f"write with: {{{setting}: {value}}} at the node, or make it an input"
        else:
            message = f"the graph has no input {quoted(name)}"
            hint = nearest(name, self._spec.inputs)
        self._problems.add(Place(f"--set {name}"), message, hint)
