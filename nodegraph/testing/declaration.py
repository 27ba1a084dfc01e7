"""What a node's declaration must say before anybody calls it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from nodegraph.describe import port_meanings, setting_kind
from nodegraph.errors import NodeError
from nodegraph.node import Node

_OTHER_NAMES_OF_SEED = {"rng", "random", "random_seed", "random_state", "generator"}


def unreadable(node: Node) -> str:
    """Return why the signature is not a node's, or an empty text.

    Parameters
    ----------
    node
        Any.
    """
    try:
        node.check()
    except NodeError as error:
        return str(error)
    return ""


def declaration_faults(node: Node, given: Mapping[str, Any]) -> Iterator[str]:
    """Yield what name, docstring and settings lack; `given` are values for settings.

    Parameters
    ----------
    node
        One that can be read.
    given
        Values for settings.
    """
    if not node.summary.strip():
        yield "has no docstring: say in its first line what the method does; users see it in lists"
    meanings = port_meanings(node)
    for name in node.settings:
        if not meanings.get(name):
            yield (
                f"setting {name!r} is not documented: say under 'Parameters' in the docstring what "
                "it means; the tool shows that text to users"
            )
        if name in _OTHER_NAMES_OF_SEED:
            yield f"setting {name!r} is randomness by another name: call it seed, a whole number"
    yield from _value_faults(node, given)


def _value_faults(node: Node, given: Mapping[str, Any]) -> Iterator[str]:
    from pydantic import ValidationError

    defaults = {one.name: one.default for one in node.settings.values() if not one.required}
    try:
        node.model.model_validate({**defaults, **given})
    except ValidationError as error:
        for one in error.errors():
            if one["loc"] and one["type"] not in ("missing", "extra_forbidden"):
                yield _value_fault(node, given, str(one["loc"][0]), one["msg"])


def _value_fault(node: Node, given: Mapping[str, Any], name: str, message: str) -> str:
    what, value = (
        ("the given value", given[name])
        if name in given
        else ("the default", node.settings[name].default)
    )
    return (
        f"setting {name!r}: {what} {value!r} is not {setting_kind(node, name)}: {message}; "
        "change the value or the type and bounds"
    )
