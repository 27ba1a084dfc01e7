"""Spec + registry -> typed graph; every check happens here."""

from nodegraph.graph.build import build
from nodegraph.graph.choices import Choices
from nodegraph.graph.model import Axis, Gather, Graph, GraphNode, HandsOn, Method, until

__all__ = [
    "Axis",
    "Choices",
    "Gather",
    "Graph",
    "GraphNode",
    "HandsOn",
    "Method",
    "build",
    "until",
]
