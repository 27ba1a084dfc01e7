"""Families whose promises a node is tried by."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

import pytest

from nodegraph import node
from nodegraph.node.decorator import node_of
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry
from nodegraph.testing import check_node


class Family:
    """A family whose promises one plugin states, tried on specimens of motion capture.

    Parameters
    ----------
    name
    plugin
        By default the one of the family's name.
    """

    def __init__(self, name: str, plugin: str = "") -> None:
        self._name = name
        plugins = [
            Plugin(each, import_module(f"nodegraph_{each}")) for each in ("mocap", plugin or name)
        ]
        self._registry = Registry(loaded=plugins)

    def accepts(self, function: Callable[..., object], **settings: object) -> None:
        """Check that a function keeps every promise, a node already or not."""
        if node_of(function) is None:
            function = node(f"{self._name}.tried")(function)
        check_node(function, settings=settings, registry=self._registry)

    def refuses(self, function: Callable[..., object], text: str) -> str:
        """Check that a function breaks the promise that a regular expression finds in the error.

        Returns
        -------
        str
            What the error says.
        """
        with pytest.raises(AssertionError, match=text) as caught:
            self.accepts(function)
        return str(caught.value)
