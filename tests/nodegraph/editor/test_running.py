"""Runs from the page: what they would compute, how far they are, and how they end."""

from __future__ import annotations

import json
import signal
import time
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import pytest
from playwright.sync_api import Page

from nodegraph.plugin.registry import Registry
from nodegraph.runs.state import RunState, run_state
from tests.browser import AXE, resize, until, violations
from tests.nodegraph.editor.conftest import Editor
from tests.nodegraph.editor.test_command import ask
from tests.nodegraph.serve.test_server import served

NODES = """\
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from nodegraph import Kind, Rendered, Value, hookimpl, node

@dataclass(frozen=True)
class Verdict(Value):
    text: str

@node("toy.number")
def number(*, start: float = 1.0) -> float:
    return start

@node("toy.strict")
def strict(x: float) -> float:
    if x > 4:
        raise ValueError("too large")
    return x

@node("toy.wait")
def wait(x: float, *, begun: str) -> float:
    Path(begun).touch()
    time.sleep(600)
    return x

@node("toy.verdict")
def verdict(x: float) -> Verdict:
    return Verdict(f"It is {x:g}.")

@hookimpl
def nodegraph_kinds() -> Iterable[Kind]:
    return [Kind(Verdict, lambda value, title: Rendered("", answer=(value.text,), lead=value.text))]
"""
GRAPH = """\
nodegraph: 1
axes: {start: [1, 5]}
nodes:
  a: {use: toy.number, with: {start: $start}}
  strict: {use: toy.strict, in: a}
  verdict: {use: toy.verdict, in: a}
report: [verdict]
"""


@pytest.fixture
def toys(tmp_path: Path) -> Path:
    path = tmp_path / "toys.py"
    path.write_text(NODES)
    return path


@pytest.fixture
def first_text() -> str:
    return GRAPH


@pytest.fixture
def plugins(toys: Path) -> tuple[Path, ...]:
    return (toys,)


@pytest.fixture
def registry(toys: Path) -> Registry:
    return Registry.installed([toys])


def snapshots(editor: Editor) -> list[Any]:
    """Return what the page gets of a run until it has ended."""
    lines = editor.get("/running").text.splitlines()
    return [json.loads(line.removeprefix("data: ")) for line in lines if line]


def test_a_run_is_seen_from_what_it_would_compute_to_its_report(editor: Editor) -> None:
    assert editor.view()["run"] is None
    assert editor.get("/running").status == 409
    before = editor.get("/preview").data
    assert before["nodes"] == [["a", 2, 2], ["strict", 2, 2], ["verdict", 2, 2]]
    assert (before["steps"], before["missing"], before["changes"]) == (6, 6, [])
    text = editor.edit(text=GRAPH.replace("[1, 5]", "[2, 5]"))["text"]
    view = editor.edit(action="run")
    assert (view["run"], view["is_saved"]) == ({"number": 1, "is_current": True}, True)
    first, *_, last = snapshots(editor)
    assert (first["is_over"], first["answer"]) == (False, "")
    assert (last["state"], last["answer"], last["has_report"]) == (
        "finished",
        "start 2: It is 2.",
        True,
    )
    assert last["nodes"]["strict"]["text"] == "1 of 2 failed, 1 done"
    assert last["failures"] == ["strict(start=5): too large (toys.py:19)"]
    for address in ("/values?run=graph&node=strict", "/report?run=graph"):
        answer = editor.get(address)
        assert (answer.status, "too large" in answer.text) == (200, True)
    assert "2.0" in editor.get("/value?run=graph&node=a&at.start=2").text
    assert not editor.edit(text=GRAPH)["run"]["is_current"]
    assert editor.edit(action="undo")["run"]["is_current"]
    assert editor.view()["text"] == text
    editor.edit(text=GRAPH.replace("[1, 5]", "[2, 3]"))
    after = editor.get("/preview").data
    assert after["nodes"] == [["a", 2, 1], ["strict", 2, 1], ["verdict", 2, 1]]
    assert after["changes"] == ["a(start=3): was not in the earlier run"]


def test_a_graph_with_mistakes_is_not_run(editor: Editor, path: Path) -> None:
    editor.edit(text=GRAPH.replace("toy.strict", "toy.strickt"))
    for action in ("save_to_run", "run"):
        assert "mistakes" in editor.edit(422, action=action)["refused"]
    assert editor.get("/preview").status == 409
    assert (editor.view()["run"], path.read_text()) == (None, GRAPH)


def test_a_run_that_cannot_begin_says_why(editor: Editor, path: Path) -> None:
    folder = path.parent / "runs" / "graph"
    folder.mkdir(parents=True)
    (folder / "notes.txt").write_text("mine")
    editor.edit(action="run")
    last = snapshots(editor)[-1]
    assert (last["state"], last["has_report"]) == ("not begun", False)
    assert "is not a run folder" in last["said"]


def waiting(folder: Path) -> str:
    """Return a graph of which a step waits once it has written a file."""
    node = f'  slow: {{use: toy.wait, in: a, with: {{begun: "{folder / "begun"}"}}}}\n'
    return GRAPH.replace("report:", f"{node}report:")


