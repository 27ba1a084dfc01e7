"""Settings of a node, as its pydantic model takes them from a graph file -> their JSON Schema.

A schema says less than a model: a validator may take what the type's schema does not show, a
model of one's own may convert, patterns have dialects. Wherever what is accepted cannot be told,
anything is; the loader then judges. A variable may stand for a value, and for any part of it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

from pydantic import PydanticUserError
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue

from nodegraph.describe import port_meanings, setting_kind, shown
from nodegraph.node import Node
from nodegraph.schema.parts import VARIABLE, Schema, ref

_KEPT = {
    "type", "enum", "const", "minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum",
    "minLength", "maxLength", "minItems", "maxItems", "required", "additionalProperties",
    "minProperties", "maxProperties",
}  # fmt: skip
_TOLD = {
    "any", "none", "bool", "int", "float", "str", "literal", "enum", "list", "set", "frozenset",
    "tuple", "dict", "nullable", "union", "tagged-union", "default", "function-after",
    "lax-or-strict", "json-or-python", "definitions", "definition-ref", "model", "model-fields",
    "model-field", "dataclass", "dataclass-args", "dataclass-field", "typed-dict",
    "typed-dict-field",
}  # fmt: skip
_NUMBERS = {"integer", "number"}
# what the dialects of Rust, ECMAScript and Python read alike: no classes such as \d, no flags, no
# sets within sets
_PORTABLE = re.compile(
    r"(?!.*(?:\[[^\]]*\[|&&|--|~~))(?:\\[\\^$.*+?()\[\]{}|/]|\(\?:|\((?!\?)|[^\\(])*", re.DOTALL
)


def settings_schema(node: Node, prefix: str) -> tuple[dict[str, Schema], dict[str, Schema]]:
    """Return the schema of each setting, with its text, and the definitions they refer to.

    Names of definitions begin with the prefix.
    """
    given, definitions = _accepted(node, prefix)
    settings = {
        name: {**_texts(node, name, one), **or_variable(one)} for name, one in given.items()
    }
    return settings, {name: or_variable(one) for name, one in definitions.items()}


def or_variable(schema: Schema) -> Schema:
    """Return a schema that accepts as much as this one, and variables for values at any depth."""
    if "$ref" in schema:
        return {"$ref": schema["$ref"]}
    options = [_loosened(one) for one in _options(schema)]
    if {} in options:
        return {}
    merged, others = _merged([one for one in options if "$ref" not in one])
    others += [one for one in options if "$ref" in one]
    if not merged:
        others.append(ref("variable"))
    found = [*([merged] if merged else []), *others]
    return found[0] if len(found) == 1 else {"anyOf": found}


class _Accepted(GenerateJsonSchema):
    """What a strict model takes; of types that take more than their schema says, anything."""

    ignored_warning_kinds = {"skipped-choice", "non-serializable-default"}  # noqa: RUF012

    def build_schema_type_to_method(self) -> Any:
        found = super().build_schema_type_to_method()
        return {kind: one if kind in _TOLD else _anything for kind, one in found.items()}

    def generate_inner(self, schema: Any) -> JsonSchemaValue:
        if schema.get("strict") is False and "ref" not in schema:
            return {}
        return super().generate_inner(schema)

    def model_schema(self, schema: Any) -> JsonSchemaValue:
        return super().model_schema(schema) if _is_strict(schema) else {}

    def dataclass_schema(self, schema: Any) -> JsonSchemaValue:
        return super().dataclass_schema(schema) if _is_strict(schema) else {}

    def typed_dict_schema(self, schema: Any) -> JsonSchemaValue:
        return super().typed_dict_schema(schema) if _is_strict(schema) else {}


def _accepted(node: Node, prefix: str) -> tuple[dict[str, Schema], dict[str, Schema]]:
    template = f"#/$defs/{prefix}:{{model}}"
    try:
        made = node.model.model_json_schema(ref_template=template, schema_generator=_Accepted)
    except PydanticUserError:  # the loader says what is wrong with the node
        return {name: {} for name in node.settings}, {}
    named = {f"{prefix}:{name}": one for name, one in made.get("$defs", {}).items()}
    return made.get("properties", {}), named


def _is_strict(schema: Any) -> bool:
    config = schema.get("config")
    return config is None or bool(config.get("strict"))


def _anything(schema: Any) -> JsonSchemaValue:
    return {}


def _texts(node: Node, name: str, accepted: Schema) -> Schema:
    setting = node.settings[name]
    default = "Required." if setting.required else f"Default: {shown(setting.default)}."
    kind = _kind(node, name) + (f", in {setting.unit}" if setting.unit else "")
    instead = f"Deprecated: {setting.deprecated}." if setting.deprecated else ""
    meaning = port_meanings(node).get(name, "")
    parts = (instead, meaning, f"{kind[:1].upper()}{kind[1:]}.", default)
    found: Schema = {"description": " ".join(part for part in parts if part)}
    if instead:
        found["deprecated"] = True
    if not setting.required and "default" in accepted and _is_json(accepted["default"]):
        found["default"] = accepted["default"]
    return found


def _kind(node: Node, name: str) -> str:
    try:
        return setting_kind(node, name)
    except PydanticUserError:
        return "a value"


def _options(schema: Schema) -> Iterator[Schema]:
    """Yield the alternatives of a schema, those within alternatives too."""
    for key in ("anyOf", "oneOf", "allOf"):
        if key in schema:
            for one in schema[key]:
                yield from _options(one)
            return
    yield schema


def _loosened(schema: Schema) -> Schema:
    """Return one alternative without what cannot be told, its parts open to variables."""
    if "$ref" in schema:
        return {"$ref": schema["$ref"]}
    if schema.get("format", "path") != "path" or not schema.keys() & {"type", "enum", "const"}:
        return {}
    found = {key: one for key, one in schema.items() if key in _KEPT and _is_json(one)}
    if "const" in found:
        found["enum"] = [found.pop("const")]
    if "enum" in found:
        return {"enum": [*found["enum"], *_equal_to(found["enum"])]}
    if "patternProperties" in schema:
        found.pop("additionalProperties", None)
    if "uniqueItems" in schema:  # a set, into which a list may go that repeats values
        found.pop("maxItems", None)
    if _PORTABLE.fullmatch(schema.get("pattern", "(?")):
        found["pattern"] = schema["pattern"]
    return {**found, **_parts(schema, found)}


def _parts(schema: Schema, found: Schema) -> Schema:
    parts: Schema = {}
    if isinstance(schema.get("items"), dict):
        parts["items"] = or_variable(schema["items"])
    if "prefixItems" in schema:
        parts["prefixItems"] = [or_variable(one) for one in schema["prefixItems"]]
    if "properties" in schema:
        parts["properties"] = {k: or_variable(one) for k, one in schema["properties"].items()}
    if isinstance(found.get("additionalProperties"), dict):
        parts["additionalProperties"] = or_variable(found["additionalProperties"])
    return parts


def _equal_to(choices: list[Any]) -> list[Any]:
    """Return booleans and numbers that pydantic takes for one of the choices."""
    there = {(type(one), one) for one in choices}
    return [one for one in (True, False, 1, 0) if one in choices and (type(one), one) not in there]


def _merged(options: list[Schema]) -> tuple[Schema, list[Schema]]:
    """Return as many alternatives as can be said in one, a variable among them, and the others.

    Keywords judge values of their own type only, so that alternatives of different types go
    into one schema; what an editor says of a wrong value is then short.
    """
    merged: Schema = {}
    types: list[str] = []
    others = []
    for one in options:
        kind = one.get("type")
        numbers = kind in _NUMBERS and not _NUMBERS.isdisjoint(types)
        bound_text = kind == "string" and len(one) > 1
        if not isinstance(kind, str) or kind in types or numbers or bound_text:
            others.append(one)
        else:
            types.append(kind)
            merged.update(one)
    if types and "string" not in types:
        types.append("string")
        merged["pattern"] = VARIABLE
    if types:
        merged["type"] = types if len(types) > 1 else types[0]
    return merged, others


def _is_json(value: Any) -> bool:
    try:
        json.dumps(value, allow_nan=False)
    except (TypeError, ValueError):
        return False
    return True
