"""The file formats of the plugins in use, for nodes that read files."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
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
    registry = _registry.get() or default_registry()
    return tuple(each for each in registry.hooks.formats if issubclass(each.type, kind))


@contextmanager
def formats_of(registry: Registry | None) -> Iterator[None]:
    """Let `formats` return those of a registry."""
    token = _registry.set(registry)
    try:
        yield
    finally:
        _registry.reset(token)
