"""The JSON Schema of graph files that use the installed nodes, for editors and other programs.

An editor completes and explains what may stand at each place, and marks words that can stand
nowhere. What depends on several places, such as the settings that alternatives share, is left to
`nodegraph check`: the schema never refuses what the loader accepts.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any
from urllib.parse import quote

from nodegraph.graphfile.keys import (
    FIXED_REFERENCE,
    FORMAT,
    IDENTIFIER,
    IDENTIFIER_HINT,
    METHOD,
    MOST_LABELS,
    NODE,
    PASS,
    REFERENCE,
    REFERENCE_HINT,
    REPORT_ENTRY,
    TOP_LEVEL,
    Form,
    Key,
)
from nodegraph.graphfile.settings_schema import VARIABLE, Schema, settings_schema
from nodegraph.node.decorator import Node
from nodegraph.node.description import describe_declaration, meanings
from nodegraph.node.ports import Port
from nodegraph.plugin.registry import Registered, Registry

_TEXT: Schema = {"type": ["string", "number", "boolean", "null"]}
_WORD: Schema = {"pattern": f"^{REFERENCE}$", "patternErrorMessage": REFERENCE_HINT}
_REFERENCE: Schema = {"type": ["string", "object"], **_WORD}
_MAPPING: Schema = {"type": ["object", "null"]}


def graph_schema(registry: Registry) -> Schema:
    """Return the JSON Schema of graph files that use the nodes of a registry."""
    names = names_of(registry)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "description": "A graph of nodes with alternatives side by side.",
        "type": "object",
        "required": ["nodegraph", "nodes"],
        "properties": _properties(TOP_LEVEL),
        "additionalProperties": False,
        "$defs": {
            "variable": {
                "description": "The value of an input or an axis: $name, or $axis.field.",
                "type": "string",
                "pattern": VARIABLE,
                "patternErrorMessage": "$name or $axis.field stands for an input or an axis",
            },
            "label": {
                "description": "A label on an axis: a word, a number or a boolean.",
                "type": ["string", "number", "boolean"],
                "minLength": 1,
            },
            "reference": {**_REFERENCE, **_keys(FIXED_REFERENCE), "required": ["from"]},
            "axis": _axis(),
            "node name": _node_names(names, registry),
            "method name": {"anyOf": [_ref("node name"), {"const": PASS}]},
            "method": {"anyOf": [_ref("method name"), {**_MAPPING, **_keys(METHOD), **_NODES}]},
            "node": {
                "type": "object",
                **_keys(NODE),
                "oneOf": [{"required": ["use"]}, {"required": ["alternatives"]}],
                **_NODES,
            },
            "alternatives": _alternatives(
                {f"{node.node.family}.*" for node in names if not node.node.deprecated}
            ),
            "nodes": {
                "allOf": [{}, *(_when_used(known, node.node) for node, known in names.items())]
            },
        },
    }


def _ref(name: str) -> Schema:
    return {"$ref": f"#/$defs/{quote(name)}"}


_NODES: Schema = {"allOf": [_ref("nodes")]}
_FEEDS: Schema = {**_REFERENCE, "type": ["string", "object", "null"]}
_COMBINATION: Schema = {
    "type": "object",
    "minProperties": 1,
    "additionalProperties": {"anyOf": [_ref("label"), {"type": "array", "items": _ref("label")}]},
}


def _named(each: Schema | bool) -> Schema:
    names = {"pattern": f"^{IDENTIFIER}$", "patternErrorMessage": IDENTIFIER_HINT}
    return {**_MAPPING, "propertyNames": names, "additionalProperties": each}


def _listed(each: Schema) -> Schema:
    return {"type": ["array", "null"], "items": each}


def _keys(keys: Mapping[str, Key]) -> Schema:
    return {"properties": _properties(keys), "additionalProperties": False}


def _properties(keys: Mapping[str, Key]) -> Schema:
    """Return a schema for each key of a table: its meaning, and what stands there."""
    forms: dict[Form, Schema] = {
        Form.NUMBER: {"const": FORMAT},
        Form.TEXT: _TEXT,
        Form.INPUTS: _named(True),
        Form.AXES: _named(_ref("axis")),
        Form.NODES: {**_named(_ref("node")), "type": "object", "minProperties": 1},
        Form.COMBINATIONS: _listed(_COMBINATION),
        Form.REFERENCES: _listed(_ref("reference")),
        Form.DISTRIBUTIONS: _listed({"type": "string"}),
        Form.OUTPUTS: _named(_ref("reference")),
        Form.NODE_NAME: _ref("method name") if keys is METHOD else _ref("node name"),
        Form.WIRING: _FEEDS,
        Form.SETTINGS: _MAPPING,
        Form.ALTERNATIVES: _ref("alternatives"),
        Form.AXIS_NAMES: {"type": "array", "items": {"type": "string"}},
        Form.SOURCE: {**_WORD, "type": "string"},
        Form.LABELS: {"type": "object", "additionalProperties": _ref("label")},
    }
    if keys is TOP_LEVEL:
        entry = _properties(FIXED_REFERENCE) | _properties(REPORT_ENTRY)
        forms[Form.REPORT] = _listed(
            {**_REFERENCE, "properties": entry, "additionalProperties": False}
        )
    return {name: {"description": key.meaning, **forms[key.form]} for name, key in keys.items()}


def _alternatives(families: Iterable[str]) -> Schema:
    """Return the schema of ``alternatives``: a family, a list, or labels."""
    family = {"type": "string", "enum": sorted(families)}
    listed = {"anyOf": [_ref("method name"), family]}
    return {
        "anyOf": [
            family,
            {"type": "array", "minItems": 1, "items": listed},
            {"type": "object", "minProperties": 1, "additionalProperties": _ref("method")},
        ]
    }


def names_of(registry: Registry) -> dict[Registered, list[str]]:
    """Return the names under which graph files may call each node, the one to offer first.

    They are ``family.method`` where one plugin alone has it, and ``plugin:family.method``.
    """
    counts = Counter(name for node in registry for name in (node.node.name, node.full_name))
    names = {
        node: [name for name in (node.node.name, node.full_name) if counts[name] == 1]
        for node in registry
    }
    return {node: known for node, known in names.items() if known}


def _node_names(names: Mapping[Registered, Sequence[str]], registry: Registry) -> Schema:
    """Return a constant for each node, so that an editor shows its description beside it.

    A node with its plugin is allowed as well, and so are a graph file and a node of a scheme; an
    editor does not offer these.
    """
    schemes = registry.hooks.of("node_finders")
    patterns = [r"\.ya?ml$", *(f"^{re.escape(scheme)}:." for scheme in schemes)]
    patterns += [f"^{re.escape(name)}$" for _, *more in names.values() for name in more]
    message = "no installed node has this name; nodegraph show lists them"
    rest = {"type": "string", "pattern": "|".join(patterns), "patternErrorMessage": message}
    return {"oneOf": [*(_constant(first, node) for node, (first, *_) in names.items()), rest]}


def _constant(name: str, registered: Registered) -> Schema:
    description = "\n\n".join(about_node(registered))
    schema: Schema = {"const": name, "title": name, "description": description}
    return {**schema, "deprecated": True} if registered.node.deprecated else schema


def about_node(registered: Registered) -> list[str]:
    """Return what an editor says of a node, a paragraph each: summary, ports, where it is from."""
    node = registered.node
    lines = [node.summary or node.name]
    if node.deprecated:
        lines.append(f"Deprecated: {node.deprecated}.")
    if node.inputs:
        lines.append(f"In: {', '.join(map(str, node.inputs))}.")
    lines.append(f"Out: {', '.join(map(str, node.outputs))}.")
    if declared := "; ".join(describe_declaration(node)):
        lines.append(f"{declared[0].upper()}{declared[1:]}.")
    lines.append(f"Plugin: {registered.plugin}. Cite: {', '.join(node.cite) or 'nothing'}.")
    return lines


def _when_used(names: Sequence[str], node: Node) -> Schema:
    """Return what may stand beside the ``use`` of a node: its ports and settings."""
    documented = meanings(node)
    ports = {port.name: _port(port, documented.get(port.name, "")) for port in node.inputs}
    feeds = {**_FEEDS, "properties": {**_properties(FIXED_REFERENCE), **ports}}
    parts = {
        "in": {**feeds, "additionalProperties": False},
        "with": {**_MAPPING, "properties": settings_schema(node), "additionalProperties": False},
    }
    used = {"required": ["use"], "properties": {"use": {"enum": names}}}
    return {"if": used, "then": {"properties": parts}}


def _port(port: Port, meaning: str) -> Schema:
    form = _REFERENCE if port.across else _ref("reference")
    return {"title": str(port), **({"description": meaning} if meaning else {}), **form}


def _axis() -> Schema:
    count = {"type": "integer", "minimum": 1, "maximum": MOST_LABELS}
    numbers = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
    file = {"type": "string", "minLength": 1}
    generators: dict[str, tuple[str, Any, str]] = {
        "count": ("How many labels: 0, 1, ... count - 1.", count, "20"),
        "range": ("[first, last, step]", numbers, "[5, 60, 5]"),
        "files": (
            "A file per label: its name without the suffix, or the fields in {actor}_{take}.c3d.",
            file, '"data/*.csv"',
        ),
    }  # fmt: skip
    return {
        "type": ["array", "object"],
        "minItems": 1,
        "uniqueItems": True,
        "items": _ref("label"),
        "minProperties": 1,
        "propertyNames": {"minLength": 1},
        # a mapping of this one key is a generator; beside other keys it is a label like them
        "if": {"type": "object", "maxProperties": 1},
        "then": {
            "properties": {
                name: {"description": meaning, **form}
                for name, (meaning, form, _) in generators.items()
            }
        },
        "defaultSnippets": [
            {"label": "[5, 15, 45]", "description": "labels", "bodyText": "[${1:5, 15, 45}]"},
            *(
                {
                    "label": f"{{{name}: {example}}}",
                    "description": meaning,
                    "bodyText": f"{{{name}: ${{1:{example}}}}}",
                }
                for name, (meaning, _, example) in generators.items()
            ),
        ],
    }
