"""Commands that report print their answer as JSON, which is as its schema says."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from nodegraph.cli.answers import ANSWERS
from nodegraph.cli.main import main
from tests.nodegraph.cli.conftest import READER, Command
from tests.texts import edit

STORE = ("--store", "kept")


@pytest.fixture
def answer(command: Command, capsys: pytest.CaptureFixture[str]) -> Any:
    """Give a command with ``--json``; return the exit status and the answer, checked."""

    def call(name: str, *words: str, nodes: bool = True) -> tuple[int, Any]:
        status, out, _ = command(name, *words, "--json", nodes=nodes)
        data = json.loads(out)
        assert main(["schema", name]) == 0
        schema = json.loads(capsys.readouterr().out)
        Draft202012Validator.check_schema(schema)
        Draft202012Validator(schema).validate(data)
        return status, data

    return call


def test_a_schema_names_each_field_and_says_what_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    for name in ANSWERS:
        assert main(["schema", name]) == 0
        schema = json.loads(capsys.readouterr().out)
        for kind in (*schema.get("$defs", {}).values(), schema):
            assert kind.get("description") or "anyOf" in kind


def test_a_study_is_checked_run_listed_compared_and_cited(answer: Any) -> None:
    status, data = answer("check", "toy.yaml", *STORE)
    assert (status, data["steps"], data["stored"]) == (0, 8, 0)
    assert data["nodes"][1]["axes"] == {"length": [1, 5]}
    status, data = answer("run", "toy.yaml", *STORE, "--out", "runs/was")
    assert (status, data["ok"], data["steps"]) == (0, True, {"done": 8})
    assert answer("check", "toy.yaml", *STORE)[1]["stored"] == 8
    edit("toy.yaml", "start: 5", "start: -90")
    status, data = answer("run", "toy.yaml", *STORE, "--out", "runs/now")
    assert (status, data["ok"]) == (1, False)
    assert data["failed"][0]["reason"].startswith("too far")
    status, data = answer("check", "toy.yaml", *STORE, "--why", "a", "--run", "runs/was")
    assert data["steps"][0]["changes"] == ["a: start was 5, now -90"]
    status, data = answer("diff", "runs/was", "runs/now", *STORE)
    assert (status, data["same"], data["choices"]) == (1, False, ["input start was 5, now -90"])
    first, failed = data["origins"]
    assert (first["node"], first["labels"], first["changes"]) == (
        "a",
        [{}],
        ["start was 5, now -90"],
    )
    assert first["values"] == ["output was 5.0, now -90.0"]
    assert failed["text"] == "was done, now failed (too far)"
    assert failed["labels"][0] == {"length": 1, "fill": "strict"}
    assert data["follow"]["gaps"] == 2
    runs = answer("runs", nodes=False)[1]["runs"]
    assert {Path(run["folder"]).name: run["state"] for run in runs} == {
        "was": "done",
        "now": "failed",
    }
    assert answer("cite", "runs/was", nodes=False)[1]["texts"].keys() >= {"methods.md"}


def test_a_lock_is_verified_and_a_study_repeated(answer: Any, command: Command) -> None:
    assert command("lock", "toy.yaml", *STORE)[0] == 0
    status, data = answer("verify", "toy.lock", *STORE)
    assert (status, data["grade"], data["holds"], data["identical"]) == (0, "identical", True, 9)
    edit("toys.py", "return Cut(x - length", "return Cut(x - 2 * length")
    status, data = answer("verify", "toy.lock", *STORE)
    assert (status, data["grade"]) == (1, "diverged")
    (first,) = data["origins"]
    assert (first["node"], first["labels"]) == ("gaps", [{"length": 1}, {"length": 5}])
    assert first["changes"] == ["code: toys was edited"]
    assert first["distance"] > 0.01
    status, data = answer("verify", "toy.yaml", *STORE, "--repeat", "--executor", "serial")
    assert (status, data["holds"]) == (0, True)
    assert {each["grade"] for each in data["methods"]} == {"identical"}


def test_what_is_installed_and_stored_is_listed(answer: Any, command: Command) -> None:
    data = answer("show", "toy.cut")[1]
    assert data["nodes"][0]["name"] == "toy.cut"
    assert [port["truth"] for port in data["outputs"]] == [False, True]
    (length,) = data["settings"]
    assert (length["name"], length["default"], length["unit"]) == ("length", 3, "frames")
    listed = answer("show", "fill")[1]["nodes"]
    assert [node["name"] for node in listed] == ["fill.hold", "fill.strict"]
    Path("reader.py").write_text(READER)
    Path("a.count").write_text("count:3")
    data = answer("show", "a.count", "--plugin", "reader.py")[1]
    assert (data["file"], data["format"], len(data["facts"])) == ("a.count", "Count", 4)
    command("run", "toy.yaml", *STORE)
    data = answer("cache", "list", *STORE, nodes=False)[1]
    assert data["results"] == len(data["listed"]) == 8
    assert data["listed"][0]["state"] == "done"
    data = answer("cache", "clear", *STORE, nodes=False)[1]
    assert (data["results"], data["removed_results"]) == (0, 8)
