"""Graph files as written: YAML text -> spec, every part with its place."""

from nodegraph.spec.included import read_graph_file, read_graph_text
from nodegraph.spec.parts import GraphSpec

__all__ = ["GraphSpec", "read_graph_file", "read_graph_text"]
