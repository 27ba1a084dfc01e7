"""Everything that a plugin can add, on one screen.

A plugin is a module, named in the entry point group ``nodegraph``, that implements any of these
hooks with `hookimpl`. Each is called once, when its result is first needed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import pluggy

from nodegraph.plugin.hook_types import (
    Command,
    Comparison,
    Conclusion,
    Contract,
    Detail,
    Format,
    Renderer,
    Storage,
)

GROUP = "nodegraph"
hookspec = pluggy.HookspecMarker(GROUP)
hookimpl = pluggy.HookimplMarker(GROUP)


@hookspec
def nodegraph_nodes() -> Iterable[Callable[..., Any]]:  # type: ignore[empty-body]
    """Return the plugin's nodes: functions decorated with `nodegraph.node`."""


@hookspec
def nodegraph_node_finders() -> Mapping[str, Callable[[str], Callable[..., Any]]]:  # type: ignore[empty-body]
    """Return, for ``scheme`` in ``use: scheme:name``, a function from the name to a node.

    The function returns one decorated with `nodegraph.node`, whose name the graph's then
    replaces, and raises `nodegraph.NodegraphError` for a name of which there is no node.
    """


@hookspec
def nodegraph_bibtex() -> str:  # type: ignore[empty-body]
    """Return the BibTeX entries that the plugin's nodes cite."""


@hookspec
def nodegraph_renderers() -> Iterable[Renderer]:  # type: ignore[empty-body]
    """Return how values of the plugin's types appear in a report."""


@hookspec
def nodegraph_details() -> Iterable[Detail]:  # type: ignore[empty-body]
    """Return how single blocks of a comparison are shown, by what their scores were given."""


@hookspec
def nodegraph_comparisons() -> Iterable[Comparison]:  # type: ignore[empty-body]
    """Return how the differences of values of the plugin's types are described."""


@hookspec
def nodegraph_conclusions() -> Iterable[Conclusion]:  # type: ignore[empty-body]
    """Return what a study concludes from values of the plugin's types."""


@hookspec
def nodegraph_storages() -> Iterable[Storage]:  # type: ignore[empty-body]
    """Return how values of the plugin's types are stored."""


@hookspec
def nodegraph_formats() -> Iterable[Format]:  # type: ignore[empty-body]
    """Return how values are read from files: see `nodegraph.formats`."""


@hookspec
def nodegraph_executors() -> Mapping[str, Callable[..., Any]]:  # type: ignore[empty-body]
    """Return further ways to compute steps, by name: see `nodegraph.executors.Executor`."""


@hookspec
def nodegraph_places() -> Mapping[str, Callable[[str], Path]]:  # type: ignore[empty-body]
    """Return, for ``scheme`` in a path ``scheme:name``, a function from name to file or folder.

    The function raises `nodegraph.NodegraphError` for an unknown name.
    """


@hookspec
def nodegraph_graphs() -> Iterable[Path]:  # type: ignore[empty-body]
    """Return the example graphs that the plugin ships."""


@hookspec
def nodegraph_templates() -> Mapping[str, Path]:  # type: ignore[empty-body]
    """Return what ``nodegraph new`` writes, by kind: ``plugin``, ``graph``.

    Each is a folder whose files are copied with ``{{name}}`` replaced, in their text and in their
    paths, and ``.template`` removed from the end of their names.
    """


@hookspec
def nodegraph_commands() -> Mapping[str, Command]:  # type: ignore[empty-body]
    """Return further commands of the command line, by name.

    They are looked up for a word that is not a built-in command, and for ``nodegraph help``.
    """


@hookspec
def nodegraph_specimens() -> Mapping[type, Callable[[], Mapping[str, Any]]]:  # type: ignore[empty-body]
    """Return, for each of the plugin's types, a function that makes small values to test nodes on.

    Each value has a name; values of several types that have the same name belong together.
    """


@hookspec
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:  # type: ignore[empty-body]
    """Return what every node of a family promises, third-party nodes included."""
