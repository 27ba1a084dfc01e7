"""The whole schema: what stands where in a graph file."""

from __future__ import annotations

from nodegraph.registry import Registry
from nodegraph.schema.alternatives import (
    PASS,
    alternatives_parts,
    alternatives_schema,
    shared_checks,
)
from nodegraph.schema.nodes import Usable, usable
from nodegraph.schema.parts import NAME, Schema, one_of, ref, shared_parts

_FILE = r"\.ya?ml$"


def graph_schema(registry: Registry) -> Schema:
    """Return the JSON Schema of graph files that use the nodes of a registry."""
    nodes = usable(registry)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "description": "A graph of nodes with alternatives side by side.",
        "type": "object",
        "required": ["nodegraph", "nodes"],
        "properties": _sections(),
        "additionalProperties": False,
        "$defs": {
            **shared_parts(),
            "node name": {"oneOf": _names(nodes)},
            "method name": {"anyOf": [ref("node name"), {"const": PASS}]},
            "node": _node(nodes),
            **alternatives_parts(nodes),
            **{key: one for each in nodes for key, one in each.definitions.items()},
        },
    }


def _sections() -> Schema:
    text = ["string", "number", "boolean", "null"]
    return {
        "nodegraph": {"description": "The format's number.", "const": 1},
        "title": {"description": "What the report is called.", "type": text},
        "notes": {"description": "Markdown that the report shows.", "type": text},
        "inputs": _named(
            "One value each, $name in settings; --set NAME=VALUE. In a graph that is used as a"
            " node, the name of a type makes a port.",
            True,
        ),
        "axes": _named(
            "A list, labels with values, {count: n} or {range: [first, last, step]}. A node runs"
            " once for each label of the axes that reach it.",
            ref("axis"),
        ),
        "nodes": {
            **_named("What is done, by name.", ref("node")),
            "type": "object",
            "minProperties": 1,
        },
        "skip": {
            "description": "Combinations to leave out: [{axis: label or labels}].",
            "type": ["array", "null"],
            "items": {
                "type": "object",
                "minProperties": 1,
                "additionalProperties": {
                    "anyOf": [ref("label"), {"type": "array", "items": ref("label")}]
                },
            },
        },
        "known": {"description": "Nodes or ports that a method may know.", **ref("references")},
        "requires": {
            "description": "Distributions that must be installed, as pip names them.",
            "type": ["array", "null"],
            "items": {"type": "string"},
        },
        "outputs": {
            "description": "What a graph gives when it is used as a node: name -> reference.",
            "type": ["object", "null"],
            "propertyNames": NAME,
            "additionalProperties": ref("reference"),
        },
        "report": {"description": "What the report shows.", **ref("references")},
    }


def _named(text: str, each: Schema | bool) -> Schema:
    return {
        "description": text,
        "type": ["object", "null"],
        "propertyNames": NAME,
        "additionalProperties": each,
    }


def _names(nodes: list[Usable]) -> list[Schema]:
    """Return a constant for each node, so that an editor shows its text beside it.

    A graph file is named as well, and so is a node with its plugin; an editor need not offer
    these.
    """
    full = [name for one in nodes for name in one.names[1:]]
    patterns = [_FILE, *([one_of(full)["pattern"]] if full else [])]
    message = "no installed node has this name; nodegraph nodes lists them"
    others = {"type": "string", "pattern": "|".join(patterns), "patternErrorMessage": message}
    return [*(one.constant() for one in nodes), others]


def _node(nodes: list[Usable]) -> Schema:
    """Return the schema of one node.

    Chains of if/then rather than oneOf: a wrong setting is then named by itself, by validators
    and editors alike, and editors complete what stands in the branch that ``use`` has chosen.
    """
    return {
        "type": "object",
        "properties": {
            "use": {"description": "A node, or a graph file.", **ref("node name")},
            "in": ref("wiring"),
            "with": ref("settings"),
            "alternatives": alternatives_schema(nodes),
            "over": {
                "description": "The axes to gather, for a node that gathers.",
                "type": "array",
                "items": {"type": "string"},
            },
        },
        "additionalProperties": False,
        "if": {"required": ["alternatives"]},
        "then": {"allOf": [{"properties": {"use": False}}, *shared_checks(nodes)]},
        "else": {"allOf": [{"required": ["use"]}, *map(_plain, nodes)]},
    }


def _plain(one: Usable) -> Schema:
    return one.when_used({"allOf": [ref(one.key), one.alone()]})
