"""A command continues where a plugin's hook fails, or ends with the plugin, hook and line."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path

import pytest

from nodegraph.cli.main import main
from nodegraph.plugin import loading
from tests.records import read_record
from tests.texts import edit

NODES = """
from nodegraph import InputFile, Kind, hookimpl, node


def fails(*arguments):
    raise RuntimeError("out of tune")


@node("bad.number")
def number(*, start: float = 1.0) -> float:
    '''Give a number.'''
    return start


@node("bad.file")
def file(*, path: InputFile) -> float:
    '''Read a number.'''
    return 1.0


@hookimpl
def {hook}():
    return {returned}
"""
GRAPH = """
nodegraph: 1
title: A number
nodes: {a: {use: bad.number}}
report: [a]
"""
READS_A_FILE = "nodegraph: 1\nnodes: {a: {use: bad.file, with: {path: 'zz:a'}}}\n"


@pytest.fixture
def command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str]]:
    """Run a command with a plugin that has a bad hook; return its status and its messages."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(loading, "installed", lambda: ([], []))
    (tmp_path / "graph.yaml").write_text(GRAPH)

    def call(*words: str, hook: str, returned: str) -> tuple[int, str]:
        text = NODES.replace("{hook}", hook).replace("{returned}", returned)
        Path("bad_hook.py").write_text(textwrap.dedent(text))
        status = main([*words, "--plugin", "bad_hook.py"])
        captured = capsys.readouterr()
        assert "internal error" not in captured.err
        return status, captured.err

    return call


CONCLUSIONS = {
    "raises": "[Kind(float, conclude=fails, numbers=repr)]",
    "gives a number": "[Kind(float, conclude=int, numbers=repr)]",
    "of a text": "[Kind('float', conclude=fails)]",
    "of nothing": "[None]",
}


@pytest.mark.parametrize("name", CONCLUSIONS)
def test_a_study_is_locked_and_verified_though_a_conclusion_fails(
    command: Callable[..., tuple[int, str]], name: str
) -> None:
    bad = {"hook": "nodegraph_kinds", "returned": CONCLUSIONS[name]}
    status, errors = command("lock", "graph.yaml", **bad)
    assert (status, "plugin 'bad_hook': " in errors, "left out" in errors) == (0, True, True)
    assert Path("graph.lock").is_file()
    assert command("verify", "graph.lock", **bad)[0] == 0


@pytest.mark.parametrize("returned", ["[Kind(float, compare=fails)]", "[Kind(float, compare=int)]"])
def test_a_study_is_locked_verified_and_compared_though_a_comparison_fails(
    command: Callable[..., tuple[int, str]], returned: str
) -> None:
    bad = {"hook": "nodegraph_kinds", "returned": returned}
    assert command("lock", "graph.yaml", **bad)[0] == 0
    assert command("verify", "graph.lock", **bad)[0] == 0
    assert command("run", "graph.yaml", "--out", "one", **bad)[0] == 0
    graph = Path("graph.yaml")
    edit(graph, "bad.number}", "bad.number, with: {start: 2}}")
    assert command("run", "graph.yaml", "--out", "other", **bad)[0] == 0
    status, errors = command("diff", "one", "other", **bad)
    assert (status, "plugin 'bad_hook': the comparison of float" in errors) == (1, True)


@pytest.mark.parametrize("returned", ["[Kind(float, fails)]", "[Kind(float, repr)]"])
def test_a_run_has_all_its_files_though_a_rendering_fails(
    command: Callable[..., tuple[int, str]], returned: str
) -> None:
    bad = {"hook": "nodegraph_kinds", "returned": returned}
    status, errors = command("run", "graph.yaml", "--out", "run", **bad)
    assert (status, "plugin 'bad_hook': the renderer of float" in errors) == (1, True)
    assert read_record("run")["steps"][0]["state"] == "done"
    assert "the renderer of float" in Path("run/report.html").read_text()
    status, errors = command("export", "run", "a", "--out", "a.csv", **bad)
    assert (status, "plugin 'bad_hook': the renderer of float" in errors) == (2, True)


