"""One file, read by the node that reads files of its format."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nodegraph.errors import NodegraphError, listed
from nodegraph.execute.call import Call, collecting_warnings, perform
from nodegraph.formatting import size_text
from nodegraph.plugin.formats import formats_of
from nodegraph.plugin.hook_types import Fact
from nodegraph.plugin.registry import Registry
from nodegraph.state import State

_LARGEST = 10**9
"""Bytes of a file that is read as a whole; numbers take two to four times as much in memory."""


@dataclass(frozen=True)
class ReadFile:
    """A file and the value that a node has read from it.

    Attributes
    ----------
    path : str
        As the user named it.
    node : str
    format : str
    value : Any
        The node's first output.
    facts : tuple of Fact
    warnings : tuple of str
        What the node guessed or left out.
    """

    path: str
    node: str
    format: str
    value: Any
    facts: tuple[Fact, ...]
    warnings: tuple[str, ...]


def is_file(word: str, registry: Registry) -> bool:
    """Return whether a word names a file or a folder: one that is there, or by its form."""
    path = Path(word)
    suffixes = {suffix for each in registry.hooks.formats for suffix in each.suffixes}
    has_form = len(path.parts) > 1 or path.suffix.lower() in suffixes
    return has_form or path.exists() or registry.hooks.is_place(word)


def read_file(word: str, registry: Registry) -> ReadFile:
    """Read a file by the first node that reads files of its format.

    Parameters
    ----------
    word
        A file, a folder that holds one, or ``scheme:name`` with the scheme of a plugin.
    registry

    Raises
    ------
    NodegraphError
        If there is no such file, it is too large, no node reads it, or it is damaged; with the
        place in the file.
    """
    path = registry.hooks.place(word) or Path(word)
    if not path.exists():
        raise NodegraphError(f"{word}: no such file")
    if path.is_file() and path.stat().st_size > _LARGEST:
        raise NodegraphError(
            f"{word}: {size_text(path.stat().st_size)}; files of up to {size_text(_LARGEST)} are "
            "shown: cut out a part of it first"
        )
    with formats_of(registry):
        for name, format_for in registry.hooks.of("readers").items():
            form = _recognized(word, path, format_for)
            if form:
                return _read(word, path, registry, name, form)
    known = dict.fromkeys(each.name for each in registry.hooks.formats)
    raise NodegraphError(f"{word}: no node reads it; formats that are read: {listed(known)}")


def _recognized(word: str, path: Path, format_for: Any) -> str | None:
    try:
        form: str | None = format_for(path)
    except ValueError as error:
        raise NodegraphError(f"{word}: {error}") from None
    return form


def _read(word: str, path: Path, registry: Registry, name: str, form: str) -> ReadFile:
    entry = registry.find(name)
    settings = {**entry.node.defaults, "path": path}
    with collecting_warnings():
        call = Call(0, entry.node, entry.plugin, {}, settings, registry=registry)
        outcome = perform(call)
    if outcome.state is not State.DONE:
        raise NodegraphError(outcome.reason)
    value = outcome.values[0]
    kind = registry.hooks.kind(type(value), "facts")
    facts = tuple(kind.facts(value)) if kind is not None and kind.facts is not None else ()
    return ReadFile(word, name, form, value, facts, outcome.warnings)
