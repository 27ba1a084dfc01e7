"""What the README shows is true: its graph checks, its code runs, its table of nodes is whole."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

import nodegraph as ng
from nodegraph.cli import main
from nodegraph.registry import Registry

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


def table_of_nodes() -> str:
    """Return the README's table of nodes as it should be now."""
    nodes = [one.node for one in Registry.installed()]
    rows = [f"| `{node.name}` | {node.summary} |" for node in nodes]
    return "\n".join(["| node | what it does |", "|---|---|", *rows])


def test_the_graph_is_a_good_one(tmp_path: Path) -> None:
    graph, _ = blocks("yaml")
    path = tmp_path / "graph.yaml"
    path.write_text(graph)
    assert list(ng.load(path).nodes) == ["capture", "gaps", "fill", "error", "table"]


def test_the_picture_shows_the_graph(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "graph.yaml").write_text(blocks("yaml")[0])
    assert main(["draw", str(tmp_path / "graph.yaml")]) == 0
    (picture,) = re.findall(r'<img src="(.*?)"', README)
    assert capsys.readouterr().out.strip() == (ROOT / picture).read_text().strip()


def test_the_graph_that_stands_where_a_node_does_is_a_good_one(tmp_path: Path) -> None:
    graph, clean = blocks("yaml")
    (tmp_path / "clean.yaml").write_text(clean)
    use, fixed = re.findall(r"`(?:clean: )?({(?:use|from): .*?}+)`", README)[-2:]
    path = tmp_path / "graph.yaml"
    more = f"  clean: {use}\n  one: {{use: fill.linear, in: {fixed}}}\nreport: [table, one, clean]"
    path.write_text(graph.replace("report: [table]", more))
    loaded = ng.load(path, only={"clean.fill": "lin"})
    assert loaded.nodes["clean"].axes == ("trial", "length", "clean.fill")
    assert {"clean.fill", "one"} <= loaded.nodes.keys()


def test_the_method_that_it_adds_joins_the_comparison(tmp_path: Path) -> None:
    code = next(block for block in blocks("python") if block.startswith("# my_fill.py"))
    (tmp_path / "my_fill.py").write_text(code)
    run = ng.run(
        ROOT / "graphs" / "fill.yaml",
        plugins=[tmp_path / "my_fill.py"],
        axis={"trial": [0]},
        only={"length": [5], "fill": ["first", "linear"]},
    )
    assert run.ok
    table = run["table"].value
    assert set(table["fill"]) == {"first", "linear"}
    filled = run["fill"].at(fill="first", trial=0, length=5)
    gappy = run["gaps"].at(trial=0, length=5)
    assert filled.present.sum() > gappy.present.sum()


def test_the_walk_from_python_runs_as_it_stands() -> None:
    code = next(block for block in blocks("python") if "ng.run(" in block)
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_the_table_of_nodes_is_that_of_the_installed_ones() -> None:
    found = README.partition("<!-- nodes -->\n")[2].partition("\n<!-- end of nodes -->")[0]
    assert found == table_of_nodes()


def test_continuous_integration_runs_the_command_that_stands_here() -> None:
    script = (ROOT / ".ci" / "run").read_text()
    assert "<!-- the tests -->" in script
    command = README.partition("<!-- the tests -->\n```sh\n")[2].partition("\n```")[0]
    assert command.endswith("-m pytest -n 2")


def test_values_are_exported_as_it_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    lines = [line for block in blocks("sh") for line in block.splitlines()]
    exports = [line.split()[1:] for line in lines if line.startswith("nodegraph export")]
    words = ["--axis", "trial=[3]", "--only", "length=45", "--only", "fill=muscle"]
    assert main(["run", str(ROOT / "graphs" / "fill.yaml"), *words]) == 0
    for one in exports:
        assert main(one) == 0
        assert (tmp_path / one[-1]).stat().st_size > 1000
    assert len(exports) == 3
