"""Files that a value can be written as, by suffix.

A node of the family ``write`` whose first input takes the value writes one format: the last word
of its name is the suffix, ``.c3d`` of ``write.c3d``, ``.yaml`` of ``write.marker_set_yaml``. What a
report shows can be written in the formats of the files beside the report as well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import PurePosixPath
from types import MappingProxyType

from nodegraph.node.decorator import Node
from nodegraph.node.values import Files
from nodegraph.plugin.registry import Registry

Exporter = Callable[[], Mapping[str, bytes]]
"""Returns the content of files by name, the one of its suffix first."""

_FAMILY = "write"
_NOTHING: Mapping[str, object] = MappingProxyType({})


def exporters_of(
    value: object, registry: Registry, settings: Mapping[str, object] = _NOTHING
) -> dict[str, Exporter]:
    """Return an exporter of a value for each suffix, such as ``.c3d``.

    Parameters
    ----------
    value
    registry
    settings
        Settings of the node that writes; only formats whose node has all of them are given.
    """
    if settings:
        return dict(_from_writers(value, registry, settings))
    if isinstance(value, Files):
        return {
            suffix: partial(_with_suffix, value.content, suffix)
            for suffix in map(_suffix, value.content)
        }
    return {**_from_renderer(value, registry), **dict(_from_writers(value, registry, settings))}


def _from_renderer(value: object, registry: Registry) -> dict[str, Exporter]:
    kind = registry.hooks.kind(type(value), "render")
    files = kind.render(value, "").files if kind is not None and kind.render is not None else {}
    return {suffix: partial(_part, files, suffix) for suffix in files}


def _from_writers(
    value: object, registry: Registry, settings: Mapping[str, object]
) -> Iterator[tuple[str, Exporter]]:
    for entry in registry.family(_FAMILY).values():
        port = _port_for(value, entry.node)
        if port and settings.keys() <= entry.node.settings.keys():
            suffix = f".{entry.node.method.rpartition('_')[2]}"
            yield suffix, partial(_write, entry.node, {port: value, **settings}, suffix)


def _port_for(value: object, node: Node) -> str:
    """Return the port that takes a value if the node requires nothing else, or nothing."""
    ports = [port for port in node.inputs if isinstance(value, port.type) and not port.across]
    required = [port for port in node.inputs if port not in ports[:1] and not port.optional]
    settings = [setting for setting in node.settings.values() if setting.required]
    return ports[0].name if ports and not required and not settings else ""


def _part(files: Mapping[str, bytes], name: str) -> Mapping[str, bytes]:
    return {name: files[name]}


def _with_suffix(files: Mapping[str, bytes], suffix: str) -> Mapping[str, bytes]:
    return {name: content for name, content in files.items() if _suffix(name) == suffix}


def _write(node: Node, arguments: Mapping[str, object], suffix: str) -> Mapping[str, bytes]:
    content: Mapping[str, bytes] = node.function(**arguments).content
    return dict(sorted(content.items(), key=lambda file: _suffix(file[0]) != suffix))


def _suffix(name: str) -> str:
    return PurePosixPath(name).suffix.lower()
