"""Reports of odd studies: markup in names, ties, nothing finite, many rows, any shape."""

from __future__ import annotations

import csv
import json
from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page

from nodegraph.report.study import NoteSubject, Study, read_study
from tests import odd_studies
from tests.browser import load
from tests.odd_studies import odd_study
from tests.studies import command

MARKUP = "<script>window.ran = 1</script>"
HANDLER = "<img src=x onerror='window.ran = 1'>"
NO_FORMULA = r"$\frac$"
NODES = '''
from playwright.sync_api import Page
from nodegraph import Refusal, node
from nodegraph_mocap import Table, Trajectories
from nodegraph_tables import TableInfo, with_info


@node("odd.score", cite="none")
def score(recording: Trajectories, *, kind: str = "plain", trial: int = 0, more: int = 0) -> Table:
    """Score as badly as asked.

    Parameters
    ----------
    kind
        Which way.
    trial
        Added to the score.
    more
        Added to the score.
    """
    import pandas as pd

    if kind == "refused":
        raise Refusal("<b onclick='window.ran = 1'>cannot</b>")
    if kind == "fails":
        raise ValueError("<script>window.ran = 1</script>")
    odd = {"nothing": float("nan"), "endless": float("inf"), "zero": 0.0}
    value = odd.get(kind, 1.5 + trial + more)
    made = pd.DataFrame({"gap": [0, 1], "rmse": [value, 2 * value]})
    info = TableInfo(title="<script>window.ran = 1</script>", units={"rmse": "mm"})
    return with_info(made, info)
'''
ODD = f"""
nodegraph: 1
title: "{MARKUP} & a question"
notes: |
  {MARKUP} and {HANDLER}, [a link](javascript:window.ran=1).
axes:
  trial: [0]
  kind:
    "{MARKUP}": plain
    '{NO_FORMULA}': plain
    tie: plain
    nothing: nothing
    endless: endless
    zero: zero
    refused: refused
    fails: fails
nodes:
  x:
    use: points.literal
    with: {{points: {{"{MARKUP}": [1, 1], "{HANDLER}": [1, 2], c: [3, 2]}}}}
  y: {{use: noise.add, in: x, with: {{sigma: 0.1, seed: 1}}}}
  score: {{use: odd.score, in: x, with: {{kind: $kind, trial: $trial}}}}
  table: {{use: compare.table, in: score, with: {{compare: kind, blocks: [trial, gap]}}}}
  ranks: {{use: compare.ranks, in: score, with: {{compare: kind, blocks: [trial, gap]}}}}
  one: {{use: compare.table, in: {{scores: {{from: score, at: {{kind: tie}}}}}}}}
  faces: {{use: plot.faces, in: {{recordings: {{"{MARKUP}": x, '{NO_FORMULA}': y.noisy}}}}}}
  lines: {{use: plot.trajectories, in: {{recordings: {{"{MARKUP}": x, '{NO_FORMULA}': y.noisy}}}}}}
  playback: {{use: plot.playback, in: {{recordings: {{"{MARKUP}": x, y: y.noisy}}, truth: x}}}}
report: [table, ranks, one, faces, lines, playback, score]
"""
MANY = """
nodegraph: 1
title: Many rows
axes:
  a: {count: 24}
  b: {count: 8}
nodes:
  x: {use: points.literal, with: {points: {a: [1, 1], b: [1, 2], c: [3, 2]}}}
  score: {use: odd.score, in: x, with: {trial: $a, more: $b}}
  table: {use: compare.table, in: score, with: {metric: rmse, within: [a, gap], compare: b}}
report: [table]
"""


def run_of(text: str, folder: Path, nodes: str = NODES) -> Path:
    """Run a graph with the odd nodes; some of its steps may fail."""
    (folder / "graph.yaml").write_text(text)
    (folder / "odd.py").write_text(nodes)
    words = ("--plugin", "odd.py", "--out", "run", "--no-cache")
    ended = command("run", "graph.yaml", *words, folder=folder)
    assert (folder / "run" / "report.html").is_file(), ended.err
    return folder / "run"


