"""The typed graph: a spec with the installed nodes behind it, checked in full."""

from nodegraph.graph.build import build
from nodegraph.graph.model import (
    Axis,
    Choices,
    Gather,
    Graph,
    GraphNode,
    LeftOut,
    Method,
    Settings,
    Wire,
)
from nodegraph.graph.pass_through import PassThrough

__all__ = [
    "Axis",
    "Choices",
    "Gather",
    "Graph",
    "GraphNode",
    "LeftOut",
    "Method",
    "PassThrough",
    "Settings",
    "Wire",
    "build",
]