@pytest.mark.parametrize("returned", ["fails, put_together=fails", "str, put_together=str"])
def test_a_run_goes_on_though_a_storage_fails(
    command: Callable[..., tuple[int, str]], returned: str
) -> None:
    bad = {"hook": "nodegraph_kinds", "returned": f"[Kind(float, take_apart={returned})]"}
    for _ in range(2):
        assert command("run", "graph.yaml", "--out", "run", **bad)[0] == 0
    assert command("lock", "graph.yaml", **bad)[0] == 0


def test_of_a_value_that_cannot_be_lent_a_copy_is(
    command: Callable[..., tuple[int, str]],
) -> None:
    returned = "[Kind(float, take_apart=float, put_together=float, lend=repr)]"
    bad = {"hook": "nodegraph_kinds", "returned": returned}
    status, errors = command("run", "graph.yaml", "--out", "run", **bad)
    assert (status, "plugin 'bad_hook': lend of float" in errors) == (0, True)
    assert Path("run/run.json").is_file()


@pytest.mark.parametrize(
    ("hook", "returned", "words", "message"),
    [
        (
            "executors",
            "{'zz': 4}",
            ["run", "graph.yaml", "--executor", "zz"],
            "expected Callable, got int",
        ),
        (
            "executors",
            "{'zz': lambda schedule, how: 4}",
            ["run", "graph.yaml", "--executor", "zz"],
            "plugin 'bad_hook': executor 'zz', from hook nodegraph_executors, failed: ",
        ),
        (
            "executors",
            "{'zz': lambda schedule, how: [4]}",
            ["run", "graph.yaml", "--executor", "zz"],
            "executor 'zz' yielded 4",
        ),
        (
            "executors",
            "{'zz': lambda schedule, how: []}",
            ["run", "graph.yaml", "--executor", "zz"],
            "executor 'zz' ended with 1 of 1 steps left to compute",
        ),
        ("executors", "{'zz': fails}", ["run", "graph.yaml", "--executor", "zz"], "out of tune"),
        (
            "readers",
            "{'bad.file': fails}",
            ["show", "./graph.yaml"],
            "the function of bad.file that recognizes files, from hook nodegraph_readers, failed: ",
        ),
        ("readers", "{'bad.file': len}", ["show", "./graph.yaml"], "failed: "),
        (
            "templates",
            "{'t2': 3}",
            ["new", "t2", "mine"],
            "'t2' of nodegraph_templates is left out",
        ),
        (
            "templates",
            "{'t2': __import__('pathlib').Path('nowhere')}",
            ["new", "t2", "mine"],
            "nowhere: the template 't2' of a plugin has no files",
        ),
    ],
)
def test_a_command_that_needs_what_a_plugin_does_not_have_says_whose_it_is(
    command: Callable[..., tuple[int, str]],
    hook: str,
    returned: str,
    words: list[str],
    message: str,
) -> None:
    status, errors = command(*words, hook=f"nodegraph_{hook}", returned=returned)
    assert (status, message in errors) == (2, True), errors


@pytest.mark.parametrize(
    ("returned", "message"),
    [
        ("{'zz': 4}", "'zz' of nodegraph_places is left out: "),
        ("{'zz': fails}", "plugin 'bad_hook': the place zz:..., from hook nodegraph_places"),
        ("{'zz': len}", "expected Path, got int"),
    ],
)
def test_a_path_whose_scheme_fails_is_an_error_at_its_line(
    command: Callable[..., tuple[int, str]], returned: str, message: str
) -> None:
    Path("graph.yaml").write_text(READS_A_FILE)
    status, errors = command("check", "graph.yaml", hook="nodegraph_places", returned=returned)
    assert (status, message in errors, "graph.yaml:2" in errors) == (2, True, True), errors
