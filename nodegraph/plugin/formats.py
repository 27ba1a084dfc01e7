"""The file formats of the plugins in use, for nodes that read files."""

from __future__ import annotations

from contextvars import ContextVar

from nodegraph.plugin.hook_types import Format
from nodegraph.plugin.registry import Registry, default_registry

_registry: ContextVar[Registry | None] = ContextVar("_registry", default=None)


def formats(kind: type) -> tuple[Format, ...]:
    """Return the formats in which values of a type are read, the last plugin's first.

    A node that calls this is computed again when a format is installed, removed or edited.

    Parameters
    ----------
    kind
        Formats of its subclasses are included.

    Returns
    -------
    tuple of Format
        Of the plugins of the run, or of all installed ones if the node is called by hand.
    """
    return tuple(each for each in current_registry().hooks.formats if issubclass(each.type, kind))


def current_registry() -> Registry:
    """Return the registry of the run, or that of all installed plugins."""
    return _registry.get() or default_registry()


class formats_of:  # entered for every step: as a generator it would take three times as long
    """Let a registry be the current one, if there is one."""

    def __init__(self, registry: Registry | None) -> None:
        self._given = registry

    def __enter__(self) -> None:
        self._token = _registry.set(self._given)

    def __exit__(self, *error: object) -> None:
        _registry.reset(self._token)
