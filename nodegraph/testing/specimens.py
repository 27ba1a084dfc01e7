"""The values that a node is tried on: those that plugins ship for its ports' types."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal, get_args, get_origin

from nodegraph.node.decorator import Node
from nodegraph.node.ports import Absent, Across, Port
from nodegraph.plugin.registry import Registry

Inputs = Mapping[str, Any]
_AXIS = "method"
_LABELS = ("one", "other")
_LACKING = Absent({_AXIS: "third"}, "refused", "needs one complete frame")


def specimens_of(kind: type, registry: Registry) -> dict[str, Any]:
    """Return the specimens, by name, that a port of that type can take.

    Parameters
    ----------
    kind
        A port's type; specimens of its subclasses fit as well.
    registry
        Whose plugins ship them.
    """
    made: dict[str, Any] = {}
    for held, make in registry.hooks.specimens():
        if issubclass(held, kind):
            made.update(make())
    return made


def without_specimens(node: Node, given: Inputs, registry: Registry) -> tuple[Port, ...]:
    """Return the ports that must be fed and for whose type no plugin ships a specimen.

    Parameters
    ----------
    node
        Whose ports are fed.
    given
        Values for ports that need no specimen.
    registry
        Whose plugins ship specimens.
    """
    return tuple(
        port
        for port in node.inputs
        if not port.optional and port.name not in given and not specimens_of(port.type, registry)
    )


def cases(node: Node, given: Inputs, registry: Registry) -> Iterator[tuple[str, Inputs]]:
    """Yield the name of a specimen and a value for every port.

    A type that lacks a specimen of that name gives its first; `given` values are always taken.
    The last case leaves the optional ports open.

    Parameters
    ----------
    node
        Whose ports are fed.
    given
        Values for ports, taken in every case.
    registry
        Whose plugins ship specimens.
    """
    known = {port: specimens_of(port.type, registry) for port in node.inputs}
    fed = {port: made for port, made in known.items() if made and port.name not in given}
    names = list(dict.fromkeys(name for made in fed.values() for name in made)) or [""]
    for name in names:
        yield name, {**_chosen(fed, name), **given}
    optional = {port.name for port in fed if port.optional}
    if optional:
        first = {**_chosen(fed, names[0]), **given}
        open_ports = {port: value for port, value in first.items() if port not in optional}
        yield f"{names[0]}, optional ports open", open_ports


def _chosen(fed: Mapping[Port, Mapping[str, Any]], name: str) -> Inputs:
    return {port.name: _held(port, made.get(name, _first(made))) for port, made in fed.items()}


def _held(port: Port, value: Any) -> Any:
    if not port.across:
        return value
    return Across((_AXIS,), tuple(({_AXIS: label}, value) for label in _LABELS), (_LACKING,))


def _first(made: Mapping[str, Any]) -> Any:
    return next(iter(made.values()))


def variants(node: Node) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield settings to test a node with, each with a name: none, then one choice at a time.

    A choice is one of a `Literal`, or true or false.

    Parameters
    ----------
    node
        Any.
    """
    yield "", {}
    for setting in node.settings.values():
        for choice in _choices(setting.annotation):
            if setting.required or choice != setting.default:
                yield f"[{setting.name}={choice}]", {setting.name: choice}


def examples(node: Node) -> Mapping[str, Any]:
    """Return a value for each setting that has no default but an example in its `Field`.

    Parameters
    ----------
    node
        Any.
    """
    found = {}
    for name, setting in node.settings.items():
        given = node.model.model_fields[name].examples if setting.required else None
        if given:
            found[name] = given[0]
    return found


def _choices(kind: Any) -> tuple[Any, ...]:
    if get_origin(kind) is Annotated:
        return _choices(get_args(kind)[0])
    if kind is bool:
        return (True, False)
    return get_args(kind) if get_origin(kind) is Literal else ()
