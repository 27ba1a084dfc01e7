"""One pytest test for the promises of every node of a plugin."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from pathlib import Path

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
        The name of an installed plugin's entry point, or a Python file.

    Raises
    ------
    UnknownNodeError
        If no such plugin is installed, or it has no nodes, or it is left out.

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

    def test_node_keeps_its_promises(node: Node, choice: Mapping[str, object]) -> None:
        __tracebackhide__ = True
        check_node(node.function, settings=choice, registry=registry)

    parametrized: Callable[..., None] = pytest.mark.parametrize(("node", "choice"), cases)(
        test_node_keeps_its_promises
    )
    return parametrized


def _registry(plugin: str | Path) -> Registry:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # faults of other plugins do not matter here
        if Path(plugin).suffix == ".py":
            return Registry.installed([Path(plugin)])
        return default_registry()


def _nodes(plugin: str | Path, registry: Registry) -> list[Node]:
    name = Path(plugin).stem
    nodes = [registered.node for registered in registry if registered.plugin == name]
    if nodes:
        return nodes
    for broken in registry.broken:
        if broken.name == name:
            raise UnknownNodeError(f"plugin {name!r} is left out: {broken.reason}")
    names = sorted({registered.plugin for registered in registry})
    raise UnknownNodeError(
        f"no plugin {name!r} with nodes is installed; {nearest(name, names)}; a plugin has the "
        "name of its entry point in the group 'nodegraph'"
    )
