"""``archive`` writes one file that runs again elsewhere, and holds no path of this machine."""

from __future__ import annotations

import gzip
import hashlib
import json
import os
import sys
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest

from tests.nodegraph.cli.conftest import Command
from tests.records import read_record, steps_of

READER = """

from nodegraph import InputFile

@node("toy.read")
def read(*, path: InputFile) -> float:
    '''Read a number.'''
    return float(path.read_text())

@node("toy.breaks")
def breaks(x: float, *, path: InputFile) -> float:
    raise ValueError(f"{path.absolute()}: no good")
"""
GRAPH = """\
nodegraph: 1
title: "Numbers <in> files"
inputs: {start: numbers/one.txt, factor: 2}
axes: {length: [1, 5]}
nodes:
  a: {use: toy.read, with: {path: $start}}
  b: {use: toy.read, with: {path: ABSOLUTE}}
  gaps: {use: toy.cut, in: a, with: {length: $length}}
  fill: {in: gaps, alternatives: fill.*}
  total: {use: toy.sum, in: fill}
  scaled: {use: toy.number, with: {start: $factor}}
"""


@pytest.fixture(autouse=True)
def _study(tmp_path: Path) -> None:
    """A graph that reads a file beside it, and one that lies elsewhere."""
    Path("toys.py").write_text(Path("toys.py").read_text() + READER)
    (tmp_path / "far away").mkdir()
    (tmp_path / "far away" / "two.txt").write_text("2.5")
    Path("study/numbers").mkdir(parents=True)
    Path("study/numbers/one.txt").write_text("17.5")
    text = GRAPH.replace("ABSOLUTE", json.dumps(str(tmp_path / "far away" / "two.txt")))
    Path("study/toy.yaml").write_text(text)


def ran(command: Command, *words: str) -> int:
    return command("run", "study/toy.yaml", "--store", "kept", "--out", "ran", *words)[0]


def archived(command: Command, *words: str) -> tuple[dict[str, bytes], str]:
    Path("ran.zip").unlink(missing_ok=True)
    status, _, err = command("archive", "ran", *words, nodes=False)
    assert status == 0, err
    with zipfile.ZipFile("ran.zip") as file:
        assert file.testzip() is None
        return {name: file.read(name) for name in file.namelist()}, err


def metadata(files: dict[str, bytes]) -> dict[str, dict[str, Any]]:
    described = json.loads(files["ro-crate-metadata.json"])
    assert described["@context"][0] == "https://w3id.org/ro/crate/1.1/context"
    entities = {entity["@id"]: entity for entity in described["@graph"]}
    assert len(entities) == len(described["@graph"])
    return entities


def references(value: object) -> Iterator[str]:
    if isinstance(value, dict):
        if set(value) == {"@id"}:
            yield value["@id"]
        for part in value.values():
            yield from references(part)
    elif isinstance(value, list):
        for part in value:
            yield from references(part)


@pytest.mark.parametrize(
    "name", ["a\\..\\b.txt", "C:b.txt", "con", "two\nlines", os.fsdecode(b"\xff.txt")]
)
def test_names_in_the_folder_of_a_run_that_not_every_system_takes_are_left_out(
    command: Command, name: str
) -> None:
    ran(command)
    Path("ran", name).write_text("mine")
    files, err = archived(command)
    assert len([line for line in err.splitlines() if "not every system takes" in line]) == 1
    assert not any(content == b"mine" for content in files.values())


