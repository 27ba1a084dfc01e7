"""Nodes that compute nothing: ``pass``, and what stands for a graph used as a node."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import SimpleNamespace

from nodegraph.node.decorator import Node, Setting
from nodegraph.node.ports import Port


@dataclass(frozen=True)
class PassThrough(Node):
    """A node that returns its inputs: its first output is its first input, and so on.

    Attributes
    ----------
    source_ports, target_ports : tuple of Port
        Its inputs, and as many outputs.
    public_inputs : tuple of Port
        The ports that a user of the node feeds. Those of a graph feed the nodes inside it, and
        its inputs come from there.
    public_outputs : tuple of str
        The outputs that a reference may name: all of a graph, of which the node may return a
        single one.
    text : str
        Its docstring.
    """

    source_ports: tuple[Port, ...] = ()
    target_ports: tuple[Port, ...] = ()
    public_inputs: tuple[Port, ...] = ()
    public_outputs: tuple[str, ...] = ()
    text: str = ""

    @cached_property
    def inputs(self) -> tuple[Port, ...]:
        """Input ports."""
        return self.source_ports

    @cached_property
    def outputs(self) -> tuple[Port, ...]:
        """Output ports."""
        return self.target_ports

    @cached_property
    def damages(self) -> bool:
        """False: the truth that it returns is the truth that it takes."""
        return False

    @cached_property
    def settings(self) -> Mapping[str, Setting]:
        """Nothing can be set."""
        return {}

    @cached_property
    def splits(self) -> bool:
        """Whether it returns several outputs."""
        return len(self.target_ports) > 1

    @property
    def doc(self) -> str:
        """The description of the node in the report."""
        return self.text


def public_inputs(node: Node) -> tuple[Port, ...]:
    """Return the ports that a user of a node feeds."""
    return node.public_inputs if isinstance(node, PassThrough) else node.inputs


def public_outputs(node: Node) -> tuple[str, ...]:
    """Return the outputs of a node that a reference may name."""
    if isinstance(node, PassThrough):
        return node.public_outputs
    return tuple(port.name for port in node.outputs)


def pass_beside(sibling: Node) -> PassThrough:
    """Return ``pass`` among alternatives: its only output is typed and named as a sibling's."""
    outputs = tuple(replace(port, columns=()) for port in sibling.outputs[:1])
    inputs = tuple(replace(port, type=outputs[0].type) for port in public_inputs(sibling)[:1])
    text = "Return the input as it is."
    return PassThrough("pass", _identity, (), inputs, outputs, inputs, (outputs[0].name,), text)


def graph_stand_in(
    use: str,
    title: str,
    inputs: tuple[Port, ...],
    outputs: tuple[Port, ...],
    output_names: tuple[str, ...],
) -> PassThrough:
    """Return the node that stands for a graph file; it returns outputs of the nodes inside."""
    return PassThrough(use, _identity, (), outputs, outputs, inputs, output_names, title)


def graph_as_node(
    use: str, title: str, inputs: tuple[Port, ...], outputs: tuple[Port, ...]
) -> PassThrough:
    """Return a graph file as a node with its own ports, for what shows it."""
    names = tuple(port.name for port in outputs)
    return PassThrough(use, _identity, (), inputs, outputs, inputs, names, title)


def port_stand_in(port: Port) -> PassThrough:
    """Return the node that stands for a port of a graph file while the file is checked alone."""
    return PassThrough(port.type.__name__, _identity, (), (), (Port("value", port.type),))


def _identity(**inputs: object) -> object:
    if len(inputs) == 1:
        return next(iter(inputs.values()))
    return SimpleNamespace(**inputs)
