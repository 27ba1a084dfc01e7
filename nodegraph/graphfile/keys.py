"""The keys of a graph file: the form of each value, and its meaning.

The reader and the JSON Schema are both driven by these tables and patterns.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, auto

FORMAT = 1
IDENTIFIER = "[A-Za-z_][A-Za-z0-9_]*"
REFERENCE = rf"\$?{IDENTIFIER}(\.{IDENTIFIER})?"
VARIABLE = rf"\$({IDENTIFIER})(?:\.({IDENTIFIER}))?"
MOST_LABELS = 1_000_000
PASS = "pass"

IDENTIFIER_HINT = "use letters, digits and _, not a digit first"
REFERENCE_HINT = "write node, node.port, or {from: node.port, at: {axis: label}}"
REPORT_HINT = (
    "write node, node.port, or {show: node.port, at: ..., title: ..., caption: ..., notes: ..., "
    "answer: ...}"
)
AXIS_HINT = (
    "write a list [5, 15], labels {a: 5, b: 15}, {count: 20}, {range: [5, 60, 5]} or "
    '{files: "data/*.csv"}'
)
ALTERNATIVES_HINT = (
    "write {label: {use: family.method, with: {...}}}, [family.method, ...] or family.* for all "
    "its methods"
)


class Form(Enum):
    """The form of the value at a key."""

    NUMBER = auto()
    TEXT = auto()
    INPUTS = auto()
    AXES = auto()
    NODES = auto()
    COMBINATIONS = auto()
    REFERENCES = auto()
    REPORT = auto()
    DISTRIBUTIONS = auto()
    OUTPUTS = auto()
    NODE_NAME = auto()
    WIRING = auto()
    SETTINGS = auto()
    ALTERNATIVES = auto()
    AXIS_NAMES = auto()
    SOURCE = auto()
    LABELS = auto()


@dataclass(frozen=True)
class Key:
    """The form of the value at a key, and its meaning, which editors show."""

    form: Form
    meaning: str


TOP_LEVEL: Mapping[str, Key] = {
    "nodegraph": Key(Form.NUMBER, "The format's number."),
    "title": Key(Form.TEXT, "What the report is called."),
    "notes": Key(Form.TEXT, "Markdown that the report shows."),
    "inputs": Key(
        Form.INPUTS,
        "One value each, $name in settings; --set NAME=VALUE. In a graph that is used as a node,"
        " the name of a type makes a port.",
    ),
    "axes": Key(
        Form.AXES,
        "A list, labels with values, {count: n}, {range: [first, last, step]} or {files: pattern},"
        " where {actor}_{take}.c3d gives fields, $axis.actor. A node runs once for each"
        " label of the axes that reach it.",
    ),
    "nodes": Key(Form.NODES, "What is done, by name."),
    "skip": Key(Form.COMBINATIONS, "Combinations to leave out: [{axis: label or labels}]."),
    "known": Key(Form.REFERENCES, "Nodes or ports that a method may know."),
    "requires": Key(Form.DISTRIBUTIONS, "Distributions that must be installed, as pip names them."),
    "outputs": Key(
        Form.OUTPUTS, "What a graph gives when it is used as a node: name -> reference."
    ),
    "report": Key(
        Form.REPORT,
        "What the report shows: node, node.port, or {show: node.port, title: ..., caption: ...,"
        " notes: ..., answer: ...}.",
    ),
}

NODE: Mapping[str, Key] = {
    "use": Key(Form.NODE_NAME, "A node, or a graph file."),
    "in": Key(Form.WIRING, "What feeds the node: a reference for its first port, or a mapping."),
    "with": Key(Form.SETTINGS, "Settings by name; $name stands for an input or an axis."),
    "alternatives": Key(
        Form.ALTERNATIVES,
        "Label -> {use, in, with}; a list of nodes; or a family, family.*. They are an axis.",
    ),
    "over": Key(Form.AXIS_NAMES, "The axes to gather, for a node that gathers."),
}
METHOD: Mapping[str, Key] = {key: NODE[key] for key in ("use", "in", "with")}
FAMILY: Mapping[str, Key] = {key: NODE[key] for key in ("in", "with")}

FIXED_REFERENCE: Mapping[str, Key] = {
    "from": Key(Form.SOURCE, "node, or node.port."),
    "at": Key(Form.LABELS, "Axes that are fixed: {axis: label}; $first is an axis's first label."),
}

REPORT_ENTRY: Mapping[str, Key] = {
    "show": FIXED_REFERENCE["from"],
    "at": FIXED_REFERENCE["at"],
    "title": Key(Form.TEXT, "The heading. Default: the value's own title."),
    "caption": Key(Form.TEXT, "The text beside its number: Table 1. Default: the value's own."),
    "notes": Key(Form.TEXT, "Markdown beside its cards, its figure or its table."),
    "answer": Key(
        Form.TEXT,
        "Its answer in your words, in which {best}, {tied}, {behind}, {better}, {worse}, {number},"
        " {interval}, {difference METHOD to METHOD}, {count best METHOD} and {scope} are filled in;"
        " {best METHOD} and {best at AXIS=LABEL} say of which method and group. Default: the"
        " value's own.",
    ),
}
