"""The JSON Schema of graph files that use the installed nodes, for editors and other programs."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from nodegraph.graphfile.definitions import (
    NAME,
    TEXT,
    Schema,
    fixed_or,
    one_of,
    properties,
    ref,
    shared_definitions,
)
from nodegraph.graphfile.keys import FAMILY, FORMAT, METHOD, NODE, PASS, TOP_LEVEL, Form
from nodegraph.graphfile.node_schema import NodeSchema, node_schemas
from nodegraph.plugin.registry import Registry

_GRAPH_FILE = r"\.ya?ml$"
_FAMILY_NAME = r"\.\*$"
_NO_SETTING: Schema = {"properties": {"with": {"maxProperties": 0}}}
_NEEDS_USE: Schema = {"required": ["use"]}


def graph_schema(registry: Registry) -> Schema:
    """Return the JSON Schema of graph files that use the nodes of a registry."""
    nodes = node_schemas(registry)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "description": "A graph of nodes with alternatives side by side.",
        "type": "object",
        "required": ["nodegraph", "nodes"],
        "properties": properties(TOP_LEVEL, _top_level_forms()),
        "additionalProperties": False,
        "$defs": {
            **shared_definitions(),
            "node name": {"oneOf": _names(nodes, registry)},
            "method name": {"anyOf": [ref("node name"), {"const": PASS}]},
            "node": _node(nodes),
            **_methods(nodes),
            **{f"whole {family}": _whole(family, nodes) for family in _families(nodes)},
            **{
                f"own {setting}": _own(setting)
                for setting in sorted({name for node in nodes for name in node.settings})
            },
            **{key: part for node in nodes for key, part in node.definitions.items()},
        },
    }


def _top_level_forms() -> dict[Form, Schema]:
    combination = {
        "type": "object",
        "minProperties": 1,
        "additionalProperties": {"anyOf": [ref("label"), {"type": "array", "items": ref("label")}]},
    }
    return {
        Form.NUMBER: {"const": FORMAT},
        Form.TEXT: TEXT,
        Form.INPUTS: _named(True),
        Form.AXES: _named(ref("axis")),
        Form.NODES: {**_named(ref("node")), "type": "object", "minProperties": 1},
        Form.COMBINATIONS: {"type": ["array", "null"], "items": combination},
        Form.REFERENCES: ref("references"),
        Form.REPORT: ref("report"),
        Form.DISTRIBUTIONS: {"type": ["array", "null"], "items": {"type": "string"}},
        Form.OUTPUTS: _named(ref("reference")),
    }


def _named(each: Schema | bool) -> Schema:
    return {"type": ["object", "null"], "propertyNames": NAME, "additionalProperties": each}


def _names(nodes: list[NodeSchema], registry: Registry) -> list[Schema]:
    """Return a constant for each node, so that an editor shows its description beside it.

    A graph file is allowed as well, and so is a node with its plugin or with a scheme; an editor
    need not offer these.
    """
    full_names = [name for node in nodes for name in node.names[1:]]
    patterns = [_GRAPH_FILE, *([one_of(full_names)["pattern"]] if full_names else [])]
    patterns += [f"^{re.escape(scheme)}:." for scheme in registry.hooks.node_finders]
    message = "no installed node has this name; nodegraph show lists them"
    rest = {"type": "string", "pattern": "|".join(patterns), "patternErrorMessage": message}
    return [*(node.constant() for node in nodes), rest]


def _node(nodes: list[NodeSchema]) -> Schema:
    """Return the schema of one node.

    Chains of if/then rather than oneOf: validators and editors then name the wrong setting alone,
    and editors complete what belongs to the branch that ``use`` selects.
    """
    forms: dict[Form, Schema] = {
        Form.NODE_NAME: ref("node name"),
        Form.WIRING: ref("wiring"),
        Form.SETTINGS: ref("settings"),
        Form.ALTERNATIVES: _alternatives(nodes),
        Form.AXIS_NAMES: {"type": "array", "items": {"type": "string"}},
    }
    single = [node.when_used({"allOf": [ref(node.key), node.alone()]}) for node in nodes]
    return {
        "type": "object",
        "properties": properties(NODE, forms),
        "additionalProperties": False,
        "if": {"required": ["alternatives"]},
        "then": {"allOf": [{"properties": {"use": False}}, *_shared(nodes)]},
        "else": {"allOf": [_NEEDS_USE, *single]},
    }


def _alternatives(nodes: Iterable[NodeSchema]) -> Schema:
    """Return the schema of ``alternatives``: a family, a list, or labels."""
    families = _families(nodes)
    family = {"type": "string", "enum": families}
    listed = {
        "type": "array",
        "minItems": 1,
        "items": {"anyOf": [ref("method name"), family]},
        "contains": {"not": {"const": PASS}},
    }
    labels = {
        "type": "object",
        "minProperties": 1,
        "propertyNames": {"if": {"pattern": _FAMILY_NAME}, "then": {"enum": families}},
        "properties": {PASS: ref(PASS), **{name: ref("family") for name in families}},
        "additionalProperties": ref("method"),
    }
    return {"anyOf": [family, listed, labels]}


def _families(nodes: Iterable[NodeSchema]) -> list[str]:
    return sorted({node.family for node in nodes if not node.node.deprecated})


def _methods(nodes: Iterable[NodeSchema]) -> dict[str, Schema]:
    """Return the definitions of what stands at a label among alternatives."""
    forms: dict[Form, Schema] = {
        Form.NODE_NAME: ref("method name"),
        Form.WIRING: ref("wiring"),
        Form.SETTINGS: ref("settings"),
    }
    uses_pass = {**_NEEDS_USE, "properties": {"use": {"const": PASS}}}
    method = {
        "type": "object",
        "properties": properties(METHOD, forms),
        "additionalProperties": False,
        "allOf": [
            *(node.when_used(ref(node.key)) for node in nodes),
            {"if": uses_pass, "then": _NO_SETTING},
        ],
    }
    pass_alone = {"if": _NEEDS_USE, "else": _NO_SETTING}
    return {
        "method of": method,
        "method": {"anyOf": [ref("method name"), {"allOf": [ref("method of"), _NEEDS_USE]}]},
        PASS: {
            "description": "The input as it is, named as the output of its siblings.",
            "anyOf": [
                {"type": "null"},
                ref("method name"),
                {"allOf": [ref("method of"), pass_alone]},
            ],
        },
        "family": {
            "description": "Every installed method of the family.",
            "type": ["object", "null"],
            "properties": properties(FAMILY, forms),
            "additionalProperties": False,
        },
    }


def _whole(family: str, nodes: Iterable[NodeSchema]) -> Schema:
    """Match alternatives that take a whole family.

    Another family next to it may replace some of its methods, and so may a node of another family
    in a list; this does not match such alternatives.
    """
    names = [name for node in nodes if node.family == family for name in node.names]
    alone = {"anyOf": [{"const": family}, {"not": {"pattern": _FAMILY_NAME}}]}
    listed = {"contains": {"const": family}, "items": one_of([family, PASS, *names])}
    return {
        "anyOf": [
            {"const": family},
            {"type": "array", **listed},
            {"type": "object", "required": [family], "propertyNames": alone},
        ]
    }


def _own(setting: str) -> Schema:
    """Match alternatives of which at least one has its own value of this setting."""
    has_setting = {"type": "object", "required": [setting]}
    method = {"type": "object", "required": ["with"], "properties": {"with": has_setting}}
    return {"type": "object", "not": {"additionalProperties": {"not": method}}}


def _shared(nodes: Iterable[NodeSchema]) -> Iterator[Schema]:
    """Yield what ``in`` and ``with`` of a node must be, depending on its alternatives."""
    for node in nodes:
        parts = {"in": _shared_ports(node), "with": _only(node.settings)}
        values = [_shared_value(node, setting) for setting in node.settings]
        yield _when(_some_use(node), {"properties": parts, **({"allOf": values} if values else {})})
        if not node.node.deprecated:  # a family leaves it out
            own = {"properties": {node.family: ref(node.key)}}
            family = {"type": "object", **_in_family(node)}
            yield _when(family, {"properties": {"alternatives": own}})


def _some_use(node: NodeSchema) -> Schema:
    """Match alternatives of which at least one uses this node."""
    used = {"required": ["use"], "properties": {"use": node.named}}
    labelled = {**node.named, "type": ["string", "object"], **used}
    forms: list[Schema] = [
        {"type": "array", "contains": node.named},
        {"type": "object", "not": {"additionalProperties": {"not": labelled}}},
    ]
    return {"anyOf": forms if node.node.deprecated else [*forms, _in_family(node)]}


def _in_family(node: NodeSchema) -> Schema:
    """Match alternatives that take this node as one of its family."""
    replaced = {"type": "object", "required": [node.label]}
    return {**ref(f"whole {node.family}"), "not": replaced}


def _when(alternatives: Schema, then: Schema) -> Schema:
    return {"if": {"properties": {"alternatives": alternatives}}, "then": then}


def _only(names: Iterable[str]) -> Schema:
    return {"properties": dict.fromkeys(names, True), "additionalProperties": False}


def _shared_ports(node: NodeSchema) -> Schema:
    if not node.node.inputs:
        return {"type": ["object", "null"], "maxProperties": 0}
    return fixed_or(_only(port.name for port in node.node.inputs))


def _shared_value(node: NodeSchema, setting: str) -> Schema:
    """Return what a shared setting must be where no alternative has its own value of it."""
    value = ref(f"{node.key}/properties/with/properties/{setting}")
    settings: Schema = {"properties": {setting: value}}
    then: Schema = {"properties": {"with": settings}}
    if node.node.settings[setting].required:
        settings.update(type="object", required=[setting])
        then["required"] = ["with"]
    return {"if": {"properties": {"alternatives": ref(f"own {setting}")}}, "else": then}
