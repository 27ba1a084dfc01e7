"""The promises of all nodes of one plugin, as one test for pytest."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from nodegraph.errors import UnknownNodeError, nearest
from nodegraph.node.decorator import Node
from nodegraph.plugin.registry import Registry, default_registry
from nodegraph.testing.check import check_node
from nodegraph.testing.specimens import variants


def promises_of(plugin: str | Path) -> Callable[..., None]:
    """Return a test for pytest that checks every node of a plugin.

    Each node is checked with its defaults, and once more with each choice of its settings that is
    not the default (of a ``Literal``, or true or false), see `check_node`.

    Parameters
    ----------
    plugin
        The name of an installed plugin, which is that of its entry point; or a Python file.

    Raises
    ------
    UnknownNodeError
        If no such plugin is installed, or it has no nodes, or it is left out; says why.

    Examples
    --------
    A whole file of tests:

    >>> from nodegraph.testing import promises_of
    >>> test_promises = promises_of("fill")
    """
    import pytest

    registry = _registry(plugin)
    cases = [
        pytest.param(node, choice, id=f"{node.name}{label}")
        for node in _nodes(plugin, registry)
        for label, choice in variants(node)
    ]

    def test_node_keeps_its_promises(node: Node, choice: Mapping[str, Any]) -> None:
        __tracebackhide__ = True
        check_node(node.function, settings=choice, registry=registry)

    parametrized: Callable[..., None] = pytest.mark.parametrize(("node", "choice"), cases)(
        test_node_keeps_its_promises
    )
    return parametrized


def _registry(plugin: str | Path) -> Registry:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what is wrong with other plugins is not asked here
        if Path(plugin).suffix == ".py":
            return Registry.installed([Path(plugin)])
        return default_registry()


def _nodes(plugin: str | Path, registry: Registry) -> list[Node]:
    name = Path(plugin).stem
    found = [one.node for one in registry if one.plugin == name]
    if found:
        return found
    for one in registry.broken:
        if one.name == name:
            raise UnknownNodeError(f"plugin {name!r} is left out: {one.reason}")
    names = sorted({one.plugin for one in registry})
    raise UnknownNodeError(
        f"no plugin {name!r} with nodes is installed; {nearest(name, names)}; a plugin is named by "
        "its entry point in the group 'nodegraph'"
    )
