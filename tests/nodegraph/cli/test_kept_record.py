"""The record of a run is written whatever becomes of its report."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from tests.nodegraph.cli.conftest import Command
from tests.nodegraph.cli.portable import paths_in
from tests.records import read_record

ROOT = Path(__file__).parents[3]
NODES = """
import os
from collections.abc import Iterator
from threading import Lock
from nodegraph import Files, Rendered, Kind, hookimpl

@node("once.list")
def once_list() -> list:
    return [1, (number for number in range(3))]

@node("once.mapping")
def once_mapping() -> dict:
    return {"lock": Lock()}

@node("once.tuple")
def once_tuple() -> tuple:
    return (1, iter([2]))

@node("once.alone")
def once_alone() -> Iterator:
    return (number for number in range(3))

@node("toy.read")
def read(x: object) -> float:
    return 1.0

class Word(str):
    '''A text that the report shows, with a file beside it.'''

@node("toy.word")
def word(*, text: str = "a word", times: int = 1) -> Word:
    return Word(text * times)

class Mute(float):
    def __str__(self):
        raise Silent

class Silent(Exception):
    def __str__(self):
        raise RuntimeError("not even that")

@node("toy.mute")
def mute() -> Mute:
    return Mute(1.0)

@node("write.txt")
def text(x: float) -> Files:
    return Files({"x.txt": b"x" * 10_000})

@node("write.much")
def much(*, size: int) -> Files:
    return Files({"little.txt": b"little", "much.txt": b"m" * size})

@hookimpl
def nodegraph_kinds():
    def render(value, title):
        if value == "die":
            os._exit(7)
        if value.startswith("fail"):
            raise Silent if value == "fail silently" else ValueError("no ink " * value.count("i"))
        return Rendered("", value[:20], {".csv": value.encode(), ".tex": b"tex"})
    return [Kind(Word, render)]
