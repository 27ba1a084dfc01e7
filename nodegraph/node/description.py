"""A node as text: its settings with bounds, units and meanings, and an example for a graph file."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any

from nodegraph.errors import NodeError
from nodegraph.formatting import number_of
from nodegraph.node.declaration import UNDECLARED
from nodegraph.node.decorator import Node, Setting
from nodegraph.node.live_form import RunningForm, StateForm
from nodegraph.node.shared import section_of

FILE, COLUMN, TEXT, NAME = "FILE", "COLUMN", "TEXT", "NAME"
"""Values in an example that only the reader can know."""

_WIDTH = 96
_PARAMETERS = section_of("Parameters")
_EXAMPLES = section_of("Examples")
_NONE = re.compile(r"\b[Nn]one(?=:)")
_CODE = re.compile(r"(?<!`)`{1,2}([^`]+)`{1,2}(?!`)")


@dataclass(frozen=True)
class ShownSetting:  # ``nodegraph show --json`` prints its fields
    """A setting of a node.

    Attributes
    ----------
    name, unit, kind, meaning : str
        The kind is type, bounds and choices.
    default : any
        None also where one is required.
    required : bool
    """

    name: str
    kind: str
    unit: str
    default: object
    required: bool
    meaning: str

    @property
    def default_text(self) -> str:
        """The default as a graph file has it, or ``required``."""
        return "required" if self.required else value_text(self.default)


def describe_settings(node: Node) -> tuple[ShownSetting, ...]:
    """Return a node's settings, in the order of the signature."""
    return tuple(
        ShownSetting(
            setting.name,
            setting_kind(node, setting.name),
            setting.unit,
            None if setting.required else setting.default,
            setting.required,
            _with_deprecation(setting.deprecated, _meaning(node, setting.name)),
        )
        for setting in node.settings.values()
    )


def summary_of(node: Node) -> str:
    """Return a node's first line, which begins with what replaces it, if anything does."""
    return _with_deprecation(node.deprecated, node.summary)


def plain_summary_of(node: Node) -> str:
    """Return the same without marks, for a reader of text."""
    return summary_of(node).replace("``", "")


def describe_declaration(
    node: Node, settings: Iterable[Mapping[str, object]] | None = None
) -> tuple[str, ...]:
    """Return the declarations of a method, a phrase each: source, look-ahead, ends, live form.

    Parameters
    ----------
    node
    settings
        The settings at which it was used, each with defaults included. By default the node's
        own defaults.
    """
    used = [node.defaults] if settings is None else list(settings)
    phrases = []
    if adapted := "; ".join(_texts_of(node.adapted_from, used)):
        phrases.append(f"adapted {adapted}")
    elif node.cite and node.declaration.lookahead is not UNDECLARED:
        phrases.append("as published")
    by_default = settings is None and len(node.settings) > 0
    if used and all(len(each) == len(node.settings) for each in used):
        frames = _texts_of(partial(_frames_text, node), used)
        ends = _texts_of(partial(_ends_text, node), used)
        varies = by_default and callable(node.declaration.lookahead)
        phrases += _phrase("look-ahead", frames, varies=varies)
        varies = by_default and callable(node.declaration.ends)
        phrases += _phrase("ends of gaps", ends, varies=varies)
    if node.live is not None and settings is None:
        phrases.append(_live_text(node))
    return tuple(phrases)


def describe_departure(node: Node) -> str:
    """Return how a stream's result differs from that of the whole take; empty if it does not."""
    form = node.live
    if isinstance(form, RunningForm):
        near = f", within {form.tolerance:g} of their size" if form.tolerance else ""
        return f"gives numbers of the frames so far: {', '.join(form.numbers)}{near}"
    if not isinstance(form, StateForm):
        return ""
    phrases = [f"leaves {form.leaves} missing"] if form.leaves else []
    if form.tolerance:
        phrases.append(
            f"numbers within {form.tolerance:g} of those of the whole take, of their size above 1"
        )
    return ", ".join(phrases)