@pytest.fixture(scope="module")
def odd(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run_of(ODD, tmp_path_factory.mktemp("odd"))


def test_markup_in_names_is_shown_and_never_run(odd: Path, tab: Page) -> None:
    load(tab, odd / "report.html")
    assert tab.evaluate("window.ran") is None
    assert tab.evaluate("document.querySelector('h1').textContent") == f"{MARKUP} & a question"
    assert tab.evaluate("document.querySelectorAll('img, a[href^=javascript]').length") == 0
    for place in (
        "td, th",
        ".playback .name span",
        "caption",
        "svg text",
        ".prose",
        ".combinations, .notes",
    ):
        texts = tab.evaluate(
            f"[...document.querySelectorAll({place!r})].map((one) => one.textContent)"
        )
        assert any("<script>window.ran" in text for text in texts), place
    figures = tab.evaluate(
        "[...document.querySelectorAll('figure.figure > svg')].map((one) => one.textContent)"
    )
    assert len(figures) == 3
    assert all(NO_FORMULA in text for text in figures if "<script>" in text)
    assert sum(NO_FORMULA in text for text in figures) >= 3
    tab.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    tab.click(".playback [aria-label=Play]")
    assert tab.evaluate("window.ran") is None


def test_the_page_beside_the_report_runs_no_markup_either(odd: Path, tab: Page) -> None:
    load(tab, next(odd.glob("playback*.html")))
    assert tab.evaluate("window.ran") is None


def test_ties_one_trial_and_what_is_not_finite_are_said(odd: Path, tab: Page) -> None:
    load(tab, odd / "report.html")
    answer = tab.evaluate("document.querySelector('.answer').textContent")
    assert "The data cannot tell which is best: one trial where 3 are needed" in answer
    assert "Lowest mean rmse: zero (0\N{NO-BREAK SPACE}mm), then " in answer
    assert tab.evaluate("document.querySelector('.lead-rows tr').textContent").startswith("zero")
    rows = tab.evaluate(
        "[...document.querySelector('figure.table table').tBodies[0].rows]"
        ".map((row) => [...row.cells].map((cell) => cell.textContent))"
    )
    by_kind = {row[0]: row[1:] for row in rows}
    assert by_kind[MARKUP] == by_kind["tie"]
    for kind in ("nothing", "endless"):
        assert by_kind[kind][:2] == ["0", ""]
    assert by_kind["refused"][-2] == by_kind["fails"][-2] == "100"  # percent
    replaced = ("table_figure", "one_figure")
    drawn = tab.evaluate("document.querySelectorAll('.result figure.figure > svg').length")
    assert drawn == len([path for path in odd.glob("*.svg") if path.stem not in replaced])
    text = tab.evaluate("document.querySelector('#notes').parentElement.textContent")
    assert "cannot</b>" in text
    assert "Repeat it alone" in text


def test_markers_without_edges_are_drawn_and_played(odd: Path, tab: Page) -> None:
    load(tab, odd / "report.html")
    state = tab.evaluate("document.querySelector('figure.playback').playback.state")
    assert [panel["label"] for panel in state["panels"]] == ["truth", MARKUP, "y"]
    assert all(len(panel["dots"]) == 9 for panel in state["panels"])


def test_many_rows_are_folded_filter_and_sort(tmp_path: Path, tab: Page) -> None:
    folder = run_of(MANY, tmp_path)
    load(tab, folder / "report.html")
    tab.evaluate("window.figure = [...document.querySelectorAll('figure.table')].at(-2)")
    rows = "[...figure.querySelector('table').tBodies[0].rows]"
    seen = f"{rows}.filter((row) => row.checkVisibility())"
    assert tab.evaluate(f"{rows}.length") == 2 * 24 * 8
    assert 0 < tab.evaluate(f"{seen}.length") <= 40
    assert tab.evaluate("document.documentElement.scrollHeight") < 20_000
    filter_by = "figure.querySelector('input')"
    tab.evaluate(f"{filter_by}.value = '23 0'; {filter_by}.dispatchEvent(new Event('input'))")
    assert tab.evaluate(f"{seen}.every((row) => row.cells[0].textContent === '23')")
    tab.evaluate(f"{filter_by}.value = ''; {filter_by}.dispatchEvent(new Event('input'))")
    unfold = "figure.querySelector('.tools > button')"
    assert tab.evaluate(f"{unfold}.textContent") == "Show all 384 rows"
    tab.evaluate(f"{unfold}.click()")
    assert tab.evaluate(f"{seen}.length") == 2 * 24 * 8
    head = "figure.querySelectorAll('thead button')[0]"
    tab.evaluate(f"{head}.click(); {head}.click()")
    assert tab.evaluate(f"{rows}[0].cells[0].textContent") == "23"
    scroll = "figure.querySelector('.scroll')"
    tab.evaluate(f"{scroll}.scrollTop = 5000")
    top = f"{head}.getBoundingClientRect().top - {scroll}.getBoundingClientRect().top"
    assert 0 <= tab.evaluate(top) < 40
    assert (folder / "report.html").stat().st_size < 1e6


MINIMAL = """
nodegraph: 1
nodes:
  face: {use: synthesize.face, with: {seconds: 2}}
  gaps: {use: gaps.cut, in: face, with: {length: 10, seed: 1}}
  fill: {in: gaps.gappy, alternatives: [fill.linear, fill.burke_lasenby, fill.cubic]}
  error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
  table: {use: compare.table, in: error, with: {compare: fill}}
report: [table]
"""


def test_a_refused_method_is_left_out_of_the_charts(tmp_path: Path, tab: Page) -> None:
    (tmp_path / "graph.yaml").write_text(MINIMAL)
    for _ in range(2):  # then from the store
        ended = command("run", "graph.yaml", "--out", "run", folder=tmp_path)
        assert (ended.status, "cannot be shown" in ended.out) == (0, False), ended.out
    load(tab, tmp_path / "run" / "report.html")
    places = "document.querySelectorAll('.map-chart .map:first-child .%s').length"
    assert tab.evaluate(places % "disc") > 0
    assert tab.evaluate(places % "disc") + tab.evaluate(places % "place") == 60
    assert "Hollow: a marker without gaps." in tab.inner_text(".map-chart")


def overview_of(study: Study) -> dict[str, list[dict[str, Any]]]:
    """Return the data of the first charts of a report; nothing without any."""
    start = '<script type="application/json" id="overview-table">'
    pages = [section.rendered.html for section in study.sections if section.node == "table"]
    html = next((html for html in pages if start in html), f"{start}{{}}</script>")
    data: dict[str, list[dict[str, Any]]] = json.loads(
        html.partition(start)[2].partition("</script>")[0]
    )
    return data


def check_odd(seed: int, folder: Path) -> Path:
    """Run the study of a seed; its report must be whole, and its charts have the table's means."""
    odd = odd_study(seed)
    run = run_of(odd.text, folder, odd_studies.NODES)
    study = read_study(run)
    failed = [note.reason for note in study.notes if note.kind is NoteSubject.FAILED]
    assert not [reason for reason in failed if "cannot be" in reason], (seed, failed)
    data = overview_of(study)
    assert {each["label"] for each in data.get("methods", ())} <= {*odd.methods}, seed
    if not data:
        return run
    of_table = (each for each in study.sections if (each.node, each.output) == ("table", ""))
    path = next(file.path for section in of_table for file in section.files if file.text == "CSV")
    with (run / path).open(newline="", encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    if rows and "mean" in rows[0]:
        said: dict[float, int] = defaultdict(int)
        for row in rows:
            if row["mean"] and all(row[each["name"]] for each in data["within"]):
                said[float(f"{float(row['mean']):.6g}")] += 1
        drawn: dict[float, int] = defaultdict(int)
        for group in data["groups"]:
            for mean in group["mean"]:
                if mean is not None:
                    drawn[mean] += 1
        assert drawn == said, seed
    return run


@pytest.mark.parametrize("seed", [10, 11, 12, 13])
def test_any_shape_of_a_report_opens_and_hides_nothing(
    tmp_path: Path, tab: Page, seed: int
) -> None:
    run = check_odd(seed, tmp_path)
    load(tab, run / "report.html")
    title = json.loads(odd_study(seed).text)["title"]
    assert tab.evaluate("document.querySelector('h1').textContent") == title
    tab.evaluate("document.querySelectorAll('details').forEach((fold) => { fold.open = true; })")
    marks = "document.querySelectorAll('.overview [role=button], .overview button')"
    tab.evaluate(
        f"[...{marks}].slice(0, 20).forEach((mark) => mark.dispatchEvent(new Event('click')))"
    )
    assert tab.evaluate("document.querySelector('#download').checkVisibility()")
    assert tab.evaluate("document.documentElement.scrollWidth") <= 1280
    assert tab.evaluate("window.ran") is None
