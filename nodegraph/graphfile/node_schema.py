"""The JSON Schema of one installed node: its names, ports and settings."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from nodegraph.graphfile.definitions import Schema, fixed_or, one_of, ref
from nodegraph.graphfile.settings_schema import settings_schema
from nodegraph.node.decorator import Node
from nodegraph.node.description import describe_declaration, meanings
from nodegraph.node.ports import Port
from nodegraph.plugin.registry import Registered, Registry


@dataclass(frozen=True)
class NodeSchema:
    """The parts of the schema that concern one node.

    Attributes
    ----------
    registered : Registered
    names : tuple of str
        By which graph files may call it: ``family.method`` where one plugin alone has it, and
        ``plugin:family.method``.
    label : str
        Its label among its family's alternatives.
    """

    registered: Registered
    names: tuple[str, ...]
    label: str

    @property
    def node(self) -> Node:
        """The node itself."""
        return self.registered.node

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
        """The keys that may stand beside its ``use``, and the named types of its settings."""
        settings = {
            "type": ["object", "null"],
            "properties": self.settings,
            "additionalProperties": False,
        }
        parts: Schema = {"in": _wiring(self.node), "with": settings}
        return {self.key: {"properties": parts}, **self._settings[1]}

    @property
    def named(self) -> Schema:
        """Matches its names."""
        return one_of(self.names)

    def when_used(self, then: Schema) -> Schema:
        """Return a schema that applies to a mapping if its ``use`` is this node."""
        return {"if": {"required": ["use"], "properties": {"use": self.named}}, "then": then}

    def alone(self) -> Schema:
        """Return what must accompany its ``use`` where nothing is shared."""
        parts: dict[str, Schema] = _required_ports(self.node)
        settings = [setting.name for setting in self.node.settings.values() if setting.required]
        if settings:
            parts["with"] = {"type": "object", "required": settings}
        schema: Schema = {"required": sorted(parts), "properties": parts} if parts else {}
        if not any(port.across for port in self.node.inputs):
            schema["properties"] = {**parts, "over": {"maxItems": 0}}
        return schema

    def constant(self) -> Schema:
        """Return its name with its description."""
        description = "\n\n".join(_lines(self.registered))
        schema = {"const": self.key, "title": self.key, "description": description}
        return {**schema, "deprecated": True} if self.node.deprecated else schema

    @cached_property
    def _settings(self) -> tuple[dict[str, Schema], dict[str, Schema]]:
        return settings_schema(self.node, self.registered.full_name)


def node_schemas(registry: Registry) -> list[NodeSchema]:
    """Return the schema of every node that a graph file can name."""
    names = Counter(registered.node.name for registered in registry)
    full_names = Counter(registered.full_name for registered in registry)
    schemas = []
    for registered in registry:
        node = registered.node
        is_unique = names[node.name] == 1
        usable = [node.name] * is_unique
        usable += [registered.full_name] * (full_names[registered.full_name] == 1)
        label = node.method if is_unique else f"{registered.plugin}:{node.method}"
        if usable:
            schemas.append(NodeSchema(registered, tuple(usable), label))
    return schemas


def _lines(registered: Registered) -> Iterator[str]:
    node = registered.node
    yield node.summary or node.name
    if node.deprecated:
        yield f"Deprecated: {node.deprecated}."
    if node.inputs:
        yield f"In: {', '.join(map(str, node.inputs))}."
    yield f"Out: {', '.join(map(str, node.outputs))}."
    if declared := "; ".join(describe_declaration(node)):
        yield f"{declared[0].upper()}{declared[1:]}."
    yield f"Plugin: {registered.plugin}. Cite: {', '.join(node.cite) or 'nothing'}."


def _wiring(node: Node) -> Schema:
    if not node.inputs:
        return {"type": ["object", "null"], "maxProperties": 0}
    documented = meanings(node)
    ports = {port.name: _port(port, documented.get(port.name, "")) for port in node.inputs}
    return {
        "type": ["string", "object", "null"],
        **fixed_or({"properties": ports, "additionalProperties": False}),
    }


def _port(port: Port, meaning: str) -> Schema:
    form = "feed" if port.across else "reference"
    description = {"description": meaning} if meaning else {}
    return {"title": str(port), **description, **ref(form)}


def _required_ports(node: Node) -> dict[str, Schema]:
    ports = [port.name for port in node.inputs if not port.optional]
    if not ports:
        return {}
    if ports != [node.inputs[0].name]:
        return {"in": {"type": "object", "required": ports}}
    by_name = {"type": "object", "not": {"required": ["from"]}}
    return {"in": {"type": ["string", "object"], "if": by_name, "then": {"required": ports}}}
