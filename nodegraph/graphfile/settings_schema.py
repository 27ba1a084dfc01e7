"""The JSON Schema of a setting: its type and bounds, or a variable, with its documentation.

It never refuses what the loader accepts: where a type accepts more than these keywords express, it
allows anything.
"""

from __future__ import annotations

import json
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from nodegraph.graphfile.keys import IDENTIFIER
from nodegraph.node.decorator import Node
from nodegraph.node.description import meanings, setting_kind, value_text

Schema = dict[str, Any]

VARIABLE = rf"^\${IDENTIFIER}(\.{IDENTIFIER})?$"
_TYPES = {"integer", "number", "boolean", "string", "null", "array"}
_OPEN_TYPES = {"function-before", "function-wrap", "function-plain", "generator"}
_KEYWORDS = {
    "type", "minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum", "minLength", "maxLength",
    "minItems",
}  # fmt: skip


class _Accepted(GenerateJsonSchema):
    """The schema of a strict model; any value for types that accept more than their schema says."""

    def generate_inner(self, schema: Any) -> Schema:
        is_open = schema["type"] in _OPEN_TYPES or schema.get("strict") is False
        return {} if is_open and "ref" not in schema else super().generate_inner(schema)

    def handle_invalid_for_json_schema(self, schema: Any, error_info: str) -> Schema:
        return {}


def settings_schema(node: Node) -> dict[str, Schema]:
    """Return the schema of each setting of a node."""
    if not node.settings:
        return {}
    schema = node.model.model_json_schema(schema_generator=_Accepted)
    return {name: _setting(node, name, part) for name, part in schema["properties"].items()}


def _setting(node: Node, name: str, accepted: Schema) -> Schema:
    setting = node.settings[name]
    default = "Required." if setting.required else f"Default: {value_text(setting.default)}."
    kind = setting_kind(node, name) + (f", in {setting.unit}" if setting.unit else "")
    deprecation = f"Deprecated: {setting.deprecated}." if setting.deprecated else ""
    parts = (deprecation, meanings(node).get(name, ""), f"{kind[:1].upper()}{kind[1:]}.", default)
    description: Schema = {"description": " ".join(part for part in parts if part)}
    if deprecation:
        description["deprecated"] = True
    if "default" in accepted and _is_json(accepted["default"]):
        description["default"] = accepted["default"]
    return {**description, **_or_variable(accepted)}


def _or_variable(schema: Schema) -> Schema:
    """Return a schema that accepts as much as another, and variables for values."""
    options = [_plain(option) for option in schema.get("anyOf", [schema])]
    if {} in options:
        return {}
    types = [option.get("type", "string") for option in options]
    if "string" in types or len(set(types)) < len(types):
        return {"anyOf": [*options, {"$ref": "#/$defs/variable"}]}
    # keywords judge values of their own type only, and a message on one schema is short
    merged = {key: value for option in options for key, value in option.items()}
    return {**merged, "type": [*types, "string"], "pattern": VARIABLE}


def _plain(option: Schema) -> Schema:
    """Return one alternative as far as it can be expressed; empty for any value."""
    words = option.get("enum", [option["const"]] if "const" in option else [])
    if words:
        return {"enum": words} if all(isinstance(word, str) for word in words) else {}
    if option.get("type") not in _TYPES or option.get("format", "path") != "path":
        return {}
    if option["type"] == "object" or "prefixItems" in option:
        return {}
    kept = {key: value for key, value in option.items() if key in _KEYWORDS and _is_json(value)}
    return {**kept, "items": _or_variable(option["items"])} if "items" in option else kept


def _is_json(value: object) -> bool:
    try:
        json.dumps(value, allow_nan=False)
    except (TypeError, ValueError):
        return False
    return True
