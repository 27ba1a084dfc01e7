"""The JSON Schema of a node's settings: what the loader accepts, and variables for any value.

It never refuses what the loader accepts. Where a type accepts more than JSON Schema can express,
it allows anything.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

from pydantic import PydanticUserError
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue

from nodegraph.graphfile.definitions import VARIABLE, Schema, ref
from nodegraph.node.decorator import Node
from nodegraph.node.description import meanings, setting_kind, value_text

_KEYWORDS = {
    "type", "enum", "const", "minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum",
    "minLength", "maxLength", "minItems", "maxItems", "required", "additionalProperties",
    "minProperties", "maxProperties",
}  # fmt: skip
"""Keys of pydantic's schema that are kept unchanged."""

_EXACT_TYPES = {
    "any", "none", "bool", "int", "float", "str", "literal", "enum", "list", "set", "frozenset",
    "tuple", "dict", "nullable", "union", "tagged-union", "default", "function-after",
    "lax-or-strict", "json-or-python", "definitions", "definition-ref", "model", "model-fields",
    "model-field", "dataclass", "dataclass-args", "dataclass-field", "typed-dict",
    "typed-dict-field",
}  # fmt: skip
"""Pydantic's types whose schema accepts all that the type accepts."""

_NUMBERS = {"integer", "number"}
# what the dialects of Rust, ECMAScript and Python read alike: no classes such as \d, no flags, no
# sets within sets
_PORTABLE = re.compile(
    r"(?!.*(?:\[[^\]]*\[|&&|--|~~))(?:\\[\\^$.*+?()\[\]{}|/]|\(\?:|\((?!\?)|[^\\(])*", re.DOTALL
)


def settings_schema(node: Node, prefix: str) -> tuple[dict[str, Schema], dict[str, Schema]]:
    """Return the schema of each setting, with its description, and the definitions it refers to.

    The names of the definitions begin with the prefix.
    """
    accepted, definitions = _accepted(node, prefix)
    settings = {
        name: {**_description(node, name, schema), **or_variable(schema)}
        for name, schema in accepted.items()
    }
    return settings, {name: or_variable(schema) for name, schema in definitions.items()}


def or_variable(schema: Schema) -> Schema:
    """Return a schema that accepts as much as another, and variables for values at any depth."""
    if "$ref" in schema:
        return {"$ref": schema["$ref"]}
    options = [_loosened(option) for option in _options(schema)]
    if {} in options:
        return {}
    merged, rest = _merged([option for option in options if "$ref" not in option])
    rest += [option for option in options if "$ref" in option]
    if not merged:
        rest.append(ref("variable"))
    alternatives = [*([merged] if merged else []), *rest]
    return alternatives[0] if len(alternatives) == 1 else {"anyOf": alternatives}


class _Accepted(GenerateJsonSchema):
    """The schema of a strict model; any value for types that accept more than their schema says."""

    ignored_warning_kinds = {"skipped-choice", "non-serializable-default"}  # noqa: RUF012

    def build_schema_type_to_method(self) -> Any:
        methods = super().build_schema_type_to_method()
        return {
            kind: method if kind in _EXACT_TYPES else _anything for kind, method in methods.items()
        }

    def generate_inner(self, schema: Any) -> JsonSchemaValue:
        if schema.get("strict") is False and "ref" not in schema:
            return {}
        return super().generate_inner(schema)

    def model_schema(self, schema: Any) -> JsonSchemaValue:
        return super().model_schema(schema) if _is_strict(schema) else {}

    def dataclass_schema(self, schema: Any) -> JsonSchemaValue:
        if not _is_strict(schema):
            return {}
        accepted = super().dataclass_schema(schema)
        if schema.get("config", {}).get("extra_fields_behavior", "forbid") == "forbid":
            accepted.setdefault("additionalProperties", False)  # pydantic says so from 2.14 on
        return accepted

    def typed_dict_schema(self, schema: Any) -> JsonSchemaValue:
        return super().typed_dict_schema(schema) if _is_strict(schema) else {}


def _accepted(node: Node, prefix: str) -> tuple[dict[str, Schema], dict[str, Schema]]:
    template = f"#/$defs/{prefix}:{{model}}"
    try:
        schema = node.model.model_json_schema(ref_template=template, schema_generator=_Accepted)
    except PydanticUserError:  # the loader reports what is wrong with the node
        return {name: {} for name in node.settings}, {}
    definitions = {f"{prefix}:{name}": part for name, part in schema.get("$defs", {}).items()}
    return schema.get("properties", {}), definitions


