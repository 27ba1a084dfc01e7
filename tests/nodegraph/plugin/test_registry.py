"""Names and the nodes that have them; a plugin that cannot be used is named and left out."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from nodegraph import get_node, node
from nodegraph.errors import UnknownNodeError
from nodegraph.plugin import loading
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry, default_registry

Install = Callable[..., Registry]


@node("fill.hold")
def hold(x: float) -> float:
    return x


@node("fill.hold")
def other_hold(x: float) -> float:
    return -x


@node("fill.other")
def other(x: float) -> float:
    return x


@node("fill.bad")
def bad(x: Any) -> float:
    return 0.0


def names(registry: Registry) -> list[str]:
    return [registered.full_name for registered in registry]


def test_a_node_is_found_by_its_name_with_or_without_its_plugin(install: Install) -> None:
    registry = install(one={"nodes": [hold, other]})
    registered = registry.find("fill.hold")
    assert registered.node.function is hold
    assert (registered.full_name, registered.distribution) == ("one:fill.hold", "one-package 1.0")
    assert registry.find("one:fill.hold") is registered
    assert names(registry) == ["one:fill.hold", "one:fill.other"]
    assert registry.families == ("fill",)


def test_a_name_claimed_by_two_plugins_names_both(install: Install) -> None:
    registry = install(one={"nodes": [hold]}, two={"nodes": [other_hold, other]})
    with pytest.raises(UnknownNodeError, match=r"one:fill\.hold .* two:fill\.hold"):
        registry.find("fill.hold")
    assert registry.find("two:fill.hold").node.function is other_hold
    assert list(registry.family("fill")) == ["one:hold", "two:hold", "other"]


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("fill.hodl", r"'fill\.hold'"),
        ("fil.hold", r"did you mean 'fill\.hold'"),
        ("hold", r"did you mean 'fill\.hold'"),
        ("fill.first", r"a node of a plugin file needs --plugin FILE; there is: fill\.hold"),
        ("fill", r"it is a family: fill\.hold"),
        ("a.b", "--plugin"),
    ],
)
def test_an_unknown_name_hints_at_what_there_is(install: Install, name: str, hint: str) -> None:
    with pytest.raises(UnknownNodeError, match=f"{name}.*{hint}"):
        install(one={"nodes": [hold]}).find(name)


def hook_that_fails() -> object:
    return [1 / 0]


@pytest.mark.parametrize(
    ("nodes", "reason"),
    [
        ([other, bad], r"fill\.bad"),
        ([len], "len is not a node"),
        ([other, hold, other_hold], r"two nodes of the name fill\.hold"),
        (hook_that_fails, r"raised ZeroDivisionError.* \(test_registry\.py:\d+\)"),
        (None, r"nodegraph_nodes returned NoneType: return \[node, \.\.\.\]"),
        (5, r"nodegraph_nodes returned int"),
    ],
)
def test_a_plugin_whose_nodes_cannot_be_read_is_left_out_whole(
    install: Install, nodes: object, reason: str
) -> None:
    with pytest.warns(UserWarning, match=f"plugin 'bad' is left out: .*{reason}"):
        registry = install(bad={"nodes": nodes}, good={"nodes": [hold]})
    assert names(registry) == ["good:fill.hold"]
    with pytest.raises(UnknownNodeError, match=f"left out.*plugin 'bad'.*{reason}"):
        registry.find("fill.other")


def test_a_node_that_is_listed_twice_is_there_once(install: Install) -> None:
    registry = install(one={"nodes": [hold, hold]}, two={"nodes": [other]})
    assert names(registry) == ["one:fill.hold", "two:fill.other"]


@pytest.mark.parametrize("name", ["one", "two"])
def test_a_plugin_of_a_name_or_a_module_that_is_registered_is_left_out(
    install: Install, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    first = install(one={"nodes": [hold], "bibtex": "@misc{a}"}).loaded[0]
    module = first.module if name == "two" else Plugin
    plugins = [first, Plugin(name, module)]
    monkeypatch.setattr(loading, "installed", lambda: (plugins, []))
    with pytest.warns(UserWarning, match=f"plugin '{name}' is left out: .*'one'"):
        registry = Registry.installed()
    assert names(registry) == ["one:fill.hold"]
    assert registry.hooks.of("bibtex") == ("@misc{a}",)


def test_get_node_returns_the_function_itself(
    monkeypatch: pytest.MonkeyPatch, install: Install
) -> None:
    registry = install(one={"nodes": [hold]})
    monkeypatch.setattr("nodegraph.plugin.registry.default_registry", lambda: registry)
    assert get_node("fill.hold") is hold
    with pytest.raises(UnknownNodeError):
        get_node("fill.none")


def test_installed_plugins_are_read_once(install: Install) -> None:
    install(one={"nodes": [hold]})
    default_registry.cache_clear()
    try:
        assert default_registry() is default_registry()
    finally:
        default_registry.cache_clear()


def test_nodes_of_plugins_without_a_hook_can_be_left_out_but_not_those_of_files(
    tmp_path: Path,
) -> None:
    file = tmp_path / "own.py"
    lines = ("from nodegraph import node", "", "@node('fill.own')")
    file.write_text("\n".join([*lines, "def own(x: float) -> float:", "    return x", ""]))
    registry = Registry.installed([file], nodes_with="readers")
    assert {each.plugin for each in registry} == {"files", "own"}
    assert {plugin.name for plugin in registry.loaded} >= {"fill", "mocap"}
