"""What a node is, in words: ports, settings with bounds and units, meaning, citation."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from nodegraph.node.decorator import Node, Setting

_PARAMETERS = re.compile(r"^Parameters\n-+\n.*?(?=^\w[\w ]*\n-+$|\Z)", re.MULTILINE | re.DOTALL)

_NONE = re.compile(r"\b[Nn]one(?=:)")
_QUOTED = re.compile(r"(?<!`)`{1,2}([^`]+)`{1,2}(?!`)")


@dataclass(frozen=True)
class SettingText:
    """One setting as people read it.

    Attributes
    ----------
    name, kind, unit, default, meaning : str
        `kind` holds type, bounds and choices; `default` is ``required`` where there is none.
    """

    name: str
    kind: str
    unit: str
    default: str
    meaning: str


def describe_settings(node: Node) -> tuple[SettingText, ...]:
    """Return a node's settings as people read them, in the order of the signature.

    Parameters
    ----------
    node
        Any.
    """
    meanings = _meanings(node.doc)
    return tuple(
        SettingText(
            one.name,
            setting_kind(node, one.name),
            one.unit,
            "required" if one.required else shown(one.default),
            _with_instead(one, _as_in_a_file(node, one.name, meanings.get(one.name, ""))),
        )
        for one in node.settings.values()
    )


def summary_of(node: Node) -> str:
    """Return a node's first line, which begins with what replaces it, if something does.

    Parameters
    ----------
    node
        Any.
    """
    instead = f"(deprecated: {node.deprecated}) " if node.deprecated else ""
    return f"{instead}{node.summary}"


def port_meanings(node: Node) -> dict[str, str]:
    """Return what the docstring says of each parameter, ports included.

    Parameters
    ----------
    node
        Any.
    """
    return _meanings(node.doc)


def without_parameters(doc: str) -> str:
    """Return a docstring without its section of parameters, which is shown as a table.

    Parameters
    ----------
    doc
        As `Node.doc` has it.
    """
    return _PARAMETERS.sub("", doc).strip()


def setting_kind(node: Node, name: str) -> str:
    """Return type, bounds and choices of a setting, as its JSON Schema has them.

    Parameters
    ----------
    node
        Any.
    name
        Of one of its settings.
    """
    schema = settings_schema(node)["properties"].get(name, {})
    options = schema.get("anyOf", [schema])
    texts = [_option(one) for one in options if one.get("type") != "null"]
    return " or ".join([*texts, "null"] if len(texts) < len(options) else texts)


@lru_cache(maxsize=512)
def settings_schema(node: Node) -> dict[str, Any]:
    """Return the JSON Schema of a node's settings; what JSON knows nothing of is any value.

    Parameters
    ----------
    node
        Any.
    """
    if not node.settings:
        return {"properties": {}}
    from pydantic.json_schema import GenerateJsonSchema

    class Lenient(GenerateJsonSchema):
        def handle_invalid_for_json_schema(self, schema: Any, error_info: str) -> dict[str, Any]:
            return {}

    return node.model.model_json_schema(schema_generator=Lenient)


def shown(value: Any) -> str:
    """Return a setting's value as a graph file has it.

    Parameters
    ----------
    value
        A number, a text, a truth, nothing, or a list of these.
    """
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(shown, value))}]"
    return str(value)


def _as_in_a_file(node: Node, name: str, meaning: str) -> str:
    """Return a meaning that says ``null`` for Python's ``None``, unless a choice is called so."""
    kind = setting_kind(node, name)
    optional = kind.endswith("null") and not re.search(r"\bnone\b", kind)
    return _NONE.sub("null", meaning) if optional else meaning


def _with_instead(setting: Setting, meaning: str) -> str:
    return f"(deprecated: {setting.deprecated}) {meaning}" if setting.deprecated else meaning


def _option(schema: dict[str, Any]) -> str:
    if "enum" in schema or "const" in schema:
        return "one of " + ", ".join(map(shown, schema.get("enum", [schema.get("const")])))
    if schema.get("type") == "array":
        items = schema.get("items", {})
        return f"list of {_option(items)}s" if items.get("type") else "list"
    words = {"minimum": ">=", "exclusiveMinimum": ">", "maximum": "<=", "exclusiveMaximum": "<"}
    names = {"integer": "whole number", "string": "text", "boolean": "true or false"}
    kind = "path" if schema.get("format") == "path" else schema.get("type", "value")
    bounds = [f"{sign} {schema[key]:g}" for key, sign in words.items() if key in schema]
    return " ".join([names.get(kind, kind), *bounds])


@lru_cache(maxsize=512)
def _meanings(doc: str) -> dict[str, str]:
    from docstring_parser import DocstringStyle, parse

    found = parse(doc, style=DocstringStyle.NUMPYDOC).params
    return {
        name.strip(): _QUOTED.sub(r"\1", " ".join((one.description or "").split()))
        for one in found
        for name in one.arg_name.split(",")
    }


