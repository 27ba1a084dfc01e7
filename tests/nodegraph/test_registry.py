from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from nodegraph import NodegraphError, Rendered, Renderer, get_node, hookimpl, node, plugins
from nodegraph.errors import UnknownNodeError
from nodegraph.plugins import BrokenPlugin, Plugin
from nodegraph.registry import Registry, default_registry


@node("fill.hold")
def hold(x: float) -> float:
    return x


@node("fill.hold")
def other_hold(x: float) -> float:
    return -x


@node("fill.other")
def other(x: float) -> float:
    return x


def plugin(name: str, *nodes: Callable[..., Any], **hooks: Any) -> Plugin:
    given = {"nodegraph_nodes": lambda: nodes, **hooks}
    marked = {key: hookimpl(function) for key, function in given.items()}
    return Plugin(name, SimpleNamespace(**marked), f"{name}-package 1.0")


@pytest.fixture
def install(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Registry]:
    def install_only(*good: Plugin, broken: tuple[BrokenPlugin, ...] = ()) -> Registry:
        monkeypatch.setattr(plugins, "installed", lambda: (list(good), list(broken)))
        return Registry.installed()

    return install_only


def test_a_node_is_found_by_its_name_and_with_its_plugin(
    install: Callable[..., Registry],
) -> None:
    registry = install(plugin("one", hold, other))
    found = registry.find("fill.hold")
    assert found.node.function is hold
    assert (found.full_name, found.distribution) == ("one:fill.hold", "one-package 1.0")
    assert registry.find("one:fill.hold") is found
    assert [one.node.name for one in registry] == ["fill.hold", "fill.other"]
    assert registry.families == ("fill",)


def test_a_name_claimed_by_two_plugins_names_both(install: Callable[..., Registry]) -> None:
    registry = install(plugin("one", hold), plugin("two", other_hold, other))
    with pytest.raises(UnknownNodeError, match=r"one:fill\.hold and two:fill\.hold"):
        registry.find("fill.hold")
    assert registry.find("two:fill.hold").node.function is other_hold
    assert list(registry.family("fill")) == ["one:hold", "two:hold", "other"]


def test_a_name_that_is_not_there_hints_at_its_family(install: Callable[..., Registry]) -> None:
    registry = install(plugin("one", hold))
    with pytest.raises(UnknownNodeError, match=r"did you mean 'fill\.hold'"):
        registry.find("fill.hodl")


def test_a_plugin_whose_nodes_cannot_be_read_is_left_out_whole(
    install: Callable[..., Registry],
) -> None:
    @node("fill.bad")
    def bad(x: Any) -> float:
        return 0.0

    with pytest.warns(UserWarning, match=r"plugin 'two' is left out: NodeError: fill\.bad"):
        registry = install(plugin("one", hold), plugin("two", other, bad))
    assert [one.full_name for one in registry] == ["one:fill.hold"]
    with pytest.raises(UnknownNodeError, match=r"left out.*plugin 'two'"):
        registry.find("fill.other")


def test_a_plugin_that_gives_something_else_than_nodes_is_named(
    install: Callable[..., Registry],
) -> None:
    with pytest.warns(UserWarning, match=r"plugin 'two'.*len is not a node"):
        install(plugin("two", len))


def test_two_plugins_of_one_name_are_told_apart_or_refused(
    install: Callable[..., Registry],
) -> None:
    with pytest.warns(UserWarning, match="plugin 'one' is left out: .*is there already"):
        registry = install(plugin("one", hold), plugin("one", other))
    assert [one.full_name for one in registry] == ["one:fill.hold"]
    assert registry.graphs == {}


def test_what_else_plugins_bring_is_put_together(
    install: Callable[..., Registry], tmp_path: Path
) -> None:
    shown = Renderer(float, lambda value, title: Rendered(""))

    def places() -> Mapping[str, Callable[[str], Path]]:
        return {"sample": lambda name: tmp_path / name}

    registry = install(
        plugin("one", nodegraph_bibtex=lambda: "@misc{a}", nodegraph_places=places),
        plugin(
            "two",
            nodegraph_bibtex=lambda: "@misc{b}",
            nodegraph_graphs=lambda: [Path("x/fill.yaml")],
            nodegraph_renderers=lambda: [shown],
        ),
    )
    assert set(registry.bibtex) == {"@misc{a}", "@misc{b}"}
    assert registry.graphs == {"fill": Path("x/fill.yaml")}
    assert registry.renderers == (shown,)
    assert registry.place("sample:face") == tmp_path / "face"
    assert registry.place("other:face") is None
    assert registry.place("face.c3d") is None


def test_get_node_gives_the_function_itself(
    monkeypatch: pytest.MonkeyPatch, install: Callable[..., Registry]
) -> None:
    registry = install(plugin("one", hold))
    monkeypatch.setattr("nodegraph.registry.default_registry", lambda: registry)
    assert get_node("fill.hold") is hold
    with pytest.raises(NodegraphError):
        get_node("fill.none")


def test_what_is_installed_is_read_once(install: Callable[..., Registry]) -> None:
    install(plugin("one", hold))
    default_registry.cache_clear()
    try:
        assert default_registry() is default_registry()
    finally:
        default_registry.cache_clear()
