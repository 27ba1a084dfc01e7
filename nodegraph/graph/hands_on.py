"""Nodes that only hand on what they get: ``pass``, and a graph used as a node."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import SimpleNamespace
from typing import Any

from nodegraph.node import Node
from nodegraph.ports import Port
from nodegraph.signature import Setting


@dataclass(frozen=True)
class HandsOn(Node):
    """A node whose outputs are its inputs, one by one in the same order.

    Attributes
    ----------
    takes, gives : tuple of Port
        As many outputs as inputs.
    asks : tuple of Port
        What whoever uses it must feed. For a graph these are its own ports, which feed the nodes
        inside; what it takes comes from there.
    offers : tuple of str
        The outputs of all that it stands for: a graph's, of which it may hand on one alone.
    about : str
        What a reader of the report sees.
    """

    takes: tuple[Port, ...] = ()
    gives: tuple[Port, ...] = ()
    asks: tuple[Port, ...] = ()
    offers: tuple[str, ...] = ()
    about: str = ""

    @cached_property
    def inputs(self) -> tuple[Port, ...]:
        """What it takes."""
        return self.takes

    @cached_property
    def outputs(self) -> tuple[Port, ...]:
        """What it hands on."""
        return self.gives

    @cached_property
    def settings(self) -> Mapping[str, Setting]:
        """None."""
        return {}

    @cached_property
    def splits(self) -> bool:
        """Whether it hands on several values."""
        return len(self.gives) > 1

    @property
    def doc(self) -> str:
        """What a reader of the report sees."""
        return self.about


def asked(node: Node) -> tuple[Port, ...]:
    """Return the ports that whoever uses a node must feed."""
    return node.asks if isinstance(node, HandsOn) else node.inputs


def offered(node: Node) -> tuple[str, ...]:
    """Return the outputs that a reference to a node may name."""
    return node.offers if isinstance(node, HandsOn) else tuple(one.name for one in node.outputs)


def passing(sibling: Node) -> HandsOn:
    """Return what hands on its first input, typed and named as the sibling's first output."""
    gives = tuple(replace(port, columns=()) for port in sibling.outputs[:1])
    takes = tuple(replace(port, type=gives[0].type) for port in asked(sibling)[:1])
    about = "Hand on the input as it is."
    return HandsOn("pass", _hand_on, (), takes, gives, takes, (gives[0].name,), about)


def graph_node(
    use: str,
    title: str,
    asks: tuple[Port, ...],
    outputs: tuple[Port, ...],
    offers: tuple[str, ...],
) -> HandsOn:
    """Return what stands for a graph used as a node: it hands on what the nodes inside give."""
    return HandsOn(use, _hand_on, (), outputs, outputs, asks, offers, title)


def port_node(port: Port) -> HandsOn:
    """Return what stands inside a graph for one of its ports, while it is checked by itself."""
    return HandsOn(port.type.__name__, _hand_on, (), (), (Port("value", port.type),))


def _hand_on(**inputs: Any) -> Any:
    if len(inputs) == 1:
        return next(iter(inputs.values()))
    return SimpleNamespace(**inputs)
