"""What one installed node takes: its ports, its settings, and what is said of it."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from pydantic import PydanticUserError
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue

from nodegraph.node.decorator import Node
from nodegraph.node.description import port_meanings, setting_kind, shown
from nodegraph.node.ports import Port
from nodegraph.plugin.registry import Registered, Registry

Schema = dict[str, Any]

VARIABLE = r"^\$[A-Za-z_]\w*(\.[A-Za-z_]\w*)?$"
_REFERENCE: Schema = {
    "type": ["string", "object"],
    "pattern": r"^\$?[A-Za-z_]\w*(\.[A-Za-z_]\w*)?$",
    "patternErrorMessage": "write node, node.port, or {from: node.port, at: {axis: label}}",
}

NAME: Schema = {
    "pattern": r"^[A-Za-z_]\w*$",
    "patternErrorMessage": "use letters, digits and _, not a digit first",
}


def ref(name: str) -> Schema:
    """Return a reference to one of the shared definitions."""
    return {"$ref": f"#/$defs/{name}"}


def one_of(words: Iterable[str]) -> Schema:
    """Return what holds for these words, as a pattern: editors show every enumeration they meet."""
    escaped = (re.sub(r"[\\^$.*+?()\[\]{}|]", r"\\\g<0>", word) for word in words)
    return {"type": "string", "pattern": f"^({'|'.join(escaped)})$"}


def fixed_or(otherwise: Schema) -> Schema:
    """Return a schema of a mapping that either fixes axes of one reference or is another."""
    fixes = {"type": "object", "required": ["from"]}
    return {"if": fixes, "then": ref("fixed"), "else": otherwise}


def shared_parts() -> dict[str, Schema]:
    """Return the definitions that other parts of the schema refer to."""
    return {
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
        "reference": {**_REFERENCE, "if": {"type": "object"}, "then": ref("fixed")},
        "fixed": {
            "properties": {
                "from": {"description": "node, or node.port.", **_REFERENCE, "type": "string"},
                "at": {
                    "description": "Axes that are fixed: {axis: label}.",
                    "type": "object",
                    "additionalProperties": ref("label"),
                },
            },
            "required": ["from"],
            "additionalProperties": False,
        },
        "feed": {
            **_REFERENCE,
            **fixed_or({"minProperties": 1, "additionalProperties": ref("reference")}),
        },
        "wiring": {
            **_REFERENCE,
            "description": "What feeds the node: a reference for its first port, or a mapping.",
            "type": ["string", "object", "null"],
            **fixed_or({"additionalProperties": ref("feed")}),
        },
        "references": {"type": ["array", "null"], "items": ref("reference")},
        "settings": {
            "description": "Settings by name; $name stands for an input or an axis.",
            "type": ["object", "null"],
        },
        "axis": _axis(),
    }


def _axis() -> Schema:
    whole = {"type": "integer", "minimum": 1, "maximum": 1_000_000}
    numbers = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
    return {
        "type": ["array", "object"],
        "minItems": 1,
        "uniqueItems": True,
        "items": ref("label"),
        "minProperties": 1,
        "propertyNames": {"minLength": 1},
        # a mapping of this one key is a generator; beside other keys it is a label like them
        "if": {"type": "object", "maxProperties": 1},
        "then": {
            "properties": {
                "count": {"description": "How many labels: 0, 1, ... count - 1.", **whole},
                "range": {"description": "[first, last, step]", **numbers},
            }
        },
        "defaultSnippets": [
            {"label": "[5, 15, 45]", "description": "labels", "bodyText": "[${1:5, 15, 45}]"},
            {"label": "{count: 20}", "description": "0 .. 19", "bodyText": "{count: ${1:20}}"},
            {
                "label": "{range: [5, 60, 5]}",
                "description": "first, last, step",
                "bodyText": "{range: [${1:5, 60, 5}]}",
            },
        ],
    }


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


@dataclass(frozen=True)
class Usable:
    """An installed node with the names that graph files may call it by.

    Attributes
    ----------
    found : Registered
    names : tuple of str
        ``family.method`` where one plugin alone has it, and ``plugin:family.method``.
    label : str
        What it is called among its family's alternatives.
    """

    found: Registered
    names: tuple[str, ...]
    label: str

    @property
    def node(self) -> Node:
        """The node itself."""
        return self.found.node

    @property
    def key(self) -> str:
        """The name of its definition."""
        return self.names[0]

    @property
    def family(self) -> str:
        """Its family, as alternatives name it."""
        return f"{self.node.family}.*"

    @property
    def settings(self) -> dict[str, Schema]:
        """The schema of each setting."""
        return self._settings[0]

    @property
    def definitions(self) -> dict[str, Schema]:
        """What may stand beside its ``use``, and the types of its settings that have a name."""
        settings = {
            "type": ["object", "null"],
            "properties": self.settings,
            "additionalProperties": False,
        }
        parts: Schema = {"in": _wiring(self.node), "with": settings}
        return {self.key: {"properties": parts}, **self._settings[1]}

    @property
    def named(self) -> Schema:
        """What holds for its names."""
        return one_of(self.names)

    def when_used(self, then: Schema) -> Schema:
        """Return a schema that holds a mapping to something if its ``use`` is this node."""
        return {"if": {"required": ["use"], "properties": {"use": self.named}}, "then": then}

    def alone(self) -> Schema:
        """Return what must stand beside its ``use`` where nothing is shared."""
        parts: dict[str, Schema] = _required_ports(self.node)
        settings = [one.name for one in self.node.settings.values() if one.required]
        if settings:
            parts["with"] = {"type": "object", "required": settings}
        found: Schema = {"required": sorted(parts), "properties": parts} if parts else {}
        if not any(port.across for port in self.node.inputs):
            found["properties"] = {**parts, "over": {"maxItems": 0}}
        return found

    def constant(self) -> Schema:
        """Return its name with what is said of it."""
        text = "\n\n".join(_lines(self.found))
        found = {"const": self.key, "title": self.key, "description": text}
        return {**found, "deprecated": True} if self.node.deprecated else found

    @cached_property
    def _settings(self) -> tuple[dict[str, Schema], dict[str, Schema]]:
        return settings_schema(self.node, self.found.full_name)


def usable(registry: Registry) -> list[Usable]:
    """Return every node that a graph file can name."""
    bare = Counter(one.node.name for one in registry)
    full = Counter(one.full_name for one in registry)
    made = []
    for one in registry:
        alone = bare[one.node.name] == 1
        names = [one.node.name] * alone + [one.full_name] * (full[one.full_name] == 1)
        label = one.node.method if alone else f"{one.plugin}:{one.node.method}"
        if names:
            made.append(Usable(one, tuple(names), label))
    return made


def _lines(found: Registered) -> Iterator[str]:
    node = found.node
    yield node.summary or node.name
    if node.deprecated:
        yield f"Deprecated: {node.deprecated}."
    if node.inputs:
        yield f"In: {', '.join(map(str, node.inputs))}."
    yield f"Out: {', '.join(map(str, node.outputs))}."
    yield f"Plugin: {found.plugin}. Cite: {', '.join(node.cite) or 'nothing'}."


def _wiring(node: Node) -> Schema:
    if not node.inputs:
        return {"type": ["object", "null"], "maxProperties": 0}
    meanings = port_meanings(node)
    ports = {port.name: _port(port, meanings.get(port.name, "")) for port in node.inputs}
    return {
        "type": ["string", "object", "null"],
        **fixed_or({"properties": ports, "additionalProperties": False}),
    }


def _port(port: Port, meaning: str) -> Schema:
    form = "feed" if port.across else "reference"
    text = {"description": meaning} if meaning else {}
    return {"title": str(port), **text, **ref(form)}


def _required_ports(node: Node) -> dict[str, Schema]:
    ports = [port.name for port in node.inputs if not port.optional]
    if not ports:
        return {}
    if ports != [node.inputs[0].name]:
        return {"in": {"type": "object", "required": ports}}
    by_name = {"type": "object", "not": {"required": ["from"]}}
    return {"in": {"type": ["string", "object"], "if": by_name, "then": {"required": ports}}}
