"""Edits of graph files: each changes the lines that it names, and leaves all others as they are.

An action takes the text of a file and returns the changed text, or raises a `GraphError` with the
place and the reason. Comments, order, indentation and line breaks stay.

>>> from pathlib import Path
>>> from nodegraph.edit import add_alternative
>>> file = Path("fill.yaml")
>>> text = add_alternative(file.read_text(), "fill", "mine", {"use": "fill.mine"})
"""

from nodegraph.edit.actions import (
    add_alternative,
    add_node,
    connect,
    disconnect,
    remove_alternative,
    remove_node,
    rename,
    set_axis,
    set_value,
    unset,
)
from nodegraph.edit.move import move_to_graph

__all__ = [
    "add_alternative",
    "add_node",
    "connect",
    "disconnect",
    "move_to_graph",
    "remove_alternative",
    "remove_node",
    "rename",
    "set_axis",
    "set_value",
    "unset",
]
