from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tests.nodegraph.cli.conftest import Command
from tests.records import read_record

WRITERS = """
from nodegraph import Files

@node("write.txt")
def write_txt(x: float, *, name: str = "number") -> Files:
    return Files({f"{name}.txt": repr(x).encode(), f"{name}.note": b"a number"})

@node("write.number_raw")
def write_raw(x: float) -> Files:
    raise TypeError("no numbers today")

@node("write.grid")
def write_grid(x: float, *, rows: tuple[str, ...] = ()) -> Files:
    if "y" in rows:
        raise ValueError("there is no y")
    return Files({"x.grid": "; ".join(rows).encode()})

@node("write.pair")
def write_pair(x: float, y: float) -> Files:
    return Files({"x.pair": b""})
"""


@pytest.fixture
def ran(command: Command) -> Path:
    """The toy graph, run with writers of numbers."""
    toys = Path("toys.py")
    toys.write_text(toys.read_text() + WRITERS)
    graph = Path("toy.yaml").read_text()
    Path("toy.yaml").write_text(graph + "  again: {use: fill.hold, in: {x: one}}\n")
    assert command("run", "toy.yaml", "--store", "kept")[0] == 0
    return Path("runs/toy")


def exported(command: Command, *words: str) -> tuple[int, str, str]:
    return command("export", "runs/toy", *words, "--store", "kept")


@pytest.mark.usefixtures("ran")
def test_a_value_is_written_in_the_form_that_the_suffix_names(command: Command) -> None:
    status, out, _ = exported(
        command, "fill", "--at", "fill=hold,length=1", "--out", "there/four.txt"
    )
    assert status == 0
    assert Path("there/four.txt").read_text() == "4.0"
    assert "there/four.txt (3 B)" in out
    assert Path("there/number.note").read_text() == "a number"


@pytest.mark.usefixtures("ran")
def test_the_node_that_writes_is_told_what_stands_in_the_rows(command: Command) -> None:
    assert exported(command, "total", "--rows", "fill,length", "--out", "a.grid")[0] == 0
    assert Path("a.grid").read_text() == "fill; length"


@pytest.mark.usefixtures("ran")
def test_an_output_is_named_after_a_point_and_labels_in_several_options(command: Command) -> None:
    status, _, _ = exported(command, "gaps.truth", "--at", "length=5", "--out", "truth.txt")
    assert (status, Path("truth.txt").read_text()) == (0, "5.0")
    status, _, _ = exported(
        command, "fill", "--at", "fill=strict", "--at", "length=5", "--out", "new/strict.TXT"
    )
    assert (status, Path("new/strict.TXT").read_text()) == (0, "0.0")


def test_a_combination_of_a_shared_step_is_exported(ran: Path, command: Command) -> None:
    shared = [cell for step in read_record(ran)["steps"] for cell in step.get("also", ())]
    assert {"node": "one", "labels": {}} in shared
    status, _, _ = exported(command, "one", "--out", "one.txt")
    assert (status, Path("one.txt").read_text()) == (0, "0.0")


@pytest.mark.usefixtures("ran")
@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("fil", "--out", "a.txt"), "the run has no node 'fil'; did you mean 'fill'?"),
        (("gaps.truht", "--out", "a.txt"), "'gaps' has no output 'truht'; did you mean 'truth'?"),
        (
            ("fill", "--at", "fill=hold", "--out", "a.txt"),
            "has 2 values; choose a label of each axis, such as --at length=",
        ),
        (("fill", "--at", "fil=hold", "--out", "a.txt"), "'fill' has no axis 'fil'"),
        (("fill", "--at", "length=2", "--out", "a.txt"), "'length' has no label '2'; there is: 1"),
        (("total", "--out", "a.xyz"), "of type float can be written as .grid, .raw"),
        (
            ("total", "--rows", "x", "--out", "a.raw"),
            "of type float can be written as .grid with --rows",
        ),
        (
            ("total", "--rows", "x", "--columns", "y", "--out", "a.grid"),
            "can be written as no format with --rows and --columns",
        ),
        (("total", "--rows", "x,y", "--out", "a.grid"), "a.grid: there is no y"),
        (("total", "--out", "a.raw"), "a.raw: TypeError: no numbers today"),
        (("fill", "--at", "fill", "--out", "a.txt"), "--at fill: write --at AXIS=LABEL"),
        (("a", "--out", "toy.yaml"), "toy.yaml already exists"),
    ],
)
def test_a_value_that_cannot_be_written_is_an_error(
    command: Command, words: tuple[str, ...], reason: str
) -> None:
    before = sorted(Path().iterdir())
    status, _, err = exported(command, *words)
    assert status == 2
    assert reason in err
    assert sorted(Path().iterdir()) == before


@pytest.mark.usefixtures("ran")
def test_a_value_that_is_no_longer_stored_comes_with_the_command_that_makes_it(
    command: Command,
) -> None:
    status, _, err = command("export", "runs/toy", "a", "--out", "a.txt", "--store", "elsewhere")
    assert status == 2
    assert "a: its value is not in the store" in err
    assert "nodegraph run toy.yaml --plugin toys.py --store kept" in err


@pytest.mark.usefixtures("ran")
def test_what_was_refused_or_failed_has_no_value(command: Command) -> None:
    assert command("run", "toy.yaml", "--set", "start=-20", "--store", "kept")[0] == 0
    words = ("--at", "fill=strict,length=1", "--out", "a.txt")
    status, _, err = exported(command, "fill", *words)
    assert status == 2
    assert "fill(length=1, fill=strict) was refused: too small" in err


def test_a_folder_without_a_run_is_an_error(command: Command) -> None:
    status, _, err = command("export", ".", "a", "--out", "a.txt")
    assert status == 2
    assert ": there is no finished run" in err


def test_without_its_plugin_a_value_stays_in_the_store(command: Command) -> None:
    Path("lips.py").write_text(
        "from dataclasses import dataclass\n"
        "from nodegraph import Files, Value, node\n"
        "@dataclass(frozen=True)\n"
        "class Lips(Value):\n"
        "    width: float\n"
        "@node('lips.make')\n"
        "def make() -> Lips:\n"
        "    return Lips(9.0)\n"
        "@node('write.lips')\n"
        "def write(lips: Lips) -> Files:\n"
        "    return Files({'lips.lips': b'9'})\n"
    )
    Path("lips.yaml").write_text("nodegraph: 1\nnodes: {a: {use: lips.make}}\n")
    more = ("--store", "kept")
    assert command("run", "lips.yaml", "--plugin", "lips.py", *more)[0] == 0
    del sys.modules["lips"]
    words = ("export", "runs/lips", "a", "--out", "a.lips", *more)
    status, _, err = command(*words)
    assert status == 2
    assert "'lips:Lips' is not a class of values here; it may need --plugin FILE" in err
    assert command(*words, "--plugin", "lips.py")[0] == 0
    assert Path("a.lips").read_text() == "9"
