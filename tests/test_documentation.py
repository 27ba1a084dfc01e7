"""What the READMEs beside graphs and plugins show is true: it loads, runs and passes."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

import pytest

import nodegraph as ng
from nodegraph.plugin import hooks, loading
from nodegraph.plugin.registry import Registry
from tests import readmes
from tests.readmes import ROOT, blocks

GRAPHS = (ROOT / "graphs" / "README.md").read_text()
PLUGINS = (ROOT / "plugins" / "README.md").read_text()
ELSEWHERE = {
    "cd lips": "so does the test",
    "pip install -e .[test]": "tests/test_third_party.py installs a new plugin",
    "pip install nodegraph[testing]": "tests/test_third_party.py installs ours",
    "python -m pytest": "tests/test_third_party.py runs a new plugin's own tests",
    "python -m pytest test_my_nodes.py": "run below, with the node that is shown",
}
"""Commands of the pages that are not the program's, and where they are tried."""


def test_the_graph_that_is_shown_runs(tmp_path: Path) -> None:
    (text,) = blocks(GRAPHS, "yaml")
    path = tmp_path / "graph.yaml"
    path.write_text(text)
    run = ng.run(path, axis={"trial": [0]}, store=tmp_path / "store")
    assert run.ok
    assert set(run["table"].value["smooth"]) == {"without", "order_3", "order_7"}


def test_every_key_of_a_graph_is_told() -> None:
    from nodegraph.graphfile.keys import TOP_LEVEL

    told = set(re.findall(r"^\| `(\w+)` \|", GRAPHS, flags=re.MULTILINE))
    assert told | {"nodegraph", "title", "notes"} == set(TOP_LEVEL)


def test_every_shipped_graph_is_told_with_its_question() -> None:
    told = dict(re.findall(r"^\| `(\w+\.yaml)` \| (.*?) \|", GRAPHS, flags=re.MULTILINE))
    files = {path.name: path for path in (ROOT / "graphs").glob("*.yaml")}
    assert told.keys() == files.keys()
    for name, path in files.items():
        assert ng.load(path).title.split(",")[0].rstrip("?") in told[name]


def test_the_node_that_is_shown_keeps_every_promise_by_the_test_that_is_shown(
    tmp_path: Path,
) -> None:
    for code in blocks(PLUGINS, "python"):
        with (tmp_path / code.partition("\n")[0].removeprefix("# ")).open("a") as file:
            file.write(code)  # a later block goes on where an earlier one ended
    assert {path.name for path in tmp_path.iterdir()} == {"my_nodes.py", "test_my_nodes.py"}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "error"]
    done = subprocess.run(
        [*command, str(tmp_path)], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout


def test_every_hook_and_every_package_is_told() -> None:
    hooked = {name for name in vars(hooks) if name.startswith("nodegraph_")}
    assert set(re.findall(r"^\| `(nodegraph_\w+)` \| ", PLUGINS, flags=re.MULTILINE)) >= hooked
    packages = {path.parent.name for path in (ROOT / "plugins").glob("*/__init__.py")}
    assert packages <= set(re.findall(r"`(nodegraph_\w+)`", PLUGINS))


def test_every_command_beside_the_graphs_does_as_it_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    readmes.write_small_study(tmp_path / "fill.yaml")
    shown = list(readmes.commands(GRAPHS))
    for words in shown:
        readmes.give(words)
    assert [words[1] for words in shown] == ["check", "run", "draw", "new", "lock"]


def test_every_command_beside_the_plugins_does_as_it_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    given = [words for words in readmes.commands(PLUGINS) if readmes.is_ours(words)]
    others = [" ".join(one) for one in readmes.commands(PLUGINS) if not readmes.is_ours(one)]
    assert set(others) == set(ELSEWHERE)
    create, run = given
    readmes.give(create)
    (declared,) = (tomllib.loads(text) for text in blocks(PLUGINS, "toml"))
    ((name, value),) = declared["project"]["entry-points"]["nodegraph"].items()
    monkeypatch.chdir(tmp_path / name)  # as the page says
    monkeypatch.syspath_prepend(tmp_path / name)
    every = [*entry_points(group="nodegraph"), EntryPoint(name, value, "nodegraph")]
    monkeypatch.setattr(loading, "entry_points", lambda *, group: every)
    try:
        assert [one.node.name for one in Registry.installed() if one.plugin == name] == [
            "fill.lips"
        ]
        readmes.give([*run, "--axis", "trial=0"])
    finally:
        for one in [module for module in sys.modules if module.partition(".")[0] == value]:
            del sys.modules[one]
