from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from nodegraph import NodegraphError, Rendered, Renderer, get_node, hookimpl, node
from nodegraph.errors import UnknownNodeError
from nodegraph.plugin import loading
from nodegraph.plugin.loading import BrokenPlugin, Plugin
from nodegraph.plugin.registry import Registry, default_registry


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
        monkeypatch.setattr(loading, "installed", lambda: (list(good), list(broken)))
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

    with pytest.warns(UserWarning, match=r"plugin 'two' is left out: fill\.bad"):
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
    assert [one.type for one in registry.renderers] == [shown.type]
    assert registry.place("sample:face") == tmp_path / "face"
    assert registry.place("other:face") is None
    assert registry.place("face.c3d") is None


def test_get_node_gives_the_function_itself(
    monkeypatch: pytest.MonkeyPatch, install: Callable[..., Registry]
) -> None:
    registry = install(plugin("one", hold))
    monkeypatch.setattr("nodegraph.plugin.registry.default_registry", lambda: registry)
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


def bibtex_that_fails() -> str:
    raise RuntimeError("out of ink")


def graphs_that_end_early() -> Iterator[Path]:
    yield Path("a.yaml")
    raise RuntimeError("out of paper")


NONSENSE: dict[str, tuple[dict[str, Any], str, str]] = {
    "raises": (
        {"nodegraph_bibtex": bibtex_that_fails},
        "bibtex",
        r"its hook nodegraph_bibtex is left out: RuntimeError: out of ink \(test_registry.py:\d+\)",
    ),
    "raises on the way": (
        {"nodegraph_graphs": graphs_that_end_early},
        "graphs",
        "its hook nodegraph_graphs is left out: RuntimeError: out of paper",
    ),
    "exits": (
        {"nodegraph_renderers": lambda: sys.exit("enough")},
        "renderers",
        "its hook nodegraph_renderers is left out: SystemExit: enough",
    ),
    "another kind": (
        {"nodegraph_templates": lambda: ["plugin"]},
        "templates",
        "its hook nodegraph_templates is left out: it returned list where a mapping is due",
    ),
    "a text for a list": (
        {"nodegraph_graphs": lambda: "graphs/lips.yaml"},
        "graphs",
        "its hook nodegraph_graphs is left out: it returned str where a list is due",
    ),
    "a list for a text": (
        {"nodegraph_bibtex": lambda: ["@misc{a}"]},
        "bibtex",
        "its hook nodegraph_bibtex is left out: it returned list where a text is due",
    ),
    "something else in the list": (
        {"nodegraph_renderers": lambda: [float]},
        "renderers",
        "what nodegraph_renderers lists is left out: <class 'float'> is not a Renderer",
    ),
    "a text for a type": (
        {"nodegraph_renderers": lambda: [Renderer("float", print)]},  # type: ignore[arg-type]
        "renderers",
        r"its hook nodegraph_renderers is left out: TypeError: Renderer: type must be a type, not "
        r"'float' \(test_registry.py:\d+\)",
    ),
    "no path for a template": (
        {"nodegraph_templates": lambda: {"mine": 3}},
        "templates",
        "'mine' of nodegraph_templates is left out: 3 is not a path",
    ),
    "no text for a name": (
        {"nodegraph_templates": lambda: {7: Path("mine")}},
        "templates",
        "7 of nodegraph_templates is left out: 7 is not a text",
    ),
}


@pytest.mark.parametrize("name", NONSENSE)
def test_a_hook_that_fails_or_returns_nonsense_is_told_and_the_rest_go_on(
    install: Callable[..., Registry], name: str
) -> None:
    broken, what, said = NONSENSE[name]
    shown = Renderer(float, lambda value, title: Rendered(""))
    good = plugin(
        "good",
        hold,
        nodegraph_bibtex=lambda: "@misc{b}",
        nodegraph_renderers=lambda: [shown],
        nodegraph_graphs=lambda: [Path("x/fill.yaml")],
        nodegraph_templates=lambda: {"lips": Path("lips")},
    )
    registry = install(plugin("bad", other, **broken), good)
    with pytest.warns(UserWarning, match=f"plugin 'bad': {said}"):
        found = getattr(registry, what)
    if what == "renderers":
        found = tuple(one.type for one in found)
    whole = {
        "bibtex": ("@misc{b}",),
        "renderers": (float,),
        "graphs": {"fill": Path("x/fill.yaml")},
        "templates": {"lips": Path("lips")},
    }
    assert found == whole[what]
    assert [one.full_name for one in registry] == ["good:fill.hold", "bad:fill.other"]