"""


@pytest.fixture(autouse=True)
def _nodes() -> None:
    path = Path("toys.py")
    path.write_text(path.read_text() + NODES)


def graph(nodes: str) -> None:
    Path("toy.yaml").write_text(f"nodegraph: 1\nnodes:\n{nodes}\n")


def record(folder: str = "runs/toy") -> dict[str, Any]:
    return read_record(folder)


def steps(data: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    return {step["node"]: step for step in data["steps"]}


@pytest.fixture
def limited(command: Command) -> Command:
    """Give a command while a file can have so many bytes and no more.

    That is what a disk with so much space left amounts to.
    """

    def call(most: int, *words: str) -> tuple[int, str, str]:
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, hard))
        try:
            return command(*words)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))

    return call


@pytest.mark.parametrize(
    ("kind", "executor", "words"),
    [
        ("list", "serial", ()),
        ("mapping", "serial", ("--no-cache",)),
        ("tuple", "threads", ()),
        ("alone", "threads", ("--no-cache",)),
        ("list", "processes", ("--jobs", "1", "--no-cache")),
        ("alone", "processes", ("--jobs", "1")),
    ],
)
def test_a_value_that_cannot_be_copied_fails_its_step_alone(
    command: Command, kind: str, executor: str, words: tuple[str, ...]
) -> None:
    graph(
        f"  once: {{use: once.{kind}}}\n"
        "  reader: {use: toy.read, in: once}\n"
        "  other: {use: toy.read, in: once}\n"
        "  word: {use: toy.word}\n"
        "report: [once, reader, word]"
    )
    status, out, err = command("run", "toy.yaml", "--executor", executor, *words)
    assert status == 1
    data = record()
    states = {name: step["state"] for name, step in steps(data).items()}
    assert states == {"once": "failed", "reader": "skipped", "word": "done"}
    failed = steps(data)["once"]
    line = Path("toys.py").read_text().splitlines().index(f'@node("once.{kind}")') + 1
    assert failed["place"] == f"toys.py:{line}"
    kinds = {"mapping": "lock", "tuple": "list_iterator"}
    assert kinds.get(kind, "generator") in failed["reason"]
    assert failed["reason"] in err
    assert "repeat it alone" in out
    assert Path("runs/toy/word.csv").read_text() == "a word"
    assert "a word" in Path("runs/toy/report.html").read_text()


@pytest.mark.parametrize(
    ("bad", "reason"),
    [
        ("{use: toy.word, with: {text: fail}}", "no ink"),
        ("{use: toy.word, with: {text: fail silently}}", "Silent"),
        ("{use: toy.mute}", "Silent"),
    ],
    ids=["drawing", "message", "text"],
)
def test_what_cannot_be_shown_is_in_the_record(command: Command, bad: str, reason: str) -> None:
    graph(f"  bad: {bad}\n  good: {{use: toy.word}}")
    status, out, _ = command("run", "toy.yaml")
    assert status == 1
    data = record()
    assert {step["state"] for step in data["steps"]} == {"done"}
    [lost] = data["not_shown"]
    assert (lost["node"], lost["labels"]) == ("bad", {})
    assert reason in lost["reason"]
    assert lost["reason"] in out
    assert "toys.py" in lost["trace"]
    assert Path("runs/toy/good.csv").read_text() == "a word"
    assert command("diff", "runs/toy", "runs/toy", nodes=False)[0] == 0
    assert command("archive", "runs/toy", "--out", "toy.zip", nodes=False)[0] == 0
    with zipfile.ZipFile("toy.zip") as file:
        assert str(Path.cwd()) not in file.read("run/run.json").decode()


def test_a_run_without_losses_records_none(command: Command) -> None:
    graph("  good: {use: toy.word}")
    assert command("run", "toy.yaml")[0] == 0
    assert not {"not_shown", "not_written"} & record().keys()


def test_the_record_is_there_though_the_program_ends_while_it_renders(command: Command) -> None:
    graph("  good: {use: toy.word}\n  bad: {use: toy.word, with: {text: die}}")
    ended = subprocess.run(
        [sys.executable, "-m", "nodegraph.cli.main", "run", "toy.yaml", "--plugin", "toys.py"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "plugins")])},
        check=False,
    )
    assert ended.returncode == 7
    assert {name: step["state"] for name, step in steps(record()).items()} == {
        "good": "done",
        "bad": "done",
    }
    status, _, err = command("report", "runs/toy", nodes=False)
    assert status == 2
    assert "study.json.gz" in err
    assert "was not written" in err


def test_a_full_disk_costs_the_report_and_not_the_record(limited: Command) -> None:
    graph("  good: {use: toy.word}")
    status, out, err = limited(15_000, "run", "toy.yaml", "--no-cache")
    assert status == 1
    assert "runs/toy/report.html: cannot be written: File too large" in err
    assert "a word" in out
    assert "report.html" not in out
    data = record()
    assert data["counts"]["done"] == 1
    assert data["not_written"] == [{"file": "report.html", "reason": "File too large"}]
    names = {"events.jsonl", "graph.yaml", "run.json", "steps.jsonl.gz", "study.json.gz"}
    assert {*paths_in(Path("runs/toy"))} == names | {"good.csv", "good.tex"}


def test_what_did_not_fit_is_named_and_the_rest_is_whole(
    command: Command, limited: Command
) -> None:
    size = 300_000
    graph(
        f"  good: {{use: toy.word}}\n  long: {{use: toy.word, with: {{times: {size}}}}}\n"
        f"  much: {{use: write.much, with: {{size: {size}}}}}"
    )
    status, _, err = limited(200_000, "run", "toy.yaml", "--no-cache")
    assert status == 1
    lost = ["long.csv", "much/much.txt"]
    assert [file["file"] for file in record()["not_written"]] == lost
    for name in lost:
        assert f"runs/toy/{name}: cannot be written: File too large" in err
    page = Path("runs/toy/report.html").read_text()
    assert page.rstrip().endswith("</html>")
    for name in (*lost, "good.csv", "long.tex", "much/little.txt"):
        assert (f'href="./{name}"' in page) == (name not in lost)
        assert Path("runs/toy", name).exists() == (name not in lost)
    assert not list(Path("runs/toy").rglob("*.part"))
    assert command("archive", "runs/toy", nodes=False)[2].count("File too large") == 2
    assert command("report", "runs/toy", nodes=False)[0] == 0


def test_a_record_that_does_not_fit_is_reported_and_the_rest_is_written(
    command: Command, limited: Command
) -> None:
    graph("  good: {use: toy.word}")
    status, _, err = limited(600, "run", "toy.yaml", "--no-cache")
    assert status == 1
    assert "runs/toy/run.json: cannot be written: File too large" in err
    assert "runs/toy/report.html: cannot be written: File too large" in err
    assert Path("runs/toy/good.csv").read_text() == "a word"
    assert not Path("runs/toy/run.json").exists()
    assert command("run", "toy.yaml")[0] == 0


def test_a_record_that_cannot_be_written_again_stays_as_it_was(limited: Command) -> None:
    graph(f"  bad: {{use: toy.word, with: {{text: fail {'i' * 20_000}}}}}")
    status, _, err = limited(100_000, "run", "toy.yaml", "--no-cache")
    assert status == 1
    assert "runs/toy/run.json: cannot be written: File too large" in err
    assert record()["counts"]["done"] == 1


def test_a_full_disk_leaves_whole_lines_of_events(limited: Command) -> None:
    nodes = (f"  n{at}: {{use: toy.word, with: {{times: {at}}}}}" for at in range(50))
    graph("\n".join(nodes))
    _, _, err = limited(5_000, "run", "toy.yaml", "--no-cache")
    assert "runs/toy/events.jsonl ends here: File too large" in err
    text = Path("runs/toy/events.jsonl").read_text()
    assert text.endswith("\n")
    kinds = [json.loads(line)["event"] for line in text.splitlines()]
    assert kinds[0] == "planned"
    assert "finished" not in kinds


def test_a_run_that_does_not_fit_at_all_leaves_the_earlier_one_where_it_was(
    command: Command, limited: Command
) -> None:
    graph("  good: {use: toy.word}")
    assert command("run", "toy.yaml")[0] == 0
    before = {name: Path("runs/toy", name).read_bytes() for name in paths_in(Path("runs/toy"))}
    with Path("toy.yaml").open("a") as file:
        file.write(f"notes: {'long ' * 1000}\n")
    status, _, err = limited(3000, "run", "toy.yaml", "--no-cache")
    assert status == 2
    assert "runs/toy/graph.yaml" in err
    assert [path.name for path in Path("runs").iterdir()] == ["toy"]
    assert {name: Path("runs/toy", name).read_bytes() for name in before} == before


def test_a_full_disk_leaves_no_part_of_an_export(command: Command, limited: Command) -> None:
    graph("  a: {use: toy.number}")
    assert command("run", "toy.yaml", "--store", "kept")[0] == 0
    status, _, err = limited(
        9000, "export", "runs/toy", "a", "--store", "kept", "--out", "there/a.txt"
    )
    assert status == 2
    assert "there/a.txt: cannot be written: File too large" in err
    assert not Path("there").exists()
