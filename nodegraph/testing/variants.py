"""The settings with which a node is tested: its defaults, and each choice that is not one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal, get_args, get_origin

from nodegraph.node import Node


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
