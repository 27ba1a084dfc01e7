"""What all commands share: exit status 2 for what is wrong, help, and never a traceback."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import types
from argparse import Namespace
from importlib.metadata import version
from io import BytesIO, TextIOWrapper
from pathlib import Path

import pytest

from nodegraph import NodegraphError
from nodegraph.cli import check
from nodegraph.cli.graphs import graph_of
from nodegraph.cli.main import COMMANDS
from nodegraph.plugin import loading
from nodegraph.plugin.loading import Plugin
from tests.nodegraph.cli.conftest import Command

HOOK = """\
from nodegraph import hookimpl
@hookimpl
def nodegraph_nodes():
    raise KeyError("lost")
"""


INVALID = [
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
    (["toy.yaml", "--plugin", "none.py"], "none.py: no such plugin file; there is"),
    (["toy.yaml", "--plugin", "toy.yaml"], "suffix .py"),
    (["toy.yaml", "--plugin", "raises.py"], "raises.py: the plugin does not import"),
    (["toy.yaml", "--plugin", "exits.py"], "exits.py: the plugin does not import"),
    (["toy.yaml", "--plugin", "hook.py"], "hook.py:4: nodegraph_nodes raised KeyError: 'lost'"),
    (["toy.yaml", "--sett", "a=1"], "no option --sett; did you mean '--set'"),
    (["toy.yaml", "--start", "1"], "'start' is an input of the graph: write --set start=1"),
    (["toy.yaml", "--lenght=45"], "'length' is an axis of the graph: write --axis length=45"),
    (["toy.yaml", "--fill", "hold"], "node with alternatives of the graph: write --only fill="),
    (["toy.yaml", "--axis", "starts=1,2"], "did you mean 'start'? axes and inputs: length"),
    (["toy.yaml", "--only", "length=3"], "for other labels, write --axis length=3"),
    (["toy"], "did you mean 'toy.yaml'?"),
    (["toy.yaml", "--onyl=fill=hold"], "did you mean '--only'"),
    (["toy.yaml", "other.yaml"], "too many arguments: other.yaml"),
    ([], "GRAPH"),
]


@pytest.mark.parametrize(
    ("name", "words", "reason"),
    [
        *(("check", words, reason) for words, reason in INVALID),
        *((name, words, reason) for name in ("run", "draw") for words, reason in INVALID[::12]),
    ],
)
def test_an_invalid_command_ends_with_2_before_anything_runs(
    command: Command, name: str, words: list[str], reason: str
) -> None:
    Path("raises.py").write_text("1 / 0")
    Path("exits.py").write_text("raise SystemExit(0)")
    Path("hook.py").write_text(HOOK)
    status, out, err = command(name, *words)
    assert status == 2
    assert reason in err
    assert out == ""
    assert not Path("runs").exists()


def test_a_lock_is_no_graph_to_run(command: Command) -> None:
    command("lock", "toy.yaml")
    status, out, err = command("check", "toy.lock")
    assert (status, out) == (2, "")
    assert "`nodegraph verify toy.lock`" in err


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["chekc", "toy.yaml"], "did you mean 'check'"),
        (["--nothing"], "usage: nodegraph"),
        (["toy.yaml", "-q"], "to run a graph, write: nodegraph run toy.yaml -q"),
    ],
)
def test_a_wrong_command_ends_with_2(command: Command, words: list[str], reason: str) -> None:
    status, _, err = command(*words, nodes=False)
    assert status == 2
    assert reason in err


def test_a_recording_in_place_of_a_graph_is_an_input_of_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.undo()  # so that the formats of plugins are there
    path = tmp_path / "jaw.c3d"
    path.write_bytes(b"\2\x50\xff")
    with pytest.raises(NodegraphError, match=rf"--set recording={path}, .*--axis recording={path}"):
        graph_of(Namespace(graph=path, plugin=[], axis=[], only=[], set=[]))


@pytest.mark.parametrize("words", [[], ["--help"], ["run", "--help"], ["show", "--help"]])
def test_help_ends_with_0(command: Command, words: list[str]) -> None:
    status, out, err = command(*words, nodes=False)
    assert (status, err) == (0, "")
    assert out.startswith("usage: nodegraph")


def test_every_command_is_listed(command: Command) -> None:
    listed = command("help", nodes=False)[1]
    assert [name for name in COMMANDS if not re.search(rf"\n    {name}\s", listed)] == []


def test_the_version_is_printed(command: Command) -> None:
    assert command("--version", nodes=False) == (0, f"nodegraph {version('nodegraph')}\n", "")


def test_an_interruption_ends_with_130(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(arguments: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(check, "check", interrupt)
    status, _, err = command("check", "toy.yaml")
    assert (status, err) == (130, "nodegraph: interrupted\n")


GREETING = """\
from nodegraph import Command, NodegraphError, hookimpl