def _live_text(node: Node) -> str:
    departure = describe_departure(node)
    text = f"runs on a stream{f' ({departure})' if departure else ''}"
    defaults = node.defaults
    if len(defaults) < len(node.settings):
        return text
    frames = node.live_lookahead(defaults)
    if frames is None:
        return f"{text}, with settings that bound its look-ahead"
    return f"{text}, {number_of(frames, 'frame')} behind by default"


def _phrase(what: str, texts: Iterable[str], *, varies: bool) -> list[str]:
    joined = " or ".join(texts)
    return [f"{what} {joined}{' by default' if varies else ''}"] if joined else []


def _texts_of(
    declared: Callable[[Mapping[str, object]], str], used: Iterable[Mapping[str, object]]
) -> list[str]:
    """Return each text once that is declared for some settings, ``unknown`` where that fails."""
    texts: dict[str, None] = {}
    for settings in used:
        try:
            texts[declared(settings)] = None
        except NodeError:
            texts["unknown"] = None
    return list(filter(None, texts))


def _frames_text(node: Node, settings: Mapping[str, object]) -> str:
    frames = node.lookahead(settings)
    if frames is UNDECLARED:
        return ""
    return "unbounded" if frames is None else number_of(frames, "frame")


def _ends_text(node: Node, settings: Mapping[str, object]) -> str:
    return {None: "", True: "met", False: "not met"}[node.meets_ends(settings)]


def setting_kind(node: Node, name: str) -> str:
    """Return type, bounds and choices of a setting: ``whole number >= 1 or null``."""
    schema = _json_schema(node)["properties"].get(name, {})
    options = schema.get("anyOf", [schema])
    kinds = [_kind(option) for option in options if option.get("type") != "null"]
    return " or ".join([*kinds, "null"] if len(kinds) < len(options) else kinds)


def meanings(node: Node) -> dict[str, str]:
    """Return the documentation of each port and setting, by name."""
    return _documented_parameters(node.doc)


def without_parameters(doc: str) -> str:
    """Return a docstring without its section "Parameters", which is shown as a table."""
    return _PARAMETERS.sub("", doc).strip()


def value_text(value: object) -> str:
    """Return a setting's value as a graph file has it."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(value_text, value))}]"
    return str(value)


def has_example(node: Node) -> bool:
    """Return whether a node's docstring has, under "Examples", a use in a graph file."""
    section = _EXAMPLES.search(node.doc)
    return section is not None and re.search(r"\buse: ", section[1]) is not None


def example_of(node: Node, use: str = "") -> str:
    """Return YAML that uses a node, as it stands under ``nodes`` in a graph file.

    Each required port is fed by a node of the port's name. The settings are those that are
    required, else the first that has an informative default.

    Parameters
    ----------
    node
    use
        The name by which the graph uses it, if not its own.
    """
    entry: dict[str, object] = {"use": use or node.name}
    ports = [port.name for port in node.inputs if not port.optional]
    ports = ports or [port.name for port in node.inputs[:1]]
    if ports:
        is_first = ports == [node.inputs[0].name]
        entry["in"] = ports[0] if is_first else {name: name for name in ports}
    if settings := _example_settings(node):
        entry["with"] = settings
    return _yaml(node.method if node.family in ports else node.family, entry)


@lru_cache(maxsize=512)
def _json_schema(node: Node) -> dict[str, Any]:
    """Return the JSON Schema of a node's settings, ``{}`` for types that JSON does not have."""
    if not node.settings:
        return {"properties": {}}
    from pydantic.json_schema import GenerateJsonSchema

    class Lenient(GenerateJsonSchema):
        def handle_invalid_for_json_schema(
            self, schema: object, error_info: str
        ) -> dict[str, object]:
            return {}

    return node.model.model_json_schema(schema_generator=Lenient)


def _kind(schema: Mapping[str, Any]) -> str:
    if "enum" in schema or "const" in schema:
        return "one of " + ", ".join(map(value_text, schema.get("enum", [schema.get("const")])))
    if schema.get("type") == "array":
        items = schema.get("items", {})
        if "enum" in items:
            return _kind(items).replace("one of", "list of", 1)
        return f"list of {_kind(items)}s" if items.get("type") else "list"
    signs = {"minimum": ">=", "exclusiveMinimum": ">", "maximum": "<=", "exclusiveMaximum": "<"}
    names = {"integer": "whole number", "string": "text", "boolean": "true or false"}
    kind = "path" if schema.get("format") == "path" else schema.get("type", "value")
    bounds = [f"{sign} {schema[key]:g}" for key, sign in signs.items() if key in schema]
    return f"{names.get(kind, kind)} {' and '.join(bounds)}".strip()


