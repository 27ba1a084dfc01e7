"""What a node is, in words: ports, settings with bounds and units, meaning, citation."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from nodegraph.node import Node
from nodegraph.signature import Setting

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
