"""Graph files: YAML text -> spec, every part with its place; and their JSON Schema."""

from nodegraph.graphfile.reader import read_graph_file, read_graph_text
from nodegraph.graphfile.spec import GraphSpec

__all__ = ["GraphSpec", "read_graph_file", "read_graph_text"]
