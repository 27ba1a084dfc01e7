"""What the READMEs beside graphs and plugins show is true: it loads, runs and passes."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

import nodegraph as ng
from nodegraph import hooks

ROOT = Path(__file__).parents[1]
GRAPHS = (ROOT / "graphs" / "README.md").read_text()
PLUGINS = (ROOT / "plugins" / "README.md").read_text()


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


def test_the_graph_that_is_shown_runs(tmp_path: Path) -> None:
    (text,) = blocks(GRAPHS, "yaml")
    path = tmp_path / "graph.yaml"
    path.write_text(text)
    run = ng.run(path, axis={"trial": [0]}, store=tmp_path / "store")
    assert run.ok
    assert set(run["table"].value["smooth"]) == {"without", "order_3", "order_7"}


def test_every_key_of_a_graph_is_told() -> None:
    from nodegraph.spec.file import _KEYS

    told = set(re.findall(r"^\| `(\w+)` \|", GRAPHS, flags=re.MULTILINE))
    assert told | {"nodegraph", "title", "notes"} == set(_KEYS)


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


@pytest.mark.parametrize("text", [GRAPHS, PLUGINS], ids=["graphs", "plugins"])
def test_every_command_that_is_shown_is_one(text: str) -> None:
    from nodegraph.options import parser

    commands = next(one.choices for one in parser()._actions if one.choices)
    lines = [line for block in blocks(text, "sh") for line in block.splitlines()]
    used = {line.split()[1] for line in lines if line.startswith("nodegraph ")}
    assert used
    assert used <= set(commands or ())
