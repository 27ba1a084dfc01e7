"""Names of files that are valid on other machines."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import nodegraph as ng
from nodegraph import NodegraphError, Refusal, node
from nodegraph.execute.results import Run
from nodegraph.lock.lockfile import lock_of
from nodegraph.lock.portable import FileNames, portable, refuse_paths, relative
from nodegraph.lock.results import Results


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("study/graphs/a.c3d", "a.c3d"),
        ("study/data/a.c3d", "../data/a.c3d"),
        ("study/graphs/deep/a.c3d", "deep/a.c3d"),
        ("a.c3d", "../../a.c3d"),
    ],
)
def test_a_file_near_the_graph_has_a_relative_path(tmp_path: Path, path: str, name: str) -> None:
    assert relative(tmp_path / path, tmp_path / "study" / "graphs") == name


def test_a_file_of_another_tree_has_only_its_name() -> None:
    root = Path(Path.cwd().anchor)
    assert relative(root / "data" / "a.c3d", root / "studies" / "graphs") == "a.c3d"


def test_a_file_of_another_user_has_only_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Path, "home", lambda: tmp_path / "users" / "one")
    users = tmp_path / "users"
    assert relative(users / "two" / "a.c3d", users / "one" / "graphs") == "a.c3d"
    assert relative(users / "one" / "a.c3d", users / "one" / "graphs") == "../a.c3d"


def test_a_text_must_not_contain_paths_of_a_folder(tmp_path: Path) -> None:
    refuse_paths("nothing\nof that", [tmp_path, Path(tmp_path.anchor)])
    with pytest.raises(NodegraphError, match=r"see .*notes\.txt$"):
        refuse_paths(f"nothing\n  see {tmp_path}/notes.txt\n", [tmp_path])


def test_what_is_not_installed_is_no_version(tmp_path: Path) -> None:
    (tmp_path / "half.py").write_text(
        "from nodegraph import node\n"
        "@node('half.number')\n"
        "def number(*, optional: bool = False) -> float:\n"
        "    if optional:\n"
        "        import nobody_has_this as yaml\n"
        "    else:\n"
        "        import yaml\n"
        "    return float(yaml.safe_load('1'))\n"
    )
    graph = tmp_path / "graph.yaml"
    graph.write_text("nodegraph: 1\nnodes: {a: {use: half.number}}\n")
    run = ng.run(ng.load(graph, plugins=[tmp_path / "half.py"]), store=tmp_path / "store")
    versions = lock_of(run, tmp_path / "graph.lock").record.versions
    assert "PyYAML" in versions
    assert "nobody_has_this" not in versions


def test_a_reason_contains_no_path_of_this_machine(
    run_of: Callable[..., Run], tmp_path: Path
) -> None:
    @node("strict.refuses")
    def refuses() -> float:
        raise Refusal(f"{tmp_path}/deep/some.txt  is empty")

    run = run_of("nodes: {a: {use: strict.refuses}}", more=[refuses])
    [step] = portable(run, FileNames(run.plan.graph), Results(run)).steps
    assert step.ending == "refused: some.txt is empty"
