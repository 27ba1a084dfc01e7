"""A registry of plugins that are made in a test."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import SimpleNamespace

import pytest

from nodegraph import hookimpl
from nodegraph.plugin import loading
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry


@pytest.fixture
def install(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Registry]:
    """Return the registry of an environment in which only these plugins are installed.

    A plugin is a mapping of hooks, without ``nodegraph_``, to functions or to what they return.
    """

    def install_only(**plugins: Mapping[str, object]) -> Registry:
        loaded = [
            Plugin(name, SimpleNamespace(**dict(map(_hook, hooks.items()))), f"{name}-package 1.0")
            for name, hooks in plugins.items()
        ]
        monkeypatch.setattr(loading, "installed", lambda: (loaded, []))
        return Registry.installed()

    return install_only


def _hook(item: tuple[str, object]) -> tuple[str, Callable[[], object]]:
    name, value = item
    return f"nodegraph_{name}", hookimpl(value if callable(value) else lambda: value)