def test_links_in_the_folder_of_a_run_are_left_out(command: Command, tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("mine")
    ran(command)
    Path("ran/notes.txt").symlink_to(tmp_path / "secret")
    files, err = archived(command)
    assert "run/notes.txt: a symbolic link" in err
    assert b"mine" not in files.values()


def test_every_file_is_described_as_it_is(command: Command) -> None:
    assert ran(command) == 0
    files, err = archived(command)
    assert err == ""
    entities = metadata(files)
    described = {
        unquote(at): entity for at, entity in entities.items() if "File" in str(entity["@type"])
    }
    assert described.keys() == files.keys() - {"ro-crate-metadata.json"}
    for name, entity in described.items():
        assert entity["sha256"] == hashlib.sha256(files[name]).hexdigest()
        assert int(entity["contentSize"]) == len(files[name])
    parts = {unquote(entity["@id"]) for entity in entities["./"]["hasPart"]}
    assert parts == described.keys()
    for entity in entities.values():
        for at in references({name: part for name, part in entity.items() if name != "@id"}):
            assert at in entities or at.startswith("https://w3id.org/ro/crate/"), at


def test_the_description_is_that_of_a_workflow_run(command: Command) -> None:
    assert ran(command) == 0
    files, _ = archived(command)
    entities = metadata(files)
    root = entities["./"]
    profiles = {entity["@id"] for entity in root["conformsTo"]}
    assert "https://w3id.org/ro/wfrun/workflow/0.5" in profiles
    main = entities[root["mainEntity"]["@id"]]
    assert main["@type"] == ["File", "SoftwareSourceCode", "ComputationalWorkflow"]
    assert main["@id"] == "toy.yaml"
    action = entities[root["mentions"]["@id"]]
    assert action["@type"] == "CreateAction"
    assert action["instrument"] == {"@id": "toy.yaml"}
    assert action["actionStatus"] == "http://schema.org/CompletedActionStatus"
    assert action["startTime"] <= action["endTime"]
    read = {entity["@id"] for entity in action["object"]}
    parameters_read = {"#value-factor", "#labels-length", "#labels-fill"}
    assert read == {"numbers/one.txt", "inputs/two.txt", *parameters_read}
    results = {entity["@id"] for entity in action["result"]}
    assert results == {name for name in files if name.startswith("run/")}
    assert {"run/report.html", "run/run.json", "run/steps.jsonl.gz"} <= results
    assert entities["numbers/one.txt"]["exampleOfWork"] == {"@id": "#input-start"}
    assert entities["#input-start"]["additionalType"] == "File"
    assert entities["#value-factor"]["value"] == 2
    parameters = {entity["@id"] for entity in main["input"]}
    assert parameters == {"#input-start", "#input-factor", "#axis-length", "#axis-fill"}


def test_the_same_run_gives_the_same_bytes(command: Command) -> None:
    assert ran(command) == 0
    archived(command)
    first = Path("ran.zip").read_bytes()
    archived(command)
    assert Path("ran.zip").read_bytes() == first


def test_no_path_of_this_machine_is_in_it(command: Command, tmp_path: Path) -> None:
    text = Path("study/toy.yaml").read_text()
    # failures say where something lies, and so may an input that is not used
    text = text.replace("factor: 2", "factor: 2, unread: /somebody/elses/disk/take.txt")
    text += "  bad: {use: toy.breaks, in: b, with: {path: $start}}\n"
    text += "  odd: {use: text.of, with: {text: $unread}}\n"
    Path("study/toy.yaml").write_text(text)
    nodes = Path("toys.py").read_text()
    Path("toys.py").write_text(
        nodes + '\n@node("text.of")\ndef of(*, text: str) -> str:\n    return text\n'
    )
    words = (
        "--plugin",
        str(tmp_path / "toys.py"),
        "--set",
        f"start={tmp_path}/study/numbers/one.txt",
    )
    status = command(
        "run", str(tmp_path / "study/toy.yaml"), *words, "--store", str(tmp_path / "kept"),
        "--out", "ran", nodes=False,
    )[0]  # fmt: skip
    assert status == 1
    record = Path("ran/run.json").read_text()
    assert record.count(str(tmp_path)) > 4

    files, err = archived(command)
    assert "1 step of this run failed" in err
    for name, content in files.items():
        plain = gzip.decompress(content) if name.endswith(".gz") else content
        for path in (str(tmp_path), str(Path.home()), sys.prefix, "/somebody/elses"):
            assert path.encode() not in plain, name
    record_archived = json.loads(files["run/run.json"])
    assert record_archived["command"] == (
        "nodegraph run toy.yaml --set start=inputs/one.txt --plugin plugins/toys.py"
    )
    steps = steps_of(files["run/steps.jsonl.gz"])
    [reason] = [step["reason"] for step in steps if step["state"] == "failed"]
    assert reason == "inputs/one.txt: no good"
    entities = metadata(files)
    assert entities["#run"]["actionStatus"] == "http://schema.org/FailedActionStatus"
    assert "1 step failed" in entities["#run"]["error"]


def test_it_runs_again_where_it_is_unpacked(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert ran(command, "--set", "start=far away/two.txt", "--axis", "length=2,3") == 0
    files, _ = archived(command)
    readme = files["README.md"].decode()
    [line] = [text.strip() for text in readme.splitlines() if text.startswith("    nodegraph run")]
    assert line == (
        "nodegraph run toy.yaml --set start=inputs/two.txt --axis length=2,3 "
        "--plugin plugins/toys.py"
    )
    for module in [name for name, module_ in sys.modules.items() if name == "toys"]:
        del sys.modules[module]
    there = tmp_path / "unpacked"
    with zipfile.ZipFile("ran.zip") as file:
        file.extractall(there)
    Path("far away/two.txt").unlink()
    monkeypatch.chdir(there)
    words = [*line.split()[1:], "--store", "kept", "--out", "again"]
    assert command(*words, nodes=False)[0] == 0
    was, now = (
        {(step["node"], str(step["labels"])): step["digests"] for step in read_record(run)["steps"]}
        for run in ("run", "again")
    )
    assert was == now


def test_inputs_are_left_out_on_demand_or_when_they_changed(command: Command) -> None:
    assert ran(command) == 0
    files, err = archived(command, "--no-inputs")
    assert "inputs/two.txt" not in files
    assert "not in it: input numbers/one.txt: left out" in err
    digest = hashlib.sha256(b"17.5").hexdigest()
    assert f"`numbers/one.txt`: {digest}.txt" in files["README.md"].decode()
    assert metadata(files)["#file-numbers/one.txt"]["sha256"] == digest
    assert "inputs/two.txt" in files["toy.yaml"].decode()

    Path("study/numbers/one.txt").write_text("18")
    files, err = archived(command)
    assert "numbers/one.txt" not in files
    assert files["inputs/two.txt"] == b"2.5"
    assert f"input numbers/one.txt: missing from {Path.cwd()}" in err
    assert str(Path.cwd()) not in files["README.md"].decode()


def locked_and_run(command: Command) -> bytes:
    """Run a graph that names no path of this machine, with its lock beside it."""
    text = GRAPH.replace("  b: {use: toy.read, with: {path: ABSOLUTE}}\n", "")
    Path("study/toy.yaml").write_text(text)
    assert command("lock", "study/toy.yaml", "--store", "kept")[0] == 0
    assert ran(command) == 0
    return Path("study/toy.lock").read_bytes()


def test_a_lock_goes_in_beside_the_graph(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = locked_and_run(command)
    files, err = archived(command)
    assert (files["toy.lock"], err) == (text, "")
    words = ["verify", "toy.lock", "--plugin", "plugins/toys.py"]
    assert f"`nodegraph {' '.join(words)}`" in files["README.md"].decode()
    Path("study/toy.lock").rename("other")
    assert "toy.lock" not in archived(command)[0]
    files, _ = archived(command, "--lock", "other")
    assert files["toy.lock"] == text
    there = tmp_path / "unpacked"
    with zipfile.ZipFile("ran.zip") as file:
        file.extractall(there)
    monkeypatch.chdir(there)
    status, out, err = command(*words, "--store", "kept", nodes=False)
    assert (status, "text" in err) == (0, False)
    assert out.startswith("identical: toy.lock")


def other_graph(command: Command) -> None:
    Path("study/toy.yaml").write_text(Path("study/toy.yaml").read_text() + "# edited\n")
    assert command("lock", "study/toy.yaml", "--store", "kept")[0] == 0


def other_axes(command: Command) -> None:
    words = ("--axis", "length=1,5,7", "--store", "kept")
    assert command("lock", "study/toy.yaml", *words)[0] == 0


def other_inputs(command: Command) -> None:
    assert command("lock", "study/toy.yaml", "--set", "factor=3", "--store", "kept")[0] == 0


def lock_elsewhere(command: Command) -> None:
    words = ("--out", "locks/toy.lock", "--store", "kept")
    assert command("lock", "study/toy.yaml", *words)[0] == 0
    Path("locks/toy.lock").replace("study/toy.lock")


def cut_off(_: Command) -> None:
    Path("study/toy.lock").write_bytes(Path("study/toy.lock").read_bytes()[:500])


def no_lock(_: Command) -> None:
    Path("study/toy.lock").write_text(Path("toys.py").read_text())


@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (other_graph, "another graph"),
        (other_axes, "other axes: length"),
        (other_inputs, "other inputs: factor"),
        (lock_elsewhere, "beside toy.yaml"),
        (cut_off, "truncated"),
        (no_lock, "nodegraph lock GRAPH"),
    ],
)
def test_a_lock_of_another_run_is_named_or_refused(
    command: Command, damage: Callable[[Command], None], reason: str
) -> None:
    locked_and_run(command)
    damage(command)
    files, err = archived(command)
    [line] = [line for line in err.splitlines() if f"{Path.cwd()}/study/toy.lock: " in line]
    assert reason in line
    assert "toy.lock" not in files
    assert "nodegraph verify" not in files["README.md"].decode()
    assert reason in files["README.md"].decode()
    Path("ran.zip").unlink()
    status, out, err = command("archive", "ran", "--lock", "study/toy.lock", nodes=False)
    assert (status, out) == (2, "")
    assert "study/toy.lock: " in err
    assert reason in err
    assert not Path("ran.zip").exists()


def test_a_lock_that_is_not_there_is_refused(command: Command) -> None:
    assert ran(command) == 0
    status, _, err = command("archive", "ran", "--lock", "nothing", nodes=False)
    assert status == 2
    assert "nothing: no such file" in err


def test_plugin_files_are_those_that_ran(command: Command) -> None:
    was = Path("toys.py").read_bytes()
    assert ran(command) == 0
    Path("toys.py").write_bytes(was.replace(b"x - length", b"x + length"))
    files, err = archived(command)
    reason = "plugin plugins/toys.py: missing from"
    assert f"{reason} {Path.cwd()}" in err
    assert "plugins/toys.py" not in files
    readme = files["README.md"].decode()
    assert reason in readme
    Path("toys.py").write_bytes(was)
    files, err = archived(command)
    assert (files["plugins/toys.py"], err) == (was, "")


def test_from_another_folder_the_same_goes_in(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    locked_and_run(command)
    files, _ = archived(command)
    Path("ran.zip").unlink()
    other = tmp_path / "other"
    (other / "study").mkdir(parents=True)
    (other / "toys.py").write_text("another = 1")
    (other / "study" / "toy.yaml").write_text("nodegraph: 1\nnodes: {a: {use: toy.number}}\n")
    monkeypatch.chdir(other)
    status, _, err = command("archive", "../ran", nodes=False)
    assert (status, err) == (0, "")
    with zipfile.ZipFile("../ran.zip") as file:
        there = {name: file.read(name) for name in file.namelist()}
    assert there.keys() == files.keys()
    for name in ("plugins/toys.py", "toy.yaml", "toy.lock", "numbers/one.txt", "README.md"):
        assert there[name] == files[name]


def test_where_the_folder_of_the_run_is_gone_it_says_so(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    home = tmp_path / "home"
    home.mkdir()
    for name in ("study", "toys.py", "far away"):
        Path(name).rename(home / name)
    monkeypatch.chdir(home)
    locked_and_run(command)
    monkeypatch.chdir(tmp_path)
    home.rename("moved")
    Path("moved/ran").rename("ran")
    files, err = archived(command)
    for name in ("plugin plugins/toys.py", "input numbers/one.txt"):
        [line] = [line for line in err.splitlines() if f"{name}: " in line]
        assert line.endswith(f" in {home}")
    assert "lock toy.lock: " in err
    assert str(tmp_path) not in files["README.md"].decode()
    assert str(tmp_path) not in files["run/run.json"].decode()
    monkeypatch.chdir("moved")
    Path("../ran").rename("ran")
    files, err = archived(command)
    assert err == ""
    assert {"plugins/toys.py", "numbers/one.txt", "toy.lock"} <= files.keys()


def test_an_unwritable_place_is_refused_before_the_work(command: Command) -> None:
    assert ran(command) == 0
    Path("taken").write_text("mine")
    before = sorted(Path().rglob("*"))
    status, _, err = command("archive", "ran", "--out", "taken/x.zip", nodes=False)
    assert status == 2
    assert "taken/x.zip: cannot be written: taken is a file" in err
    assert sorted(Path().rglob("*")) == before


def test_a_graph_that_uses_others(command: Command) -> None:
    Path("shared").mkdir()
    Path("shared/part.yaml").write_text(
        "nodegraph: 1\n"
        "outputs: {x: read}\n"
        "nodes:\n  read: {use: toy.read, with: {path: ../far away/two.txt}}\n"
    )
    text = Path("study/toy.yaml").read_text()
    Path("study/toy.yaml").write_text(f"{text}  part: {{use: ../shared/part.yaml}}\n")
    assert ran(command) == 0
    files, err = archived(command)
    assert err == ""
    assert "part: {use: graphs/part.yaml}" in files["toy.yaml"].decode()
    assert "path: ../inputs/two.txt" in files["graphs/part.yaml"].decode()


def test_a_run_that_stored_nothing_does_not_know_what_it_read(command: Command) -> None:
    assert ran(command, "--no-cache") == 0
    _, err = archived(command)
    assert "not in it: inputs: " in err


def test_a_folder_that_is_not_a_run_is_refused(command: Command) -> None:
    Path("empty").mkdir()
    status, _, err = command("archive", "empty", nodes=False)
    assert status == 2
    assert "there is no finished run" in err
    Path("empty/events.jsonl").write_text("{}\n")  # a run that was interrupted
    assert command("archive", "empty", nodes=False)[0] == 2
    assert command("archive", "missing", nodes=False)[0] == 2
    assert "there is no finished run" in command("archive", ".", nodes=False)[2]
    assert not list(Path().glob("*.zip"))


def test_another_archive_is_never_replaced(command: Command) -> None:
    assert ran(command) == 0
    archived(command)
    first = Path("ran.zip").read_bytes()
    assert command("archive", "ran", nodes=False)[0] == 0
    status, out, err = command("archive", "ran", "--no-inputs", nodes=False)
    assert (status, out) == (2, "")
    assert "ran.zip already exists and differs" in err
    assert Path("ran.zip").read_bytes() == first


def test_a_file_that_is_not_an_archive_is_never_replaced(command: Command) -> None:
    assert ran(command) == 0
    Path("ran.zip").write_text("mine")
    status, _, err = command("archive", "ran", nodes=False)
    assert status == 2
    assert "ran.zip already exists and differs" in err
    assert Path("ran.zip").read_text() == "mine"
    with zipfile.ZipFile("other.zip", "w") as file:
        file.writestr("a", "b")
    assert command("archive", "ran", "--out", "other.zip", nodes=False)[0] == 2
    assert command("archive", "ran", "--out", "study", nodes=False)[0] == 2
    assert command("archive", "ran", "--out", "ran/in.zip", nodes=False)[0] == 2


def test_without_the_package_it_says_what_to_install(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert ran(command) == 0
    for name in ("rocrate", "rocrate.rocrate"):
        monkeypatch.setitem(sys.modules, name, None)
    status, _, err = command("archive", "ran", nodes=False)
    assert status == 2
    assert "pip install 'nodegraph[archive]'" in err
    assert not Path("ran.zip").exists()
