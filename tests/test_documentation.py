"""What the guides to graphs and plugins show is true: it loads, runs and passes."""

from __future__ import annotations

import os
import re
import runpy
import subprocess
import sys
import tomllib
from contextlib import nullcontext
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import nodegraph as ng
from nodegraph.cli.main import main
from nodegraph.graphfile.yaml_text import read_yaml
from nodegraph.plugin import loading
from nodegraph.plugin.registry import Registry
from nodegraph.testing import check_node, same
from nodegraph_mocap import Origin
from tests import readmes
from tests.readmes import ROOT, blocks

README = (ROOT / "README.md").read_text()
PAGES = ROOT / "nodegraph" / "site" / "pages"
GRAPHS = (PAGES / "language.md").read_text() + (ROOT / "graphs" / "README.md").read_text()
LIVE = (PAGES / "live.md").read_text()
NODES = (ROOT / "plugins" / "nodes.md").read_text()
PLUGINS = (PAGES / "plugins.md").read_text() + (ROOT / "plugins" / "README.md").read_text()
OTHER_COMMANDS = {
    "cd lips": "so does the test",
    "pip install -e .[test]": "tests/test_third_party.py installs a new plugin",
    "pip install nodegraph[testing]": "tests/test_third_party.py installs ours",
    "python -m pytest": "tests/test_third_party.py runs a new plugin's own tests",
    "python -m pytest test_my_nodes.py": "run below, with the node that is shown",
}
"""Commands of the pages that are not of this program, and where they are tested."""


def test_the_graph_that_is_shown_runs(tmp_path: Path) -> None:
    text, *_ = blocks(GRAPHS, "yaml")
    path = tmp_path / "graph.yaml"
    path.write_text(text)
    run = ng.run(path, axis={"trial": [0]}, store=tmp_path / "store")
    assert run.ok
    assert set(run["table"].value["smooth"]) == {"without", "order_3", "order_7"}


def test_the_graph_used_as_a_node_loads(tmp_path: Path) -> None:
    (graph,), (_, _, clean) = blocks(README, "yaml"), blocks(GRAPHS, "yaml")
    (tmp_path / "clean.yaml").write_text(clean)
    (use,) = re.findall(r"`clean: ({use: .*?}+)`", GRAPHS)
    (fixed,) = re.findall(r"`({from: clean, .*?}+)`", GRAPHS)
    path = tmp_path / "graph.yaml"
    more = f"  clean: {use}\n  line: {{use: fill.linear, in: {fixed}}}\n"
    path.write_text(graph.replace("report: [table]", f"{more}report: [table, line, clean]"))
    loaded = ng.load(path, only={"clean.fill": "lin"})
    assert loaded.nodes["clean"].axes == ("trial", "length", "clean.fill")
    assert {"clean.fill", "line"} <= loaded.nodes.keys()


def test_every_installed_node_is_listed() -> None:
    nodes = [entry.node for entry in Registry.installed()]
    rows = [f"| `{node.name}` | {node.summary} |" for node in nodes]
    assert NODES.endswith("\n".join(["| node | what it does |", "|---|---|", *rows, ""]))


def test_every_key_of_a_graph_is_documented() -> None:
    from nodegraph.graphfile.keys import TOP_LEVEL

    documented = set(re.findall(r"^\| `(\w+)` \|", GRAPHS, flags=re.MULTILINE))
    assert documented | {"nodegraph", "title", "notes"} == set(TOP_LEVEL)


def test_every_shipped_graph_is_listed_with_its_question() -> None:
    questions = dict(re.findall(r"^\| `(\w+\.yaml)` \| (.*?) \|", GRAPHS, flags=re.MULTILINE))
    files = {path.name: path for path in (ROOT / "graphs").glob("*.yaml")}
    assert questions.keys() == files.keys()
    for name, path in files.items():
        # not loaded: the files that a graph names by their addresses need not be here
        title = read_yaml(path.read_text(), name).plain()["title"]
        assert title.split(",")[0].rstrip("?") in questions[name]


