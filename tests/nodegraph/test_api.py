from __future__ import annotations

import json
import resource
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import nodegraph as ng
from nodegraph.api import reported
from nodegraph.cli.main import main
from nodegraph.execute.events import Event
from nodegraph.graph import Graph
from nodegraph.plugin import loading
from nodegraph.plugin.registry import Registry, default_registry
from tests.records import read_record

TEXT = """\
nodegraph: 1
inputs: {start: 3}
axes: {k: [1, 2], j: [3, 4]}
nodes:
  a: {use: read.number, with: {start: $start}}
  b: {use: gaps.cut, in: a, with: {length: $k, seed: $j}}
  fill: {in: b, alternatives: fill.*}
  table: {use: compare.table, in: fill}
  extra: {use: fill.hold, in: fill}
"""
FIVE_LINES = """\
from nodegraph import node
@node("fill.mine")
def mine(recording: float, *, max_gap: int | None = None) -> float:
    return recording * 100
"""


@pytest.fixture(autouse=True)
def _only_toys(monkeypatch: pytest.MonkeyPatch, toys: Registry) -> None:
    described = [entry.node.function for entry in toys]

    class Module:
        nodegraph_nodes = staticmethod(lambda: described)

    monkeypatch.setattr(loading, "installed", lambda: ([loading.Plugin("toys", Module)], []))
    default_registry.cache_clear()


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "graph.yaml"
    path.write_text(TEXT)
    return path


def labels(graph: Graph) -> dict[str, tuple[object, ...]]:
    return {name: axis.labels for name, axis in graph.axes.items()}


def test_completion_lists_the_public_names() -> None:
    assert {"load", "run", "get_node", "node", "hookimpl"} <= set(dir(ng))
    assert not {"execute", "errors", "Any"} & set(dir(ng))


def test_load_run_and_take_values(file: Path) -> None:
    graph = ng.load(file)
    run = ng.run(graph, axis={"k": [1]}, only={"fill": ["hold"], "j": 3})
    assert run["fill"].at(k=1, j=3, fill="hold") == pytest.approx(3.3)
    assert run["fill"].value == pytest.approx(3.3)
    assert len(run["table"].value.scores) == 1
    assert ng.get_node("fill.hold")(1.0) == 2.0


def test_a_path_runs_too(file: Path) -> None:
    assert ng.run(str(file), set={"start": 10}, executor="serial")["a"].value == 10


def test_choices_of_run_come_on_top_of_those_of_load(file: Path) -> None:
    graph = ng.load(file, set={"start": 10}, axis={"k": [7, 8]}, only={"j": [4]})
    run = ng.run(graph, only={"k": [8]})
    assert run["a"].value == 10
    assert labels(run.plan.graph) == {"k": (8,), "j": (4,), "fill": ("hold", "scale")}
    again = ng.run(graph, set={"start": 20}, axis={"k": [9]})
    assert again["a"].value == 20
    assert labels(again.plan.graph)["k"] == (9,)
    assert labels(graph)["k"] == (7, 8)


def test_a_single_label_needs_no_list(file: Path) -> None:
    assert labels(ng.load(file, only={"fill": "scale"}))["fill"] == ("scale",)


def test_a_file_of_five_lines_joins_its_family(file: Path, tmp_path: Path) -> None:
    plugin = tmp_path / "my_fill.py"
    plugin.write_text(FIVE_LINES)
    graph = ng.load(file, plugins=[plugin])
    assert labels(graph)["fill"] == ("hold", "mine", "scale")
    run = ng.run(graph, only={"fill": "mine", "k": 1, "j": 3})
    assert run["fill"].value == pytest.approx(230)
    assert ng.run(ng.load(file), plugins=[str(plugin)])["fill"].run.plan.graph.axes["fill"].labels


WRITER = """\
from nodegraph import Files, node
@node("write.txt")
def txt(value: float) -> Files:
    return Files({"value.txt": str(value).encode()})
"""


