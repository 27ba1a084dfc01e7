"""How a node is written in a graph: YAML, made of the node's declaration."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from nodegraph.describe import settings_schema
from nodegraph.node import Node
from nodegraph.signature import Setting

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