def _is_strict(schema: Any) -> bool:
    config = schema.get("config")
    return config is None or bool(config.get("strict"))


def _anything(schema: object) -> JsonSchemaValue:
    return {}


def _description(node: Node, name: str, accepted: Schema) -> Schema:
    setting = node.settings[name]
    default = "Required." if setting.required else f"Default: {value_text(setting.default)}."
    kind = _kind(node, name) + (f", in {setting.unit}" if setting.unit else "")
    deprecation = f"Deprecated: {setting.deprecated}." if setting.deprecated else ""
    meaning = meanings(node).get(name, "")
    parts = (deprecation, meaning, f"{kind[:1].upper()}{kind[1:]}.", default)
    description: Schema = {"description": " ".join(part for part in parts if part)}
    if deprecation:
        description["deprecated"] = True
    if not setting.required and "default" in accepted and _is_json(accepted["default"]):
        description["default"] = accepted["default"]
    return description


def _kind(node: Node, name: str) -> str:
    try:
        return setting_kind(node, name)
    except PydanticUserError:
        return "a value"


def _options(schema: Schema) -> Iterator[Schema]:
    """Yield the alternatives of a schema, those within alternatives too."""
    for key in ("anyOf", "oneOf", "allOf"):
        if key in schema:
            for option in schema[key]:
                yield from _options(option)
            return
    yield schema


def _loosened(schema: Schema) -> Schema:
    """Return one alternative without inexact keywords, its parts open to variables."""
    if "$ref" in schema:
        return {"$ref": schema["$ref"]}
    if schema.get("format", "path") != "path" or not schema.keys() & {"type", "enum", "const"}:
        return {}
    loose = {key: value for key, value in schema.items() if key in _KEYWORDS and _is_json(value)}
    if "const" in loose:
        loose["enum"] = [loose.pop("const")]
    if "enum" in loose:
        return {"enum": [*loose["enum"], *_equal_to(loose["enum"])]}
    if "patternProperties" in schema:
        loose.pop("additionalProperties", None)
    if "uniqueItems" in schema:  # a set, which may be written as a list that repeats values
        loose.pop("maxItems", None)
    if _PORTABLE.fullmatch(schema.get("pattern", "(?")):
        loose["pattern"] = schema["pattern"]
    return {**loose, **_loosened_parts(schema, loose)}


def _loosened_parts(schema: Schema, loose: Schema) -> Schema:
    parts: Schema = {}
    if isinstance(schema.get("items"), dict):
        parts["items"] = or_variable(schema["items"])
    if "prefixItems" in schema:
        parts["prefixItems"] = [or_variable(item) for item in schema["prefixItems"]]
    if "properties" in schema:
        parts["properties"] = {
            name: or_variable(part) for name, part in schema["properties"].items()
        }
    if isinstance(loose.get("additionalProperties"), dict):
        parts["additionalProperties"] = or_variable(loose["additionalProperties"])
    return parts


def _equal_to(choices: list[object]) -> list[object]:
    """Return booleans and numbers that pydantic takes for one of the choices."""
    listed = {(type(choice), choice) for choice in choices}
    return [
        value
        for value in (True, False, 1, 0)
        if value in choices and (type(value), value) not in listed
    ]


def _merged(options: list[Schema]) -> tuple[Schema, list[Schema]]:
    """Return as many alternatives as fit into one schema, a variable among them, and the rest.

    Keywords judge values of their own type only, so that alternatives of different types go
    into one schema, for which an editor's message on a wrong value is short.
    """
    merged: Schema = {}
    types: list[str] = []
    rest = []
    for option in options:
        kind = option.get("type")
        is_second_number = kind in _NUMBERS and not _NUMBERS.isdisjoint(types)
        is_bound_text = kind == "string" and len(option) > 1
        if not isinstance(kind, str) or kind in types or is_second_number or is_bound_text:
            rest.append(option)
        else:
            types.append(kind)
            merged.update(option)
    if types and "string" not in types:
        types.append("string")
        merged["pattern"] = VARIABLE
    if types:
        merged["type"] = types if len(types) > 1 else types[0]
    return merged, rest


def _is_json(value: object) -> bool:
    try:
        json.dumps(value, allow_nan=False)
    except (TypeError, ValueError):
        return False
    return True
