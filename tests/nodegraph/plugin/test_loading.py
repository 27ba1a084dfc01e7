from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from nodegraph import NodegraphError
from nodegraph.plugin import loading
from nodegraph.plugin.registry import Registry

NODE = """
from nodegraph import node

@node("fill.mine")
def mine(recording: float) -> float:
    return recording
"""
HOOK = """
from nodegraph import hookimpl

@hookimpl
def nodegraph_nodes():
    return [mine]
"""


@pytest.fixture(autouse=True)
def _no_module_stays() -> Iterator[None]:
    before = set(sys.modules)
    yield
    for name in set(sys.modules) - before:
        if name.startswith("toy_"):
            del sys.modules[name]


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def install(monkeypatch: pytest.MonkeyPatch, folder: Path, **entries: str) -> None:
    monkeypatch.syspath_prepend(folder)
    entry_points = [EntryPoint(name, value, "nodegraph") for name, value in entries.items()]
    monkeypatch.setattr(loading, "entry_points", lambda *, group: entry_points)


def test_installed_plugins_come_by_their_entry_points(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    written(tmp_path, "toy_one.py", NODE + HOOK)
    install(monkeypatch, tmp_path, one="toy_one")
    registry = Registry.installed()
    assert [registered.full_name for registered in registry] == ["one:fill.mine"]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("import nowhere_at_all", "No module named 'nowhere_at_all'"),
        ("raise RuntimeError('out of tune')", r"RuntimeError: out of tune \(toy_bad.py:1\)"),
        ("def f(:", "SyntaxError"),
        ("import sys; sys.exit(0)", "SystemExit: 0"),
    ],
)
def test_a_plugin_that_does_not_import_is_named_and_the_rest_go_on(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, text: str, reason: str
) -> None:
    written(tmp_path, "toy_bad.py", text)
    written(tmp_path, "toy_good.py", NODE + HOOK)
    install(monkeypatch, tmp_path, bad="toy_bad", good="toy_good")
    with pytest.warns(UserWarning, match=f"plugin 'bad' is left out: toy_bad: .*{reason}"):
        registry = Registry.installed()
    assert [registered.full_name for registered in registry] == ["good:fill.mine"]


@pytest.mark.parametrize("raised", ["KeyError('lost')", "SystemExit('lost')"])
def test_a_failing_nodes_hook_is_named_with_error_type_and_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, raised: str
) -> None:
    written(tmp_path, "toy_bad.py", HOOK.replace("return [mine]", f"raise {raised}"))
    install(monkeypatch, tmp_path, bad="toy_bad")
    kind = raised.partition("(")[0]
    message = rf"nodegraph_nodes raised {kind}: '?lost'? \(toy_bad.py:6\)"
    with pytest.warns(UserWarning, match=f"plugin 'bad' is left out: {message}$"):
        registry = Registry.installed()
    with pytest.raises(NodegraphError, match=rf"; left out: plugin 'bad' \({message}\)$"):
        registry.find("fill.mine")


def test_a_file_needs_no_hook(tmp_path: Path) -> None:
    plugin = loading.from_file(written(tmp_path, "toy_file.py", NODE))
    assert [each.__name__ for each in plugin.module.nodegraph_nodes()] == ["mine"]


def test_a_file_may_have_the_hook(tmp_path: Path) -> None:
    plugin = loading.from_file(written(tmp_path, "toy_hook.py", NODE + HOOK))
    assert len(plugin.module.nodegraph_nodes()) == 1


def test_a_file_may_have_a_dataclass_as_its_type(tmp_path: Path) -> None:
    text = """
        from __future__ import annotations
        from dataclasses import dataclass
        from nodegraph import Value, node

        @dataclass(frozen=True)
        class Thing(Value):
            size: float

        @node("make.thing")
        def make() -> Thing:
            return Thing(1.0)
        """.replace("\n        ", "\n")
    plugin = loading.from_file(written(tmp_path, "toy_types.py", text))
    registry = Registry.of(plugin.module.nodegraph_nodes())
    assert registry.find("make.thing").node.outputs[0].type.__name__ == "Thing"