def test_a_name_that_another_plugin_has_is_told_and_stays_the_first_s(
    install: Callable[..., Registry], tmp_path: Path
) -> None:
    def places(folder: str) -> Callable[[], Mapping[str, Callable[[str], Path]]]:
        return lambda: {"sample": lambda name: tmp_path / folder / name}

    registry = install(
        plugin("one", nodegraph_places=places("one")), plugin("two", nodegraph_places=places("two"))
    )
    said = "plugin 'two': 'sample' of nodegraph_places is left out: plugin 'one' has that name"
    with pytest.warns(UserWarning, match=said):
        assert registry.place("sample:face") == tmp_path / "one" / "face"


def test_a_hook_with_arguments_or_of_no_known_name_is_told(
    install: Callable[..., Registry],
) -> None:
    def bibtex(style: str) -> str:
        return style

    registry = install(
        plugin("one", hold, nodegraph_bibtex=bibtex),
        plugin("two", other, nodegraph_bibtext=lambda: "@misc{a}"),
        plugin("three", nodegraph_bibtex=lambda: "@misc{b}"),
    )
    with pytest.warns(UserWarning, match="plugin '(one|two)': .* left out: ") as told:
        assert registry.bibtex == ("@misc{b}",)
    texts = [str(one.message) for one in told]
    assert len(texts) == 2
    assert texts[0].startswith("plugin 'one': its hooks are left out: ")
    assert "nodegraph_bibtext is left out: there is no such hook; did you mean" in texts[1]
    assert len(list(registry)) == 2


@pytest.mark.parametrize("nodes", [None, 5, hold])
def test_nodes_that_are_no_list_are_told(install: Callable[..., Registry], nodes: Any) -> None:
    bad = plugin("bad", nodegraph_nodes=lambda: nodes)
    said = "plugin 'bad' is left out: .*nodegraph_nodes returned .*: return \\[node, ...\\]"
    with pytest.warns(UserWarning, match=said):
        registry = install(bad, plugin("good", hold))
    assert [one.full_name for one in registry] == ["good:fill.hold"]


def test_a_hook_of_nodes_that_fails_is_told(install: Callable[..., Registry]) -> None:
    with pytest.warns(UserWarning, match="plugin 'bad' is left out: .*raised ZeroDivisionError"):
        registry = install(plugin("bad", nodegraph_nodes=lambda: [1 / 0]), plugin("good", hold))
    assert [one.full_name for one in registry] == ["good:fill.hold"]


def test_a_node_that_is_listed_twice_is_there_once(install: Callable[..., Registry]) -> None:
    registry = install(plugin("one", hold, hold), plugin("two", other))
    assert [one.full_name for one in registry] == ["one:fill.hold", "two:fill.other"]


def test_two_nodes_of_one_name_in_one_plugin_are_told(install: Callable[..., Registry]) -> None:
    with pytest.warns(UserWarning, match="'one' is left out: .*two nodes of the name fill.hold"):
        registry = install(plugin("one", hold, other, other_hold), plugin("two", other))
    assert [one.full_name for one in registry] == ["two:fill.other"]


def test_one_module_by_two_names_is_told(install: Callable[..., Registry]) -> None:
    one = plugin("one", hold, nodegraph_bibtex=lambda: "@misc{a}")
    with pytest.warns(UserWarning, match="plugin 'two' is left out: .*plugin 'one' is the same"):
        registry = install(one, Plugin("two", one.module))
    assert [one.full_name for one in registry] == ["one:fill.hold"]
    assert registry.bibtex == ("@misc{a}",)