FILE, COLUMN, TEXT, NAME = "FILE", "COLUMN", "TEXT", "NAME"
"""What stands in an example for something that only the reader knows."""

_WIDTH = 96
_SECTION = re.compile(r"^Examples\n-+\n(.*?)(?=^\w[\w ]*\n-+$|\Z)", re.MULTILINE | re.DOTALL)


def example_of(node: Node, use: str = "") -> str:
    """Return YAML that uses a node, as it stands under ``nodes`` in a graph.

    Each port that must be fed is fed by a node of the port's name. Of the settings there are
    those that must be given, else the first that has a default which says something.

    Parameters
    ----------
    node
        Any.
    use
        How the graph names it; by its name if not given.
    """
    written: dict[str, Any] = {"use": use or node.name}
    ports = [port.name for port in node.inputs if not port.optional]
    ports = ports or [port.name for port in node.inputs[:1]]
    if ports:
        is_first = ports == [node.inputs[0].name]
        written["in"] = ports[0] if is_first else {name: name for name in ports}
    if settings := _settings(node):
        written["with"] = settings
    return _yaml(node.method if node.family in ports else node.family, written)


def has_example(node: Node) -> bool:
    """Return whether a node's own documentation shows, under 'Examples', how a graph uses it.

    Parameters
    ----------
    node
        Any.
    """
    section = _SECTION.search(node.doc)
    return section is not None and re.search(r"\buse: ", section[1]) is not None


def _settings(node: Node) -> dict[str, Any]:
    required = [one for one in node.settings.values() if one.required]
    if required:
        return {one.name: _value(node, one) for one in required}
    defaults = {
        one.name: _plain(one.default)
        for one in node.settings.values()
        if not one.deprecated and not one.is_file
    }
    return dict(
        [(name, one) for name, one in defaults.items() if one not in (None, [], {}, "")][:1]
    )


def _value(node: Node, setting: Setting) -> Any:
    """Return a value for a setting that has no default: its own example, or one of its type."""
    examples = node.model.model_fields[setting.name].examples
    if examples:
        return _plain(examples[0])
    if setting.names is not None:
        return COLUMN
    return _of_schema(settings_schema(node)["properties"].get(setting.name, {}))


def _of_schema(schema: Mapping[str, Any]) -> Any:
    """Return a small value that a JSON Schema allows, as far as its types and bounds tell one."""
    options = [one for one in schema.get("anyOf", [schema]) if one.get("type") != "null"]
    schema = next(iter(options), {})
    if "enum" in schema or "const" in schema:
        return schema.get("enum", [schema.get("const")])[0]
    match schema.get("type"):
        case "boolean":
            return True
        case "integer" | "number" as kind:
            return _number(schema, kind)
        case "array":
            first = schema.get("prefixItems", [])
            rest = [schema.get("items", {})] * max(0, schema.get("minItems", 1) - len(first))
            return [_of_schema(one) for one in (*first, *rest)]
        case "object":
            inner = schema.get("additionalProperties")
            return {NAME: _of_schema(inner if isinstance(inner, Mapping) else {})}
    return FILE if schema.get("format") == "path" else TEXT


def _number(schema: Mapping[str, Any], kind: str) -> float:
    """Return 1, else the number nearest to a bound, that the bounds allow."""
    low = schema.get("minimum", schema.get("exclusiveMinimum", -math.inf))
    high = schema.get("maximum", schema.get("exclusiveMaximum", math.inf))
    open_ends = {schema.get("exclusiveMinimum"), schema.get("exclusiveMaximum")}
    guesses = (1, low, low + 1, high, high - 1, (low + high) / 2)
    found = next((one for one in guesses if low <= one <= high and one not in open_ends), 1)
    return int(found) if kind == "integer" else float(found)


def _plain(value: Any) -> Any:
    """Return a value as YAML knows it; None for what it does not know."""
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    if isinstance(value, dict):
        return {_plain(key): _plain(one) for key, one in value.items()}
    return value if type(value) in (bool, int, float, str) else None


def _yaml(name: str, written: Mapping[str, Any]) -> str:
    """Return a node in one line, or one for each of its keys where that is too long."""
    parts = {key: _flow(one) for key, one in written.items()}
    line = f"{name}: {{{', '.join(f'{key}: {one}' for key, one in parts.items())}}}"
    if len(line) <= _WIDTH:
        return line
    return "\n".join([f"{name}:", *(f"  {key}: {one}" for key, one in parts.items())])


def _flow(value: Any) -> str:
    import yaml

    text: str = yaml.safe_dump(
        [value], default_flow_style=True, sort_keys=False, allow_unicode=True, width=float("inf")
    )
    return text.strip()[1:-1]
