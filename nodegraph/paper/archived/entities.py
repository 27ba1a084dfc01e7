"""The entities of an archive's description, each there once, by its identifier."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from urllib.parse import quote

from nodegraph.errors import NodegraphError

VERSION = "1.1"
"""Of RO-Crate."""


class Entities:
    """What a crate describes.

    Raises
    ------
    NodegraphError
        If the package that writes it is not installed.
    """

    def __init__(self) -> None:
        try:
            from rocrate.rocrate import ROCrate
        except ModuleNotFoundError as error:
            if (error.name or "").partition(".")[0] != "rocrate":
                raise
            raise NodegraphError(
                "an archive needs what is not installed; pip install 'nodegraph[archive]'"
            ) from error
        self.crate = ROCrate(version=VERSION)

    def add(self, identifier: str, kind: str, **described: Any) -> Any:
        """Return what is described under an identifier; it is added unless it is there."""
        from rocrate.model import ContextEntity

        there = self.crate.get(identifier)
        if there is not None:
            return there
        properties = {"@type": kind, **described}
        return self.crate.add(ContextEntity(self.crate, identifier, properties))

    def add_file(self, name: str, described: Mapping[str, Any]) -> Any:
        """Add a file of the archive."""
        from rocrate.model import DataEntity

        return self.crate.add(DataEntity(self.crate, quote(name), dict(described)))

    def file(self, name: str) -> Any:
        """Return a file of the archive, or None."""
        return self.crate.get(quote(name))


def append(entity: Any, name: str, value: Any) -> None:
    """Add a reference, once, to those that an entity has under a name."""
    there = entity.get(name, [])
    known = there if isinstance(there, list) else [there]
    if value not in known:
        entity[name] = [*known, value] if known else value
