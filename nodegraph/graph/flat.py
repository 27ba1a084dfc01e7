"""A graph file with the nodes of the graphs that it uses in their place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from nodegraph.ports import Port
from nodegraph.registry import Registered
from nodegraph.spec.parts import GraphSpec, Reference, Written


@dataclass(frozen=True)
class Feed:
    """What a node feeds to a port of the graph that it uses.

    Attributes
    ----------
    where : str
        Names the node in messages.
    port : Port or None
        None where the graph has no such port; that is told already.
    """

    where: str
    port: Port | None
    source: Reference


@dataclass(frozen=True)
class Flat:
    """A graph in which no node uses another graph any more.

    Attributes
    ----------
    spec : GraphSpec
        Its nodes are its own, what stands for its ports (``$recording``), and those of the graphs
        that it uses (``clean.despike``).
    ports : mapping of name to Port
        Its inputs that are ports.
    graphs : mapping of node to (mapping of label to Registered)
        What stands for the graphs that its nodes use, and for its ports.
    feeds : tuple of Feed
    given : tuple of Written
        Settings that it gives to the graphs that it uses.
    is_whole : bool
        Whether every graph that it uses could be put in its place.
    """

    spec: GraphSpec
    ports: Mapping[str, Port]
    graphs: Mapping[str, Mapping[str, Registered]]
    feeds: tuple[Feed, ...]
    given: tuple[Written, ...]
    is_whole: bool
