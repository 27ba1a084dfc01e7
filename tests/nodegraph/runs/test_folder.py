from __future__ import annotations

import json
from pathlib import Path

import pytest

from nodegraph import NodegraphError
from nodegraph.execute.events import Event
from nodegraph.runs.folder import RunFolder


def finished(path: Path, content: bytes = b"x") -> RunFolder:
    folder = RunFolder(path, "nodegraph: 1\n")
    folder.hear(Event("planned", 0.0, detail={"steps": 1}))
    for name, data in {"run.json": b"{}", "report.html": content, "t/t.csv": b"a,b"}.items():
        folder.write(name, data)
    folder.close()
    return folder


def names(path: Path) -> list[str]:
    return sorted(str(file.relative_to(path)) for file in path.rglob("*") if file.is_file())


def test_a_run_writes_graph_events_files_and_record(tmp_path: Path) -> None:
    path = tmp_path / "runs" / "fill"
    assert finished(path).moved is None
    assert names(path) == ["events.jsonl", "graph.yaml", "report.html", "run.json", "t/t.csv"]
    assert (path / "graph.yaml").read_text() == "nodegraph: 1\n"
    assert (path / "run.json").read_text() == "{}"
    (line,) = (path / "events.jsonl").read_text().splitlines()
    assert json.loads(line) == {"event": "planned", "seconds": 0.0, "steps": 1}


def test_an_event_is_written_as_it_happens(tmp_path: Path) -> None:
    folder = RunFolder(tmp_path / "run", "")
    folder.hear(Event("started", 1.0, 3, "a", {"k": 1}))
    assert '"started"' in (tmp_path / "run" / "events.jsonl").read_text()
    folder.close()


def test_a_finished_run_is_moved_aside_and_never_lost(tmp_path: Path) -> None:
    path = tmp_path / "run"
    for content in (b"first", b"second", b"third"):
        folder = finished(path, content)
    assert folder.moved is not None
    assert (path / "report.html").read_bytes() == b"third"
    contents = {(path / "report.html").read_bytes() for path in tmp_path.iterdir()}
    assert contents == {b"first", b"second", b"third"}


def test_a_run_that_was_interrupted_makes_room(tmp_path: Path) -> None:
    path = tmp_path / "run"
    RunFolder(path, "old").close()
    assert finished(path).moved is None
    assert (path / "graph.yaml").read_text() == "nodegraph: 1\n"
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


@pytest.mark.parametrize(("done", "folders"), [(0, 1), (1, 2)])
def test_a_run_that_ended_without_any_result_makes_room(
    tmp_path: Path, done: int, folders: int
) -> None:
    path = tmp_path / "run"
    folder = RunFolder(path, "old")
    counts = {"done": done, "stored": 0, "refused": 0, "failed": 1}
    folder.write("run.json", json.dumps({"counts": counts}).encode())
    folder.close()
    finished(path)
    assert len(list(tmp_path.iterdir())) == folders


def test_a_file_of_the_user_in_an_interrupted_run_is_never_lost(tmp_path: Path) -> None:
    path = tmp_path / "run"
    RunFolder(path, "old").close()
    (path / "thesis.txt").write_text("years of work")
    finished(path)
    assert [path.read_text() for path in tmp_path.rglob("thesis.txt")] == ["years of work"]


def test_an_empty_folder_is_used(tmp_path: Path) -> None:
    assert finished(tmp_path).moved is None
    assert (tmp_path / "run.json").is_file()


def test_a_folder_that_is_not_a_run_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("years of work")
    with pytest.raises(NodegraphError, match="is not a run folder"):
        RunFolder(tmp_path, "")
    with pytest.raises(NodegraphError, match=r"thesis\.txt"):
        RunFolder(tmp_path / "thesis.txt", "")
    assert names(tmp_path) == ["thesis.txt"]


def test_a_folder_that_cannot_be_made_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(NodegraphError, match="the run cannot be written there"):
        RunFolder(tmp_path / "file" / "run", "")


def test_a_run_that_cannot_begin_leaves_the_earlier_one_where_it_was(tmp_path: Path) -> None:
    path = tmp_path / "run"
    finished(path, b"first")
    folder = RunFolder(path, "nodegraph: 1\n")
    folder.hear(Event("planned", 0.0))
    folder.abandon()
    assert [path.name for path in tmp_path.iterdir()] == ["run"]
    assert (path / "report.html").read_bytes() == b"first"


def test_a_run_that_has_begun_is_not_undone(tmp_path: Path) -> None:
    path = tmp_path / "run"
    folder = RunFolder(path, "nodegraph: 1\n")
    folder.hear(Event("done", 0.0, 0, "a"))
    folder.abandon()
    assert (path / "events.jsonl").is_file()


def test_graphs_that_are_used_lie_where_they_are_looked_for(tmp_path: Path) -> None:
    used = {"parts/inner.yaml": "inner", "../outside.yaml": "not here"}
    RunFolder(tmp_path / "run", "outer", used).close()
    assert (tmp_path / "run" / "parts" / "inner.yaml").read_text() == "inner"
    assert not (tmp_path / "outside.yaml").exists()


def test_a_run_that_is_going_on_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "run"
    going = RunFolder(path, "first")
    going.hear(Event("planned", 0.0, detail={"steps": 1}))
    with pytest.raises(NodegraphError, match="another run is writing there; name another folder"):
        RunFolder(path, "second")
    assert (path / "graph.yaml").read_text() == "first"
    going.write("report.html", b"x")
    going.close()
    assert len((path / "events.jsonl").read_text().splitlines()) == 1
    assert finished(path).moved is not None


def test_a_link_that_another_user_put_into_a_run_is_not_followed(tmp_path: Path) -> None:
    other = tmp_path / "other"
    finished(other)
    before = {name: (other / name).read_bytes() for name in names(other)}
    folder = RunFolder(tmp_path / "run", "")
    (tmp_path / "run" / "t").symlink_to(other / "t")
    (tmp_path / "run" / "report.html").symlink_to(other / "report.html")
    with pytest.raises(OSError, match="run/t is a symbolic link, which is not followed"):
        folder.write("t/t.csv", b"")
    folder.write("report.html", b"")
    folder.close()
    assert {name: (other / name).read_bytes() for name in names(other)} == before


def test_a_run_may_be_written_through_a_link_to_a_folder(tmp_path: Path) -> None:
    (tmp_path / "disk").mkdir()
    (tmp_path / "runs").symlink_to(tmp_path / "disk")
    finished(tmp_path / "runs" / "fill")
    assert "fill/t/t.csv" in names(tmp_path / "disk")


def test_the_folder_does_not_depend_on_the_working_directory_of_nodes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = RunFolder(Path("runs/fill"), "")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    folder.write("report.html", b"x")
    folder.close()
    assert "report.html" in names(tmp_path / "runs" / "fill")
    assert not names(tmp_path / "elsewhere")
