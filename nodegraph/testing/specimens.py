"""The inputs and settings that a node is tested with."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Literal, get_args, get_origin

from nodegraph.node.decorator import Node
from nodegraph.node.ports import Absent, Across, Port
from nodegraph.plugin.registry import Registry
from nodegraph.state import State

Inputs = Mapping[str, object]
_AXIS = "method"
_LABELS = ("one", "other")
_ABSENT = Absent({_AXIS: "third"}, State.REFUSED.value, "needs one complete frame")


def ports_without_specimens(node: Node, inputs: Inputs, registry: Registry) -> tuple[Port, ...]:
    """Return the required ports, not among `inputs`, for whose type no plugin ships a specimen."""
    return tuple(
        port
        for port in node.inputs
        if not port.optional and port.name not in inputs and not _specimens_of(port.type, registry)
    )


def cases(node: Node, inputs: Inputs, registry: Registry) -> Iterator[tuple[str, Inputs]]:
    """Yield the name of a specimen with a value for every port.

    A type without a specimen of that name gives its first. The last case leaves optional ports
    open.

    Parameters
    ----------
    node
    inputs
        Values for ports that hold in every case.
    registry
        The plugins that ship specimens.
    """
    every = {port: _specimens_of(port.type, registry) for port in node.inputs}
    fed = {
        port: specimens
        for port, specimens in every.items()
        if specimens and port.name not in inputs
    }
    names = list(dict.fromkeys(name for specimens in fed.values() for name in specimens)) or [""]
    for name in names:
        yield name, {**_values(fed, name), **inputs}
    if any(port.optional for port in fed):
        required = {port: specimens for port, specimens in fed.items() if not port.optional}
        yield f"{names[0]}, optional ports open", {**_values(required, names[0]), **inputs}


def variants(node: Node) -> Iterator[tuple[str, Mapping[str, object]]]:
    """Yield settings to test a node with, each with a name: none, then one choice at a time.

    A choice is one of a `Literal`, or true or false, that is not the default.
    """
    yield "", {}
    for setting in node.settings.values():
        for choice in _choices(setting.annotation):
            if setting.required or choice != setting.default:
                yield f"[{setting.name}={choice}]", {setting.name: choice}


def examples(node: Node) -> Mapping[str, object]:
    """Return a value for each setting that has no default but an example in its `Field`."""
    required = [name for name, setting in node.settings.items() if setting.required]
    values = {name: node.model.model_fields[name].examples for name in required}
    return {name: value[0] for name, value in values.items() if value}


def _specimens_of(kind: type, registry: Registry) -> dict[str, object]:
    """Return the specimens, by name, of a type and its subclasses."""
    specimens: dict[str, object] = {}
    for each in registry.hooks.having("specimens"):
        if issubclass(each.type, kind) and each.specimens is not None:
            specimens.update(each.specimens())
    return specimens


def _values(fed: Mapping[Port, Mapping[str, object]], name: str) -> Inputs:
    values: dict[str, object] = {}
    for port, specimens in fed.items():
        value = specimens.get(name, next(iter(specimens.values())))
        if port.across:
            value = Across(
                (_AXIS,), tuple(({_AXIS: label}, value) for label in _LABELS), (_ABSENT,)
            )
        values[port.name] = value
    return values


def _choices(kind: object) -> tuple[object, ...]:
    if get_origin(kind) is Annotated:
        return _choices(get_args(kind)[0])
    if kind is bool:
        return (True, False)
    return get_args(kind) if get_origin(kind) is Literal else ()
