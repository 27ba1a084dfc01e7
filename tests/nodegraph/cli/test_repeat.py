"""``verify --repeat`` prints a line per method; its status says whether all have one answer."""

from __future__ import annotations

from pathlib import Path

from tests.nodegraph.cli.conftest import Command
from tests.records import read_record

ODD = """

@node("odd.process")
def process(x: float) -> float:
    import os
    return float(os.getpid())

@node("odd.dies")
def dies(x: float) -> float:
    import ctypes
    ctypes.CDLL(None).exit(7)
"""
_STORE = ("--store", "kept")
_HERE = (*_STORE, "--executor", "serial")


def add(nodes: str) -> None:
    path = Path("toys.py")
    path.write_text(path.read_text() + ODD)
    graph = Path("toy.yaml")
    graph.write_text(graph.read_text() + nodes)


def rows(out: str) -> list[list[str]]:
    table = out.split("\n\n")[0].splitlines()
    return [line.split() for line in table[1:]]


def test_a_line_per_node_and_method_of_a_graph_and_of_its_lock(command: Command) -> None:
    status, out, err = command("verify", "toy.yaml", "--repeat", *_HERE)
    assert status == 0, out + err
    lines = rows(out)
    assert lines == [
        ["a", "toy.number", "identical", "1"],
        ["gaps", "toy.cut", "identical", "1"],
        ["fill", "fill.hold", "identical", "1"],
        ["fill", "fill.strict", "identical", "1"],
        ["total", "toy.sum", "identical", "1"],
        ["one", "fill.hold", "identical", "1"],
    ]
    assert "repeating 6 of 8 steps" in err

    assert command("lock", "toy.yaml", *_HERE)[0] == 0
    status, out, _ = command("verify", "toy.lock", "--repeat", *_HERE)
    assert (status, rows(out)) == (0, lines)


def test_all_combinations_on_demand(command: Command) -> None:
    words = ("--set", "start=-5", "--repeat", "all", *_HERE)
    status, out, _ = command("verify", "toy.yaml", *words)
    assert status == 0, out
    strict = next(row for row in rows(out) if row[1] == "fill.strict")
    assert strict[2:] == ["refused", "1", "of", "2", "too", "small"]


def test_a_node_of_several_answers_costs_the_status_and_is_in_doubt_until_it_is_edited(
    command: Command,
) -> None:
    add("  odd: {use: odd.process, in: a}\n")
    status, out, _ = command("verify", "toy.yaml", "--repeat", *_HERE)
    assert status == 1
    assert rows(out)[-1][:3] == ["odd", "odd.process", "differs"]
    assert "odd.process: results are no longer stored" in out

    status, out, _ = command("run", "toy.yaml", *_STORE, "--out", "ran")
    assert status == 0
    reason = "odd.process: an audit found that it gives another answer in another process"
    assert f"1 result is not stored: {reason}" in out
    assert "this result is one of several, and is not stored" in str(read_record("ran"))
    # the same again, with the same code: an audit does not take it back
    assert reason in command("verify", "toy.yaml", "--repeat", *_HERE)[1]

    path, code = Path("toys.py"), Path("toys.py").read_text()
    path.write_text(code.replace("float(os.getpid())", "x"))
    status, out, _ = command("verify", "toy.yaml", "--repeat", *_HERE)
    assert status == 0, out
    assert "an audit found" not in out

    path.write_text(code)
    assert reason in command("run", "toy.yaml", *_STORE, "--out", "ran")[1]
    assert command("cache", "clear", *_STORE, nodes=False)[0] == 0
    assert "an audit found" not in command("run", "toy.yaml", *_STORE, "--out", "ran")[1]


def test_a_node_that_dies_ends_nothing_else(command: Command) -> None:
    add("  odd: {use: odd.dies, in: a}\n")
    words = ("--executor", "processes", "--jobs", "1")
    status, out, _ = command("verify", "toy.yaml", "--repeat", *_STORE, *words)
    assert status == 1
    assert rows(out)[-1][:3] == ["odd", "odd.dies", "failed"]
    assert "ended with exit status 7" in out
    assert rows(out)[0][2] == "identical"


def test_an_invalid_graph_is_an_error_before_anything_runs(command: Command) -> None:
    Path("toy.yaml").write_text("nodegraph: 1\nnodes: {a: {use: toy.nothing}}\n")
    status, _, err = command("verify", "toy.yaml", "--repeat", *_STORE)
    assert status == 2
    assert "toy.yaml:2:" in err
