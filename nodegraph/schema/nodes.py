"""What one installed node takes: its ports, its settings, and what is said of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from nodegraph.describe import port_meanings
from nodegraph.node import Node
from nodegraph.ports import Port
from nodegraph.registry import Registered, Registry
from nodegraph.schema.parts import Schema, fixed_or, one_of, ref
from nodegraph.schema.settings import settings_schema


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
