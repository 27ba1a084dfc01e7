"""Files, read by the nodes that read their formats."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from nodegraph.errors import NodegraphError, listed, nearest, quoted
from nodegraph.execute.call import Call, collecting_warnings, perform
from nodegraph.formatting import size_text
from nodegraph.node.decorator import Node
from nodegraph.plugin.formats import formats_of
from nodegraph.plugin.hook_types import Fact
from nodegraph.plugin.registry import Registered, Registry
from nodegraph.state import State
from nodegraph.validation_errors import first_error

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


def read_files(
    words: Iterable[str], registry: Registry, settings: Mapping[str, object] = MappingProxyType({})
) -> list[ReadFile]:
    """Read files, each by the first node that reads files of its format.

    Parameters
    ----------
    words
        Files, folders that hold one, or ``scheme:name`` with the scheme of a plugin.
    registry
    settings
        By name, for those nodes that have them.

    Raises
    ------
    NodegraphError
        If there is no such file, it is too large, no node reads it, a setting is not valid, or the
        file is damaged; with the place in it.
    """
    files = [_read_file(word, registry, settings) for word in dict.fromkeys(words)]
    nodes = dict.fromkeys(file.node for file in files)
    known = dict.fromkeys(name for node in nodes for name in registry.find(node).node.settings)
    for name in settings:
        if name not in known:
            hint = nearest(name, known, what="settings")
            raise NodegraphError(f"{listed(nodes)}: no setting {quoted(name)}; {hint}")
    return files


def _read_file(word: str, registry: Registry, settings: Mapping[str, object]) -> ReadFile:
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
                return _read(word, path, registry.find(name), form, registry, settings)
    known = dict.fromkeys(each.name for each in registry.hooks.formats)
    raise NodegraphError(f"{word}: no node reads it; formats that are read: {listed(known)}")


def _recognized(word: str, path: Path, format_for: Any) -> str | None:
    try:
        form: str | None = format_for(path)
    except ValueError as error:
        raise NodegraphError(f"{word}: {error}") from None
    return form


def _read(
    word: str,
    path: Path,
    entry: Registered,
    form: str,
    registry: Registry,
    settings: Mapping[str, object],
) -> ReadFile:
    known = _validated(word, entry.node, {**settings, "path": str(path)})
    with collecting_warnings():
        outcome = perform(Call(0, entry.node, entry.plugin, {}, known, registry=registry))
    if outcome.state is not State.DONE:
        named = [name for name in entry.node.settings if f"`{name}`" in outcome.reason]
        hint = f"; write --with {named[0]}=VALUE" if named else ""
        raise NodegraphError(f"{outcome.reason}{hint}")
    value = outcome.values[0]
    kind = registry.hooks.kind(type(value), "facts")
    facts = tuple(kind.facts(value)) if kind is not None and kind.facts is not None else ()
    return ReadFile(word, entry.node.name, form, value, facts, outcome.warnings)


def _validated(word: str, node: Node, settings: Mapping[str, object]) -> dict[str, object]:
    """Return the settings of a node, with its defaults; others are left out."""
    from pydantic import ValidationError

    own = {name: value for name, value in settings.items() if name in node.settings}
    try:
        model = node.model.model_validate_json(json.dumps(own))
    except ValidationError as error:
        raise NodegraphError(f"{word}: {first_error(error, own)}") from None
    return {name: getattr(model, name) for name in node.settings}