@pytest.fixture
def saved(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A run of stored results, saved from Python in ``saved`` and by the command in ``ran``."""
    monkeypatch.chdir(tmp_path)
    Path("writer.py").write_text(WRITER)
    choices: dict[str, Any] = {"set": {"start": 7}, "axis": {"k": [1, 5]}, "only": {"j": 3}}
    ng.run(file.name, plugins=["writer.py"], **choices)
    ng.run(file.name, plugins=["writer.py"], **choices).save("saved")
    words = ["--set", "start=7", "--axis", "k=1,5", "--only", "j=3", "--plugin", "writer.py"]
    assert main(["run", file.name, *words, "--out", "ran"]) == 0
    return tmp_path


def without_times(path: Path) -> dict[str, object]:
    record = read_record(path)
    for part in (record, *record["steps"]):
        del part["seconds"]
    return record


def test_a_saved_run_is_what_the_command_writes(saved: Path) -> None:
    here, there = saved / "saved", saved / "ran"
    names = {path.relative_to(here) for path in here.rglob("*")}
    assert names == {path.relative_to(there) for path in there.rglob("*")}
    assert without_times(here) == without_times(there)
    assert (here / "graph.yaml").read_bytes() == (there / "graph.yaml").read_bytes()
    kinds = [
        [json.loads(line)["event"] for line in (folder / "events.jsonl").read_text().splitlines()]
        for folder in (here, there)
    ]
    assert kinds[0] == kinds[1]
    assert without_times(here)["settings"] == {
        "graph": "graph.yaml",
        "set": {"start": 7},
        "axis": {"k": [1, 5]},
        "only": {"j": [3]},
        "plugins": ["writer.py"],
    }


def test_commands_work_on_a_saved_run(saved: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["diff", "saved", "ran"]) == 0
    assert main(["cite", "saved"]) == 0
    assert main(["report", "saved", "ran", "--out", "both.html"]) == 0
    assert main(["archive", "saved"]) == 0
    words = ["--at", "k=5,fill=hold", "--plugin", "writer.py", "--out", "extra.txt"]
    assert main(["export", "saved", "extra", *words]) == 0
    assert Path("extra.txt").read_text() == "4.3"
    assert "fill.hold" in capsys.readouterr().out


def test_a_run_is_saved_over_another_run_only(file: Path, tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    run = ng.run(file)
    run.save(folder / "toy")
    run.save(str(folder / "toy"))
    assert [path.name for path in folder.iterdir()] == ["toy"]
    ng.run(file, cache=False).save(folder / "toy")
    assert len(list(folder.iterdir())) == 2
    with pytest.raises(ng.NodegraphError, match=r"graph\.yaml"):
        run.save(file)


def test_a_saved_run_has_all_files_but_those_that_cannot_be_written(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    file.write_text(f"{TEXT}  text: {{use: write.txt, in: a}}\n")
    Path("writer.py").write_text(WRITER.replace("str(value).encode()", "b'x' * 500_000"))
    run = ng.run(file.name, plugins=["writer.py"], cache=False)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (400_000, hard))
    try:
        with pytest.raises(ng.NodegraphError, match=r"value\.txt: cannot be written: File too"):
            run.save("saved")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    record = json.loads(Path("saved/run.json").read_text())
    [lost] = record["not_written"]
    assert lost == {"file": "text/value.txt", "reason": "File too large"}
    assert not list(Path("saved/text").iterdir())
    assert "File too large" in Path("saved/report.html").read_text()
    assert main(["report", "saved"]) == 0


def test_listeners_hear_the_run(file: Path) -> None:
    events: list[Event] = []
    ng.run(file, listeners=[events.append], jobs=2)
    assert (events[0].kind, events[-1].kind) == ("planned", "finished")


def test_an_error_is_raised_before_anything_runs(file: Path, calls: list[str]) -> None:
    file.write_text(TEXT.replace("fill.hold", "fill.hodl"))
    with pytest.raises(ng.GraphError, match=r"graph\.yaml:9:16: no node 'fill\.hodl'"):
        ng.run(file)
    assert calls == []
    with pytest.raises(ng.GraphError, match="no such graph file"):
        ng.load(file.with_name("grap.yaml"))


def test_what_is_reported(graph_of: Callable[..., Graph]) -> None:
    text = TEXT.partition("\n")[2]
    assert reported(graph_of(text)) == ("table", "extra")
    assert reported(graph_of(f"{text}report: [fill, b.truth, b]")) == ("fill", "b")


def test_every_public_name_is_there() -> None:
    assert all(getattr(ng, name) is not None for name in ng.__all__)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = ng.nothing
