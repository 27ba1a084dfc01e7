"""The file formats of the plugins in use, for nodes that read files."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from nodegraph.plugin.hook_types import Format
from nodegraph.plugin.registry import Registry, default_registry

registry_of_call: ContextVar[Registry | None] = ContextVar("registry_of_call", default=None)
"""The registry of the run, if there is one."""


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
    return registry_of_call.get() or default_registry()


@contextmanager
def formats_of(registry: Registry | None) -> Iterator[None]:
    """Let a registry be the current one, if there is one."""
    token = registry_of_call.set(registry)
    try:
        yield
    finally:
        registry_of_call.reset(token)