def add_arguments(parser):
    parser.add_argument("name")

def greet(arguments):
    if arguments.name == "nobody":
        raise NodegraphError("nobody is here")
    if arguments.name == "text":
        return "one"
    print("Hello", arguments.name)
    return 1

@hookimpl
def nodegraph_commands():
    command = Command("Greet 100 % of a name.", add_arguments, greet)
    return {"greet": command, "run": command, "odd": "command"}
"""


@pytest.fixture
def greeting(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Install a plugin with a command; return its name once for each time it is loaded."""
    module = types.ModuleType("greeting")
    exec(GREETING, vars(module))
    loads: list[str] = []

    def installed() -> tuple[list[Plugin], list[object]]:
        loads.append("greeting")
        return [Plugin("greeting", module)], []

    monkeypatch.setattr(loading, "installed", installed)
    return loads


def test_a_plugin_adds_a_command(command: Command, greeting: list[str]) -> None:
    status, out, err = command("greet", "Anna", nodes=False)
    assert (status, out) == (1, "Hello Anna\n")
    assert "command 'run' of a plugin is left out" in err
    assert "'odd' of nodegraph_commands is left out" in err


def test_a_plugin_file_adds_a_command(command: Command) -> None:
    Path("greeting.py").write_text(GREETING)
    status, out, _ = command("greet", "Anna", "--plugin", "greeting.py", nodes=False)
    assert (status, out) == (1, "Hello Anna\n")


@pytest.mark.parametrize(
    ("words", "status", "reason"),
    [
        (["greet", "nobody"], 2, "nobody is here"),
        (["greet", "text"], 2, "expected int, got str"),
        (["greet"], 2, "name"),
        (["great"], 2, "greet"),
    ],
)
def test_a_wrong_command_of_a_plugin_is_named(
    command: Command, greeting: list[str], words: list[str], status: int, reason: str
) -> None:
    result, out, err = command(*words, nodes=False)
    assert (result, out) == (status, "")
    assert reason in err


def test_help_lists_the_commands_of_plugins(command: Command, greeting: list[str]) -> None:
    status, out, _ = command("help", nodes=False)
    assert status == 0
    assert "Greet 100 % of a name." in out
    assert "Greet 100 % of a name." in command("help", "greet", nodes=False)[1]


@pytest.mark.parametrize("words", [["--help"], ["run", "--help"], ["--version"], ["run"]])
def test_plugins_are_not_imported_for_built_in_words(
    command: Command, greeting: list[str], words: list[str]
) -> None:
    command(*words, nodes=False)
    assert not greeting


def test_help_imports_only_the_commands() -> None:
    """The time until it appears is that of its imports."""
    code = (
        "import sys\nfrom nodegraph.cli.main import main\n"
        "try: main(['--help'])\nexcept SystemExit: print(*sys.modules, file=sys.stderr)"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    process = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    packages = {name.partition(".")[0] for name in process.stderr.split()}
    assert "nodegraph" in packages
    assert not packages & {"email", "networkx", "numpy", "pydantic", "yaml"}


def test_characters_that_the_terminal_lacks_are_not_an_error(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (
        Path("toy.yaml")
        .read_text()
        .replace("A toy", "Ein Gesicht für drei Lücken")
        .replace("fill.*", "[fill.hold]")
    )
    Path("toy.yaml").write_text(text.replace("fill.hold", "toys:fill.hold"), "utf-8")
    for name, errors in (("stdout", "strict"), ("stderr", "backslashreplace")):  # as Python's
        monkeypatch.setattr(sys, name, TextIOWrapper(BytesIO(), "ascii", errors))
    for words in (["check", "toy.yaml"], ["draw", "toy.yaml"], ["check", "für.yaml"]):
        assert command(*words)[0] == (2 if "für.yaml" in words else 0)


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_closed_pipe_is_not_an_error(unbuffered: str) -> None:
    root = Path(__file__).parents[3]
    command = f"'{sys.executable}' -m nodegraph.cli.main show --plugin toys.py | true"
    environment = {**os.environ, "PYTHONPATH": str(root), "PYTHONUNBUFFERED": unbuffered}
    process = subprocess.run(
        ["bash", "-o", "pipefail", "-c", command], env=environment, capture_output=True, check=False
    )
    assert b"Broken" not in process.stderr
    assert process.returncode == 0
