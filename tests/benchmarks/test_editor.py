"""The page of `nodegraph edit`: what a person waits for, and how smoothly the picture moves."""

from __future__ import annotations

import gzip
import json
import time
from collections.abc import Iterator
from datetime import datetime
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page
from starlette.responses import PlainTextResponse

from nodegraph.editor.file import EditedFile
from nodegraph.editor.page import page as page_of
from nodegraph.plugin.registry import Registry, default_registry
from nodegraph.serve.guard import Guard
from tests.benchmarks.conftest import Clock
from tests.benchmarks.tables import Tables
from tests.browser import needs_axe, resize, violations
from tests.environments import ROOT
from tests.nodegraph.edit.graph_texts import Writer
from tests.nodegraph.editor.conftest import Editor, served_page
from tests.nodegraph.editor.test_edits import edited_and_undone
from tests.nodegraph.serve.requests import HOST, ORIGIN, send
from tests.nodegraph.serve.test_server import served

CASE = "nodegraph edit"
FRAMES = 60
SEQUENCES = 10_000
UNTIL_DRAWN = """
async (id) => {
  const drawn = new Promise((done) => {
    const look = new MutationObserver(() => { look.disconnect(); done(); });
    look.observe(document.querySelector("#picture"), { subtree: true, childList: true });
  });
  const begin = performance.now();
  document.getElementById(id).click();
  await drawn;
  await new Promise(requestAnimationFrame);
  await new Promise(requestAnimationFrame);
  return performance.now() - begin;
}
"""
UPDATES = """
() => new Promise((done) => {
  const updates = [];
  const Source = window.EventSource;
  window.EventSource = class extends Source {
    constructor(address) {
      super(address);
      this.addEventListener("message", ({ data }) => {
        const { state, seconds, is_over } = JSON.parse(data);
        updates.push({ state, seconds, at: Date.now() });
        if (is_over) done(updates);
      });
    }
  };
  document.getElementById("start-now").click();
})
"""
TOYS = """\
from nodegraph import node

@node("toy.number")
def number(*, start: int = 1) -> float:
    return float(start)

@node("toy.add")
def add(x: float, *, amount: int = 1) -> float:
    return x + amount
"""


def graph_text(count: int) -> str:
    """Return a graph of so many nodes: branches of fills, filters and scores."""
    lines = ["nodegraph: 1", "nodes:"]
    lines += ["  capture: {use: read.recording, with: {path: sample:face}}"]
    lines += ["  gaps: {use: gaps.cut, in: capture}"]
    for at in range(2, count):
        before = "gaps.gappy" if at < 10 else f"n{at - 4 - at % 4}"
        use = "fill.linear" if at % 2 else "smooth.butterworth"
        if at % 4 == 3 and at > 10:
            feeds = f"{{estimate: {before}, truth: gaps.truth, hidden: gaps.hidden}}"
            lines.append(f"  n{at}: {{use: score.gaps, in: {feeds}}}")
        else:
            lines.append(f"  n{at}: {{use: {use}, in: {before}}}")
    return "\n".join([*lines, ""])


@pytest.fixture(scope="module")
def registry() -> Registry:
    return default_registry()


@pytest.fixture
def page(tab: Page, tmp_path: Path, registry: Registry) -> Iterator[Page]:
    """The page of a graph of 500 nodes."""
    path = tmp_path / "graph.yaml"
    path.write_text(graph_text(500))
    with served_page(path, registry) as address:
        resize(tab, 1600, 900)
        tab.goto(address)
        tab.wait_for_selector("#picture [data-box=n499]", state="attached")
        yield tab
        tab.goto("about:blank")


def test_open_and_save_change_no_byte(tmp_path: Path, tables: Tables) -> None:
    texts = [path.read_bytes() for path in sorted((ROOT / "graphs").rglob("*.yaml"))]
    texts += [Writer(seed).text.encode() for seed in range(1000)]
    path = tmp_path / "graph.yaml"
    changed = 0
    for text in texts:
        path.write_bytes(text)
        file = EditedFile(path)
        file.edit(file.shown)
        file.save()
        changed += path.read_bytes() != text
    tables.put(CASE, f"open and save {len(texts):,} files", "files changed", changed)
    assert changed == 0