def wait_for(path: Path) -> None:
    while not path.exists():
        time.sleep(0.02)


def test_a_stopped_run_can_be_continued(editor: Editor, path: Path) -> None:
    editor.edit(text=waiting(path.parent))
    editor.edit(action="run")
    assert "stop it first" in editor.edit(422, action="run")["refused"]
    wait_for(path.parent / "begun")
    editor.edit(action="stop")
    last = snapshots(editor)[-1]
    assert last["state"] == "interrupted"
    assert "continues from there" in last["message"]
    editor.edit(text=GRAPH)
    editor.edit(action="run")
    last = snapshots(editor)[-1]
    assert (last["state"], last["nodes"]["a"]["text"]) == ("finished", "2 stored")


def test_a_part_of_the_labels_is_run(editor: Editor) -> None:
    assert editor.get("/preview").data["axes"] == [["start", ["1", "5"]]]
    part = editor.get(f"/preview?{urlencode({'only': json.dumps({'start': [0]})})}").data
    assert (part["steps"], part["nodes"][0]) == (3, ["a", 1, 1])
    editor.edit(action="run", arguments={"only": {"start": [0]}})
    last = snapshots(editor)[-1]
    assert (last["state"], last["only"], last["answer"]) == (
        "finished",
        "start 1",
        "start 1: It is 1.",
    )
    assert last["nodes"]["strict"]["text"] == "1 done"
    for places in ({"start": [2]}, {"other": [0]}, {"start": ["1"]}):
        refused = editor.edit(422, action="run", arguments={"only": places})["refused"]
        assert refused == "the axes have changed meanwhile; choose labels again"


def test_a_verdict_is_said_before_the_run_ends(editor: Editor, path: Path) -> None:
    editor.edit(text=waiting(path.parent).replace("[verdict]", "[a, verdict, strict]"))
    editor.edit(action="run")
    wait_for(path.parent / "begun")
    while not (now := editor.running.snapshot())["answer"]:
        assert not now["is_over"]
        time.sleep(0.1)
    assert (now["state"], now["answer"]) == ("running", "start 1: It is 1.")


def test_the_run_ends_with_the_editor(
    path: Path, toys: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(path.parent)
    path.write_text(waiting(path.parent))
    words = ("--plugin", toys.name, "--store", "store", "--no-browser")
    with served("edit", path.name, *words) as (address, process):
        ask(address, {"action": "run"})
        wait_for(path.parent / "begun")
        process.send_signal(signal.SIGHUP)  # which ends it as Ctrl-C does
        process.communicate()
    assert run_state(path.parent / "runs" / "graph") is RunState.INTERRUPTED


def test_a_graph_is_run_from_the_page(tab: Page, address: str) -> None:
    resize(tab, 1600, 900)
    tab.goto(address)
    tab.wait_for_selector("#picture [data-box=verdict]")
    tab.click(".cm-content")
    tab.keyboard.press("Control+Enter")
    until(tab, "document.getElementById('start').open")
    assert "6 of 6 steps are not stored" in tab.inner_text("#start-what")
    check_access(tab)
    tab.keyboard.press("Enter")
    until(tab, "document.getElementById('run-answer').textContent === 'start 1: It is 1.'")
    title = "document.querySelector('#picture [data-box={}] title').textContent"
    assert tab.evaluate(title.format("strict")) == "strict: 1 of 2 failed, 1 done"
    assert tab.evaluate(title.format("verdict")) == "verdict: 2 done"
    reached = "document.getElementById('run-reached').textContent"
    until(tab, f"{reached}.includes('finished, 6 of 6 steps')")
    tab.click("#run-nodes button")
    assert tab.evaluate("location.hash") == "#strict"
    assert "use: toy.strict" in tab.inner_text(".cm-chosen")
    check_access(tab)
    tab.click(".cm-content")
    tab.keyboard.press("Control+End")
    tab.keyboard.type("# more")
    until(tab, f"{title.format('verdict')} === 'verdict: before: 2 done'")
    assert "those of the earlier text" in tab.inner_text("#run-reached")
    with tab.context.expect_page() as opened:
        tab.click("#run-nodes a")
    opened.value.wait_for_load_state()
    until(opened.value, "document.body.textContent.includes('too large')")
    assert opened.value.evaluate("document.querySelector('h1').textContent") == "strict"
    tab.goto("about:blank")  # before the server ends


def test_labels_are_chosen_on_the_page(tab: Page, address: str) -> None:
    tab.goto(address)
    tab.wait_for_selector("#picture [data-box=verdict]")
    tab.click("#run")
    until(tab, "document.getElementById('start').open")
    tab.click("#start-only summary")
    tab.select_option("#start-start", label="5")
    until(tab, "/^3 of 3 steps/.test(document.getElementById('start-what').textContent)")
    check_access(tab)
    tab.click("#start-now")
    until(tab, "document.getElementById('run-answer').textContent === 'start 5: It is 5.'")
    assert tab.inner_text("#run-reached").startswith("Run graph, only start 5: ")
    tab.goto("about:blank")  # before the server ends


def check_access(tab: Page) -> None:
    """Check the page by axe, where that is installed."""
    assert not AXE or violations(tab) == []
