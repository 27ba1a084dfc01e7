"""Draws a graph as SVG, Mermaid or DOT, from plain descriptions of boxes and arrows."""

from nodegraph.draw.as_dot import dot
from nodegraph.draw.as_mermaid import mermaid
from nodegraph.draw.as_svg import svg
from nodegraph.draw.picture import Arrow, Box, Picture, Socket

__all__ = ["Arrow", "Box", "Picture", "Socket", "dot", "mermaid", "svg"]
