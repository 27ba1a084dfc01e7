"""Graphs and runs show themselves in a notebook."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from html.parser import HTMLParser
from types import SimpleNamespace
from typing import Any

import pytest

from nodegraph import node
from nodegraph.api import show_in_notebooks
from nodegraph.execute.results import Run
from nodegraph.graph import Graph
from nodegraph.notebook import graph_html, run_html

HOSTILE = "</style></div><script>alert(1)</script>&amp;\"'"
TEXT = f"""
    title: '{HOSTILE.replace("'", "''")}'
    axes: {{k: [-1, 2], trial: {{count: 30}}}}
    nodes:
      a: {{use: read.number, with: {{start: $k}}}}
      fill: {{in: a, alternatives: [fill.hold, strict.positive, strict.fails]}}
      text: {{use: text.write, with: {{text: '{HOSTILE.replace("'", "''")}'}}}}
      many: {{use: text.write, with: {{number: $trial}}}}
    skip: [{{k: 2, fill: hold}}]
    report: [text, many, fill]
"""
VOID = {"br", "img", "input", "hr", "meta", "link", "wbr"}


class Read(HTMLParser):
    """Reads a fragment, and fails where an element is closed that is not open."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.folded: list[bool] = []
        self.texts: list[str] = []
        self.feed(html)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if tag == "details":
            self.folded.append("open" not in dict(attrs))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "style" not in self.open:
            self.texts.append(" ".join(data.split()))


@pytest.fixture
def run(run_of: Callable[..., Run]) -> Run:
    return run_of(TEXT)


def test_a_graph_shows_its_title_axes_and_drawing(graph_of: Callable[..., Graph]) -> None:
    read = Read(graph_html(graph_of(TEXT)))
    assert "".join(read.texts).count(HOSTILE) >= 2
    assert "script" not in read.tags
    assert read.tags.count("svg") == 1
    assert "-1, 2" in read.texts
    assert "0 … 29 (30)" in read.texts
    assert "hold, positive, fails" in read.texts


def test_a_run_shows_how_its_steps_ended_and_why(run: Run) -> None:
    read = Read(run_html(run))
    assert "script" not in read.tags
    for text in ("1 failed", "1 refused", "Failed (1)", "Refused (1)", "Left out (1)"):
        assert text in read.texts
    shown = " ".join(read.texts)
    assert re.search(
        r"fill \(strict.fails\) -1.0 is negative \(toys.py:\d+\) k=-1, fill=fails", shown
    )
    assert "fill (strict.positive) -1.0 is negative k=-1, fill=positive" in shown


def test_a_run_shows_what_its_report_shows_and_folds_what_is_long(run: Run) -> None:
    read = Read(run_html(run))
    assert HOSTILE in read.texts
    assert "Many: 6 more combinations" in read.texts
    shown = [text for text in read.texts if re.fullmatch(r"trial=\d+", text)]
    assert shown == [f"trial={number}" for number in range(24)]
    notes, text, graph = [False, True, True], [False], [True]
    many, fill = [False] * 3 + [True] * 21, [False] * 3
    assert read.folded == notes + text + many + fill + graph


def test_failures_with_one_reason_are_listed_once(run_of: Callable[..., Run]) -> None:
    text = """
    axes: {trial: {count: 9}}
    nodes:
      a: {use: read.number}
      gaps: {use: gaps.cut, in: a, with: {seed: $trial}}
      b: {use: score.always, in: gaps}
    """

    @node("score.always")
    def always(recording: float) -> float:
        raise ValueError("always")

    shown = " ".join(Read(run_html(run_of(text, more=[always]))).texts)
    assert re.search(
        r"always \(test_notebook.py:\d+\) trial=0; trial=1; trial=2; and 6 more", shown
    )
    assert "Failed (9)" in shown


def test_colours_follow_the_reader_and_the_notebook(run: Run) -> None:
    html = run_html(run)
    assert ".nodegraph-notebook { color-scheme: light dark;" in html
    for mark in ('[data-jp-theme-light="false"]', ".vscode-dark", 'html[theme="dark"]'):
        assert mark in html
    ((light, dark),) = re.findall(
        r"\.nodegraph-notebook \{[^}]*--ink: light-dark\((#\w+), (#\w+)\)", html
    )
    assert light != dark


def test_nothing_is_fetched(run: Run) -> None:
    html = run_html(run)
    assert set(re.findall(r"https?://[^\"' >]+", html)) <= {"http://www.w3.org/2000/svg"}
    assert not re.search(r"@import|url\(|src=", html)


def test_ipython_shows_graphs_and_runs(monkeypatch: pytest.MonkeyPatch, run: Run) -> None:
    formatters: dict[type, Callable[[Any], str]] = {}
    html = SimpleNamespace(for_type=formatters.__setitem__)
    shell = SimpleNamespace(display_formatter=SimpleNamespace(formatters={"text/html": html}))
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    show_in_notebooks()
    assert formatters[Graph](run.plan.graph) == graph_html(run.plan.graph)
    assert formatters[Run](run) == run_html(run)


def test_a_graph_that_is_too_large_to_draw_says_so(graph_of: Callable[..., Graph]) -> None:
    nodes = "\n".join(f"  n{i}: {{use: read.number}}" for i in range(501))
    shown = graph_html(graph_of(f"nodes:\n{nodes}"))
    assert "<svg" not in shown
    assert "501 nodes are too many to draw here" in shown