def _meaning(node: Node, name: str) -> str:
    """Return a setting's meaning, with ``null`` for ``None`` (if no choice has that name)."""
    meaning = meanings(node).get(name, "")
    kind = setting_kind(node, name)
    is_null = kind.endswith("null") and not re.search(r"\bnone\b", kind)
    return _NONE.sub("null", meaning) if is_null else meaning


def _with_deprecation(deprecated: str, text: str) -> str:
    return f"(deprecated: {deprecated}) {text}" if deprecated else text


@lru_cache(maxsize=512)
def _documented_parameters(doc: str) -> dict[str, str]:
    from docstring_parser import DocstringStyle, parse

    return {
        name.strip(): _CODE.sub(r"\1", " ".join((parameter.description or "").split()))
        for parameter in parse(doc, style=DocstringStyle.NUMPYDOC).params
        for name in parameter.arg_name.split(",")
    }


def _example_settings(node: Node) -> dict[str, object]:
    required = [setting for setting in node.settings.values() if setting.required]
    if required:
        return {setting.name: _example_value(node, setting) for setting in required}
    for setting in node.settings.values():
        default = _plain(setting.default)
        if not setting.deprecated and not setting.is_file and default not in (None, [], {}, ""):
            return {setting.name: default}
    return {}


def _example_value(node: Node, setting: Setting) -> object:
    """Return a value for a required setting: the example of its `Field`, or one of its type."""
    examples = node.model.model_fields[setting.name].examples
    if examples:
        return _plain(examples[0])
    if setting.names is not None:
        return COLUMN
    return _value_of(_json_schema(node)["properties"].get(setting.name, {}))


def _value_of(schema: Mapping[str, Any]) -> object:
    """Return a small value that a JSON Schema allows, as far as its types and bounds decide."""
    options = schema.get("anyOf", [schema])
    schema = next((option for option in options if option.get("type") != "null"), {})
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
            return [_value_of(item) for item in (*first, *rest)]
        case "object":
            inner = schema.get("additionalProperties")
            return {NAME: _value_of(inner if isinstance(inner, Mapping) else {})}
    return FILE if schema.get("format") == "path" else TEXT


def _number(schema: Mapping[str, Any], kind: str) -> float:
    """Return 1 if the bounds allow it, else a number at or near a bound."""
    low = schema.get("minimum", schema.get("exclusiveMinimum", -math.inf))
    high = schema.get("maximum", schema.get("exclusiveMaximum", math.inf))
    excluded = {schema.get("exclusiveMinimum"), schema.get("exclusiveMaximum")}
    candidates = (1, low, low + 1, high, high - 1, (low + high) / 2)
    allowed = (value for value in candidates if low <= value <= high and value not in excluded)
    number = next(allowed, 1)
    return int(number) if kind == "integer" else float(number)


def _plain(value: object) -> object:
    """Return a value in the types of YAML, None for what has none."""
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, dict):
        return {_plain(key): _plain(item) for key, item in value.items()}
    return value if type(value) in (bool, int, float, str) else None


def _yaml(name: str, entry: Mapping[str, object]) -> str:
    """Return an entry in one line, or one for each of its keys if that is too long."""
    parts = {key: _flow(value) for key, value in entry.items()}
    line = f"{name}: {{{', '.join(f'{key}: {text}' for key, text in parts.items())}}}"
    if len(line) <= _WIDTH:
        return line
    return "\n".join([f"{name}:", *(f"  {key}: {text}" for key, text in parts.items())])


def _flow(value: object) -> str:
    import yaml

    text: str = yaml.safe_dump(
        [value], default_flow_style=True, sort_keys=False, allow_unicode=True, width=float("inf")
    )
    return text.strip()[1:-1]