def test_edits_undone_give_the_first_bytes(
    tmp_path: Path, registry: Registry, tables: Tables
) -> None:
    path = tmp_path / "graph.yaml"
    changed = 0
    for seed in range(SEQUENCES):
        edited_and_undone(path, registry, seed, edits=4)
        changed += path.read_bytes() != Writer(seed).text.encode()
    tables.put(CASE, f"{SEQUENCES:,} sequences of edits, undone", "files changed", changed)
    assert changed == 0


@pytest.mark.parametrize("count", [30, 300])
def test_command_to_first_picture(tab: Page, tmp_path: Path, count: int, tables: Tables) -> None:
    path = tmp_path / "graph.yaml"
    path.write_text(graph_text(count))
    for _ in range(2):  # the first time, what was not compiled at installation is
        begin = time.perf_counter()
        words = ("edit", str(path), "--no-browser")
        with served(*words, PYTHONDONTWRITEBYTECODE="") as (address, _):
            tab.goto(address)
            tab.wait_for_selector(".cm-line >> nth=2")
            text = time.perf_counter() - begin
            tab.wait_for_selector(f"#picture [data-box=n{count - 1}]", state="attached")
            picture = time.perf_counter() - begin
            tab.goto("about:blank")
            tab.context.clear_cookies()
    tables.put(CASE, f"{count} nodes", "first text, s", text)
    tables.put(CASE, f"{count} nodes", "first picture, s", picture)


@pytest.mark.parametrize("count", [100, 1000])
def test_edit_to_checked_view(tmp_path: Path, registry: Registry, count: int, clock: Clock) -> None:
    path = tmp_path / "graph.yaml"
    path.write_text(graph_text(count))
    editor = Editor(path, registry)
    text, seeds = path.read_text(), iter(range(100))

    def edit() -> object:
        seed = f"in: capture, with: {{seed: {next(seeds)}}}}}"
        return editor.edit(text=text.replace("in: capture}", seed))["problems"]

    assert clock(CASE, f"{count:,} nodes", "edit to view, ms", edit, scale=1e3) == []


@pytest.mark.parametrize("count", [100, 1000])
def test_edit_to_drawn_picture(
    tab: Page, tmp_path: Path, registry: Registry, count: int, tables: Tables
) -> None:
    path = tmp_path / "graph.yaml"
    text = graph_text(count)
    path.write_text(text)
    with served_page(path, registry) as address:
        tab.goto(address)
        tab.wait_for_selector(f"#picture [data-box=n{count - 1}]", state="attached")
        path.write_text(text.replace("in: capture}", "in: capture, with: {seed: 1}}"))
        tab.wait_for_selector("#undo:enabled")
        times = [float(tab.evaluate(UNTIL_DRAWN, id)) for id in ("undo", "redo") * 4]
        tab.goto("about:blank")
    tables.put(CASE, f"{count:,} nodes", "edit to picture, ms", min(times))


def frames(page: Page, step: str) -> float:
    """Return the frames in a second while something is done at each."""
    seconds = page.evaluate(
        f"""async () => {{
          const pane = document.getElementById("picture");
          const {{ left, top }} = pane.getBoundingClientRect();
          const step = (n) => {{ {step}; }};
          await new Promise(requestAnimationFrame);
          const begin = performance.now();
          for (let n = 0; n < {FRAMES}; n += 1) {{
            step(n);
            await new Promise(requestAnimationFrame);
          }}
          return (performance.now() - begin) / 1000;
        }}"""
    )
    return FRAMES / float(seconds)