def test_the_code_that_is_shown_works(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for code in blocks(PLUGINS, "python"):
        with (tmp_path / code.partition("\n")[0].removeprefix("# ")).open("a") as file:
            file.write(code)  # a later block continues where an earlier one ended
    files = {path.name for path in tmp_path.iterdir()}
    assert files == {
        *(
            "my_nodes.py",
            "test_my_nodes.py",
            "my_type.py",
            "my_table.py",
            "my_kind.py",
            "my_card.py",
            "my_format.py",
        ),
        *("my_network.py", "my_command.py"),
    }
    runpy.run_path(str(tmp_path / "my_table.py"))
    check_own_type(tmp_path)
    assert main(["show", "read", "--plugin", str(tmp_path / "my_format.py")]) == 0
    assert "read.recording" in capsys.readouterr().out
    assert main(["lips", "take.c3d", "--plugin", str(tmp_path / "my_command.py")]) == 0
    assert capsys.readouterr().out == "Two lips in take.c3d\n"
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "error"]
    alone = os.environ | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # other plugins take a second
    result = subprocess.run(
        [*command, str(tmp_path)],
        cwd=tmp_path, env=alone, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert result.returncode == 0, result.stdout


def test_the_live_forms_that_are_shown_keep_their_promises(tmp_path: Path) -> None:
    for code in blocks(LIVE, "python"):
        path = tmp_path / code.partition("\n")[0].removeprefix("# ")
        path.write_text(code)
        registry = Registry.installed([path])
        for entry in registry:
            if entry.plugin == path.stem:
                check_node(entry.node.function, registry=registry)


def test_the_commands_for_streams_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (graph,) = blocks(LIVE, "yaml")
    (tmp_path / "face.yaml").write_text(graph)
    for words in readmes.commands(LIVE):
        readmes.run_command(words)
    assert "fill(fill=muscle): leaves gaps at the start of the take missing" in (
        capsys.readouterr().out.replace("fill(fill=guenter), ", "")
    )
    run = ng.run(tmp_path / "face.yaml", only={"fill": ["muscle"]}, store=tmp_path / "store")
    begun = np.maximum.accumulate(run["despike"].value.present, axis=0).all(axis=1)
    for name, node in (("muscle", "smooth"), ("still", "still"), ("again", "still")):
        streamed = ng.get_node("read.recording")(path=tmp_path / f"{name}.npz")
        start = int(np.argmax(begun)) + 2  # a spline of order 3 sees one frame before
        assert same(streamed.positions[start:], run[node].value.positions[start:]), name
        assert same(streamed.origin[start:], run[node].value.origin[start:]), name


def check_own_type(folder: Path) -> None:
    """Check that a value of the documented type is stored, and comes back as it was."""
    graph = folder / "opening.yaml"
    graph.write_text(
        "nodegraph: 1\n"
        "nodes:\n"
        "  capture: {use: read.recording, with: {path: sample:actor_a}}\n"
        "  lips: {use: lips.opening, in: capture}\n"
    )
    runs = [
        ng.run(graph, plugins=[folder / "my_type.py"], store=folder / "store") for _ in range(2)
    ]
    assert runs[1].counts()["stored"] == 2
    first, second = (run["lips"].value for run in runs)
    assert (first.distances == second.distances).all()
    assert first.markers == second.markers


def test_a_network_fills_what_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def load(path: str, map_location: str) -> SimpleNamespace:
        return SimpleNamespace(eval=lambda: one_further)

    def one_further(positions: Any, present: Any) -> SimpleNamespace:
        assert not positions[~present].any()
        return SimpleNamespace(numpy=lambda: positions + 1.0)

    torch = SimpleNamespace(  # what the example takes from it, which is not installed for tests
        jit=SimpleNamespace(load=load),
        from_numpy=lambda array: array,
        inference_mode=nullcontext,
    )
    monkeypatch.setitem(sys.modules, "torch", torch)
    code = next(code for code in blocks(PLUGINS, "python") if code.startswith("# my_network.py"))
    (tmp_path / "my_network.py").write_text(code)
    fill = runpy.run_path(str(tmp_path / "my_network.py"))["network"]
    recording = ng.get_node("read.recording")(path="sample:actor_a")
    gappy = ng.get_node("gaps.cut")(recording, length=15).gappy
    filled = fill(gappy, weights=tmp_path / "weights.pt")
    middle = gappy.positions[gappy.present].mean(axis=0)
    assert (filled.positions[gappy.present] == gappy.positions[gappy.present]).all()
    assert abs(filled.positions[~gappy.present] - middle - 1.0).max() < 1e-9
    assert (filled.origin[~gappy.present] == Origin.FILLED).all()


def test_every_package_is_listed() -> None:
    packages = {path.parent.name for path in (ROOT / "plugins").glob("*/__init__.py")}
    assert packages <= set(re.findall(r"`(nodegraph_\w+)`", PLUGINS))


def test_the_commands_for_graphs_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    readmes.write_small_study(tmp_path / "fill.yaml")
    commands = list(readmes.commands(GRAPHS))
    for words in commands:
        readmes.run_command(words)
    assert [words[1] for words in commands] == ["check", "run", "draw", "new", "schema", "lock"]


def test_the_commands_for_plugins_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    commands = list(readmes.commands(PLUGINS))
    others = {" ".join(words) for words in commands if not readmes.is_ours(words)}
    assert others == set(OTHER_COMMANDS)
    create, run = filter(readmes.is_ours, commands)
    readmes.run_command(create)
    (declared,) = (tomllib.loads(text) for text in blocks(PLUGINS, "toml"))
    ((name, value),) = declared["project"]["entry-points"]["nodegraph"].items()
    monkeypatch.chdir(tmp_path / name)  # as the page says
    monkeypatch.syspath_prepend(tmp_path / name)
    plugins = [*entry_points(group="nodegraph"), EntryPoint(name, value, "nodegraph")]
    monkeypatch.setattr(loading, "entry_points", lambda *, group: plugins)
    try:
        assert [entry.node.name for entry in Registry.installed() if entry.plugin == name] == [
            "fill.lips"
        ]
        readmes.run_command([*run, "--axis", "trial=0"])
    finally:
        for module in [module for module in sys.modules if module.partition(".")[0] == value]:
            del sys.modules[module]