def test_a_file_named_like_a_module_leaves_that_module_alone(tmp_path: Path) -> None:
    import statistics

    plugin = loading.from_file(written(tmp_path, "statistics.py", NODE))
    assert plugin.name == "statistics"
    assert sys.modules["statistics"] is statistics


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("toy_raises.py", "1 / 0", r"does not import: ZeroDivisionError.*toy_raises.py:1"),
        ("toy_deep.py", "import json\njson.loads('{')", r"JSONDecodeError: .*\(toy_deep.py:2\)$"),
        ("toy_name.py", NODE.replace("fill.mine", "Mine"), r"import: 'Mine' .*\(toy_name.py:4\)$"),
        ("toy_syntax.py", "def f(:", r"import: SyntaxError: [^()]*\(toy_syntax.py, line 1\)$"),
        ("toy_exits.py", "raise SystemExit(0)", "does not import: SystemExit"),
        ("toy_text.txt", "", r"suffix \.py"),
    ],
)
def test_a_file_that_does_not_import_is_refused(
    tmp_path: Path, name: str, text: str, message: str
) -> None:
    with pytest.raises(NodegraphError, match=message):
        loading.from_file(written(tmp_path, name, text))
    assert Path(name).stem not in sys.modules


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(NodegraphError, match="no such plugin file"):
        loading.from_file(tmp_path / "none.py")


def test_a_file_named_like_an_installed_plugin_is_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    written(tmp_path, "toy_one.py", NODE + HOOK)
    install(monkeypatch, tmp_path, fill="toy_one")
    with pytest.raises(NodegraphError, match="a plugin 'fill' is already registered"):
        Registry.installed([written(tmp_path, "fill.py", NODE)])


def test_a_file_whose_node_cannot_be_read_is_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    install(monkeypatch, tmp_path)
    text = NODE.replace("-> float", "-> None | float")
    with pytest.raises(NodegraphError, match=r"toy_out.py: .*fill\.mine: output"):
        Registry.installed([written(tmp_path, "toy_out.py", text)])


def test_a_file_with_other_hooks_needs_no_node(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    install(monkeypatch, tmp_path)
    text = HOOK.replace("nodegraph_nodes", "nodegraph_bibtex").replace("[mine]", "'@misc{a}'")
    assert Registry.installed([written(tmp_path, "toy_cites.py", text)]).hooks.of("bibtex") == (
        "@misc{a}",
    )


def test_a_file_that_is_read_again_takes_the_place_of_the_first(tmp_path: Path) -> None:
    path = tmp_path / "read_again.py"
    path.write_text("number = 1\n")
    first = loading.from_file(path).module
    path.write_text("number = 2\n\n")
    second = loading.from_file(path).module
    assert (first.number, second.number) == (1, 2)
    assert sys.modules["read_again"] is second
    path.write_text("number = 1 / 0\n\n\n")
    with pytest.raises(NodegraphError, match="ZeroDivisionError"):
        loading.from_file(path)
    assert sys.modules.pop("read_again") is second


def test_a_module_that_is_no_plugin_keeps_its_name(tmp_path: Path) -> None:
    path = tmp_path / "json.py"
    path.write_text("number = 1\n")
    loading.from_file(path)
    assert hasattr(sys.modules["json"], "dumps")


def test_a_file_may_call_another_plugin_s_node(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    written(tmp_path, "toy_one.py", NODE + HOOK)
    install(monkeypatch, tmp_path, one="toy_one")
    text = """
from toy_one import mine
from nodegraph import node

@node("fill.twice")
def twice(recording: float) -> float:
    return mine(mine(recording))

same = twice
"""
    registry = Registry.installed([written(tmp_path, "toy_caller.py", text)])
    assert [registered.full_name for registered in registry] == [
        "one:fill.mine",
        "toy_caller:fill.twice",
    ]
