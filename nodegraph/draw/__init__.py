"""Draws a graph as SVG, PDF, Mermaid or DOT, from plain descriptions of boxes and arrows."""

from nodegraph.draw.dot import dot
from nodegraph.draw.mermaid import mermaid
from nodegraph.draw.pdf import pdf
from nodegraph.draw.picture import Alternative, Arrow, Axis, Box, Picture, Socket
from nodegraph.draw.svg import svg

__all__ = [
    "Alternative",
    "Arrow",
    "Axis",
    "Box",
    "Picture",
    "Socket",
    "dot",
    "mermaid",
    "pdf",
    "svg",
]
