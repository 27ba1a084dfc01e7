"""The forms of file that a value can be written in.

A node of the family ``write`` whose first input takes the value gives one: ``write.c3d`` the form
``.c3d``, ``write.marker_set_yaml`` the form ``.yaml``: the last word of its name is the suffix.
Whatever is shown in a report has those of the files beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from nodegraph.node.decorator import Node
from nodegraph.node.values import Files
from nodegraph.plugin.registry import Registry

Form = Callable[[], Mapping[str, bytes]]
_FAMILY = "write"


def forms_of(value: Any, registry: Registry) -> dict[str, Form]:
    """Return what makes files of a value, by suffix: ``.c3d``.

    Parameters
    ----------
    value
    registry
        Whose writers and renderers.

    Returns
    -------
    mapping of suffix to callable
        Each returns the content of files by name, the one of that suffix first.
    """
    if isinstance(value, Files):
        return {_suffix(name): _given(name, value.content) for name in value.content}
    return {**_rendered(value, registry), **dict(_written(value, registry))}


def _given(first: str, content: Mapping[str, bytes]) -> Form:
    return lambda: {first: content[first]}


def _written(value: Any, registry: Registry) -> Iterator[tuple[str, Form]]:
    for one in registry.family(_FAMILY).values():
        port = _port_for(value, one.node)
        if port:
            suffix = f".{one.node.method.rpartition('_')[2]}"
            yield suffix, _written_by(one.node, port, value, suffix)


def _port_for(value: Any, node: Node) -> str:
    """Return the port that takes a value, if the node needs nothing else; else nothing."""
    fits = [port for port in node.inputs if isinstance(value, port.type) and not port.across]
    others = [port for port in node.inputs if port not in fits[:1] and not port.optional]
    settings = [one for one in node.settings.values() if one.required]
    return fits[0].name if fits and not others and not settings else ""


def _written_by(node: Node, port: str, value: Any, suffix: str) -> Form:
    def made() -> Mapping[str, bytes]:
        files = node.function(**{port: value})
        content: Mapping[str, bytes] = files.content
        return dict(sorted(content.items(), key=lambda one: _suffix(one[0]) != suffix))

    return made


def _rendered(value: Any, registry: Registry) -> dict[str, Form]:
    for renderer in registry.hooks.renderers:
        if isinstance(value, renderer.type):
            files = renderer.render(value, "").files
            return {suffix: _given(suffix, files) for suffix in files}
    return {}


def _suffix(name: str) -> str:
    return f".{name.rpartition('.')[2]}" if "." in name else ""
