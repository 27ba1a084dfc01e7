"""What all commands share: exit status 2 for what is wrong, help, and never a traceback."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import pytest

from nodegraph.cli import check
from nodegraph.lock.lockfile import _HEAD

HOOK = """\
from nodegraph import hookimpl
@hookimpl
def nodegraph_nodes():
    raise KeyError("lost")
"""
Command = Callable[..., tuple[int, str, str]]


@pytest.mark.parametrize("name", ["check", "run", "draw"])
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["none.yaml"], "none.yaml: no such graph file"),
        (["."], "is a folder"),
        (["toys.py"], "toys.py:"),
        (["toy.yaml", "--set", "start"], "--set start: write --set INPUT=VALUE"),
        (["toy.yaml", "--set", "=5"], "--set =5: write --set INPUT=VALUE"),
        (["toy.yaml", "--set", "start=1", "--set", "start=2"], "--set start is given twice"),
        (["toy.yaml", "--set", "strat=1"], "did you mean 'start'"),
        (["toy.yaml", "--set", "start=[1"], "should be a valid number, got '[1'"),
        (["toy.yaml", "--set", "start=\udcff"], "surrogate"),
        (["toy.yaml", "--axis", "length"], "--axis length: write --axis AXIS=LABELS"),
        (["toy.yaml", "--only", "length"], "--only length: write --only AXIS=LABELS"),
        (["toy.yaml", "--axis", "length=[1,"], "--axis length:2:1: this is not YAML"),
        (["toy.yaml", "--axis", "length="], "has no label"),
        (["toy.yaml", "--axis", "length=\udcff"], "--axis length:1:"),
        (["toy.yaml", "--only", "fill="], "no label is kept"),
        (["toy.yaml", "--only", "fill=held"], "did you mean 'hold'"),
        (["toy.yaml", "--plugin", "none.py"], "none.py: no such plugin file"),
        (["toy.yaml", "--plugin", "toy.yaml"], "suffix .py"),
        (["toy.yaml", "--plugin", "raises.py"], "raises.py: the plugin does not import"),
        (["toy.yaml", "--plugin", "exits.py"], "exits.py: the plugin does not import"),
        (["toy.yaml", "--plugin", "hook.py"], "hook.py:4: nodegraph_nodes raised KeyError: 'lost'"),
        (["toy.lock"], "toy.lock: this is a lock; use `nodegraph verify toy.lock`"),
        (["toy.yaml", "--sett", "a=1"], "unrecognized arguments"),
        ([], "GRAPH"),
    ],
)
def test_what_is_wrong_ends_with_2_before_anything_runs(
    command: Command, name: str, words: list[str], said: str
) -> None:
    Path("raises.py").write_text("1 / 0")
    Path("exits.py").write_text("raise SystemExit(0)")
    Path("hook.py").write_text(HOOK)
    Path("toy.lock").write_text(_HEAD)
    status, out, err = command(name, *words)
    assert status == 2
    assert said in err
    assert out == ""
    assert not Path("runs").exists()


@pytest.mark.parametrize("words", [[], ["chekc", "toy.yaml"], ["--nothing"]])
def test_a_wrong_command_ends_with_2(command: Command, words: list[str]) -> None:
    status, _, err = command(*words, nodes=False)
    assert status == 2
    assert "usage: nodegraph" in err


@pytest.mark.parametrize("words", [["--help"], ["run", "--help"], ["show", "--help"]])
def test_help_is_no_mistake(command: Command, words: list[str]) -> None:
    status, out, err = command(*words, nodes=False)
    assert (status, err) == (0, "")
    assert out.startswith("usage: nodegraph")


def test_the_version_is_told(command: Command) -> None:
    assert command("--version", nodes=False) == (0, f"nodegraph {version('nodegraph')}\n", "")


def test_an_interruption_ends_with_130(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(arguments: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(check, "check", interrupt)
    status, _, err = command("check", "toy.yaml")
    assert (status, err) == (130, "nodegraph: interrupted\n")


def started(*words: str, **more: str) -> subprocess.CompletedProcess[bytes]:
    root = Path(__file__).parents[3]
    path = os.pathsep.join([str(root), str(root / "plugins")])
    code = [sys.executable, "-m", "nodegraph.cli.main", *words, "--plugin", "toys.py"]
    environment = {**os.environ, "PYTHONPATH": path, **more}
    return subprocess.run(code, env=environment, capture_output=True, check=False)


def test_words_that_the_terminal_cannot_show_are_no_reason_to_fail() -> None:
    text = (
        Path("toy.yaml")
        .read_text()
        .replace("A toy", "Ein Gesicht für drei Lücken")
        .replace("fill.*", "[fill.hold]")
    )
    Path("toy.yaml").write_text(text.replace("fill.hold", "toys:fill.hold"), "utf-8")
    for words in (["check", "toy.yaml"], ["draw", "toy.yaml"], ["check", "für.yaml"]):
        done = started(*words, PYTHONIOENCODING="ascii", PYTHONUTF8="0")
        assert b"Traceback" not in done.stderr
        assert done.returncode == (2 if "für.yaml" in words else 0)


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_output_that_nobody_reads_to_its_end_is_no_mistake(unbuffered: str) -> None:
    root = Path(__file__).parents[3]
    command = f"'{sys.executable}' -m nodegraph.cli.main nodes --plugin toys.py | true"
    environment = {**os.environ, "PYTHONPATH": str(root), "PYTHONUNBUFFERED": unbuffered}
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", command], env=environment, capture_output=True, check=False
    )
    assert b"Broken" not in done.stderr
    assert done.returncode == 0