def test_a_large_picture_moves(page: Page, tables: Tables) -> None:
    wheel = (
        "pane.dispatchEvent(new WheelEvent('wheel', { cancelable: true, ctrlKey: true, "
        "clientX: left + 300, clientY: top + 200, deltaY: n % 30 < 15 ? -10 : 10 }))"
    )
    for what, step in (("zoom", wheel), ("drag", "pane.scrollBy(0, 20)")):
        frames(page, step)  # the first time, all is drawn
        tables.put(CASE, "500 nodes", f"{what}, frames/s", frames(page, step))


def test_a_run_is_shown_a_few_times_a_second(tab: Page, tmp_path: Path, tables: Tables) -> None:
    toys, path = tmp_path / "toys.py", tmp_path / "graph.yaml"
    toys.write_text(TOYS)
    nodes = "a: {use: toy.number, with: {start: $start}}, b: {use: toy.add, in: a}"
    path.write_text(f"nodegraph: 1\naxes: {{start: {{count: 5000}}}}\nnodes: {{{nodes}}}\n")
    with served_page(path, Registry.installed([toys]), toys) as address:
        tab.goto(address)
        tab.wait_for_selector("#picture [data-box=b]")
        tab.click("#run")
        tab.wait_for_selector("#start[open]")
        updates = tab.evaluate(UPDATES)
        tab.goto("about:blank")
    began = json.loads((tmp_path / "runs/graph/events.jsonl").open().readline())["began"]
    begin = datetime.fromisoformat(began).timestamp()
    late = [
        now["at"] / 1000 - begin - now["seconds"]
        for before, now in pairwise(updates)
        if now["seconds"] > before["seconds"]
    ]
    seconds = (updates[-1]["at"] - updates[0]["at"]) / 1000
    tables.put(CASE, "a run of 10,000 steps", "updates/s", len(updates) / seconds)
    tables.put(CASE, "a run of 10,000 steps", "late, ms", max(late) * 1000)
    assert updates[-1]["state"] == "finished"


def test_attacks_are_refused(tables: Tables) -> None:
    guard = Guard(PlainTextResponse("secret"), HOST)
    cookie = send(guard, f"/?token={guard.token}").headers["set-cookie"].partition(";")[0]
    own: dict[str, Any] = {"cookie": cookie, "content_type": "application/json"}
    own["content_length"] = "0"
    assert send(guard, "/", method="POST", origin=ORIGIN, **own).text == "secret"
    attacks: dict[str, dict[str, Any]] = {
        "no token": {"origin": ORIGIN, "cookie": ""},
        "other Origin": {"origin": "https://attacker.example"},
        "Origin null": {"origin": "null"},
        "no Origin": {},
        "rebound Host": {"origin": ORIGIN, "host": "attacker.example"},
        "cross-site": {"origin": ORIGIN, "sec_fetch_site": "cross-site"},
    }
    answers = [send(guard, "/", method="POST", **{**own, **each}) for each in attacks.values()]
    answered = sum(answer.status == 200 for answer in answers)
    tables.put(CASE, f"{len(attacks)} attacks", "answered", answered)
    assert answered == 0


@needs_axe
def test_the_page_is_accessible(
    tab: Page, tmp_path: Path, registry: Registry, tables: Tables
) -> None:
    path = tmp_path / "graph.yaml"
    path.write_text(graph_text(30))
    found: list[str] = []
    with served_page(path, registry) as address:
        tab.goto(address)
        tab.click("#picture [data-box=gaps]")
        tab.wait_for_selector("#panel fieldset")
        for scheme in ("light", "dark"):
            tab.emulate_media(color_scheme=scheme)
            found += violations(tab)
        tab.goto("about:blank")
    tables.put(CASE, "axe, light and dark", "violations", len(found))
    assert found == []


def test_first_load(tmp_path: Path, tables: Tables) -> None:
    path = tmp_path / "graph.yaml"
    path.write_text(graph_text(30))
    size = len(gzip.compress(page_of(EditedFile(path)).body))
    tables.put(CASE, "first load", "kB gzip", size / 1000)
