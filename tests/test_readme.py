"""What the README shows is true: it runs, and its table of nodes is complete."""

from __future__ import annotations

import os
import re
import runpy
import shutil
import subprocess
from pathlib import Path

import pytest

import nodegraph as ng
from nodegraph.cli.main import main
from nodegraph.plugin.registry import Registry
from nodegraph.testing import check_node
from tests import readmes
from tests.readmes import ROOT

README = (ROOT / "README.md").read_text()
INSTALLS = (["python3", "-m", "venv"], [".venv/bin/pip", "install"], [".venv/bin/python", "-m"])
"""Beginnings of commands that continuous integration runs."""


def blocks(language: str) -> list[str]:
    return readmes.blocks(README, language)


def test_the_graph_runs(tmp_path: Path) -> None:
    (graph,) = blocks("yaml")
    path = tmp_path / "graph.yaml"
    path.write_text(graph)
    run = ng.run(path, axis={"trial": [0]}, only={"length": [15]})
    assert run.ok
    assert list(run) == ["capture", "gaps", "fill", "error", "table"]
    assert set(run["table"].value["fill"]) == {"guenter", "lin_ouhyoung", "muscle"}


def test_the_picture_shows_the_graph(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "graph.yaml").write_text(blocks("yaml")[0])
    assert main(["draw", str(tmp_path / "graph.yaml")]) == 0
    (picture,) = re.findall(r'<img src="(.*?\.svg)"', README)
    assert capsys.readouterr().out.strip() == (ROOT / picture).read_text().strip()


def test_the_added_method_joins_the_comparison(tmp_path: Path) -> None:
    code = next(block for block in blocks("python") if block.startswith("# my_fill.py"))
    (tmp_path / "my_fill.py").write_text(code)
    run = ng.run(
        ROOT / "graphs" / "fill.yaml",
        plugins=[tmp_path / "my_fill.py"],
        only={
            "recording": ["face_1"],
            "condition": ["own_noise"],
            "length": [5],
            "terms": ["ends_met"],
            "fill": ["first", "linear"],
        },
    )
    assert run.ok
    table = run["table"].value
    assert set(table["fill"]) == {"first", "linear"}
    filled = run["fill"].at(fill="first")
    gappy = run["gaps"].at()
    assert filled.present.sum() > gappy.present.sum()


def test_the_live_form_gives_what_the_take_gives(tmp_path: Path) -> None:
    path = tmp_path / "my_hold.py"
    path.write_text(next(code for code in blocks("python") if code.startswith("# my_hold.py")))
    registry = Registry.installed([path])
    check_node(registry.find("fill.hold").node.function, registry=registry)


def test_the_python_code_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    readmes.write_small_study(tmp_path / "graphs" / "fill.yaml")
    (tmp_path / "code.py").write_text(next(code for code in blocks("python") if "ng.run(" in code))
    runpy.run_path("code.py")
    assert (tmp_path / "runs" / "fill_5" / "report.html").is_file()


def test_continuous_integration_runs_the_commands_of_the_readme(tmp_path: Path) -> None:
    (tmp_path / ".ci").mkdir()
    shutil.copy(ROOT / ".ci" / "run", tmp_path / ".ci" / "run")
    packages = Path("nodegraph", "editor", "codemirror")
    shutil.copytree(ROOT / packages, tmp_path / packages)
    tools = tmp_path / "tools"
    tools.mkdir()
    for name in ("chromium", "npm", "tar", "apt-get"):
        (tools / name).write_text("#!/bin/sh\n")
    (tools / "install").write_text('#!/bin/sh\necho install >>"$ran"\n')
    python = tmp_path / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.write_text('#!/bin/sh\necho "$2" >>"$ran"; exit $tools\n')
    page, ran = README, tmp_path / "ran"
    for name, mark in (("first", "the first run"), ("tests", "the tests")):
        command = README.partition(f"<!-- {mark} -->\n```sh\n")[2].partition("\n```")[0]
        page = page.replace(command, f"install && {name}" if name == "tests" else name)
        (tools / name).write_text(f'#!/bin/sh\necho {name} >>"$ran"; exit $status_{name}\n')
    for tool in (*tools.iterdir(), python):
        tool.chmod(0o755)
    (tmp_path / "README.md").write_text(page)
    environment = {**os.environ, "PATH": f"{tools}{os.pathsep}{os.environ['PATH']}"}
    for first, tests, checks, of_checks in (
        (0, 0, 0, ["ruff", "ruff", "mypy"]),
        (0, 0, 1, ["ruff"]),
        (0, 7, 0, ["ruff", "ruff", "mypy"]),
        (7, 0, 0, ["ruff", "ruff", "mypy"]),
    ):
        ran.write_text("")
        words = {"status_first": str(first), "status_tests": str(tests), "tools": str(checks)}
        words["ran"] = str(ran)
        result = subprocess.run(
            ["bash", ".ci/run"], cwd=tmp_path, env=environment | words, check=False
        )
        assert result.returncode == max(first, tests, checks)
        order = ran.read_text().split()
        assert sorted(order) == sorted(["first", "install", "tests", *of_checks])
        # the first command runs beside the others, and the tools beside the tests
        assert [name for name in order if name in {"install", *of_checks}] == [
            "install",
            *of_checks,
        ]
        assert order.index("install") < order.index("tests")


def test_the_commands_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("impulses", "fill"):
        readmes.write_small_study(tmp_path / "graphs" / f"{name}.yaml")
    (tmp_path / "my_fill.py").write_text(blocks("python")[0])
    recording = ng.get_node("synthesize.face")(seconds=3.0).captured
    files = ng.get_node("write.c3d")(recording, name="mine")
    (tmp_path / "mine.c3d").write_bytes(files.content["mine.c3d"])
    page = (ROOT / "nodegraph" / "site" / "pages" / "reproduce.md").read_text()
    commands = list(readmes.commands(README))
    commands += [words for words in readmes.commands(page) if words not in commands]
    for words in commands:
        if readmes.is_ours(words):
            readmes.run_command(words)
        else:
            assert words[:3] in INSTALLS or words[:2] in INSTALLS, words
    used = {words[1] for words in commands if readmes.is_ours(words)}
    assert used >= {"run", "export", "diff", "report", "cite", "lock", "verify", "archive"}
    assert all((tmp_path / name).stat().st_size > 1000 for name in ("filled.c3d", "figure.pdf"))
