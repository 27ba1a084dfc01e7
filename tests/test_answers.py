"""One answer: every place that shows it says its sentence, its numbers and its marks, no others."""

from __future__ import annotations

import csv
import io
import json
import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from html import unescape
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page
from rich.console import Console

import nodegraph as ng
from nodegraph.cli.summary import print_summary, run_answer
from nodegraph.notebook import run_html
from nodegraph.report.from_run import compose
from nodegraph.report.page import page
from nodegraph.report.study import NoteSubject, Study
from nodegraph_compare.overview.pack import excerpt_of, packed
from nodegraph_compare.overview.value import Overview
from nodegraph_tables import Answer, info_of
from nodegraph_tables.answer import Finding
from nodegraph_tables.style import BEST
from nodegraph_tables.text import plain
from tests import odd_studies
from tests.browser import load
from tests.odd_studies import odd_study

SEEDS = (1, 4, 10, 11, 12, 13, 14, 17, 21, 23)
"""Few that draw studies of every kind; `tests.hostile` goes through all."""
ACTORS = """
nodegraph: 1
title: "Which fill is best?"
axes:
  actor: {{count: {actors}}}
  length: [5, 15]
nodes:
  face: {{use: synthesize.face, with: {{seconds: 2, seed: $actor, markers: 12}}}}
  gaps: {{use: gaps.cut, in: face, with: {{length: $length, count: 4, seed: 1}}}}
  fill: {{in: gaps.gappy, alternatives: {fills}}}
  error: {{use: score.gaps, in: {{estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}}}
  table: {{use: compare.table, in: error, with: {{compare: fill, within: [length]}}}}
report:
  - {{show: table{more}}}
"""


@dataclass(frozen=True)
class Shown:
    """A run, what its report is drawn from, and the files that it writes."""

    run: Any
    study: Study
    files: dict[str, bytes]

    @cached_property
    def answer(self) -> Answer:
        """The answer of the comparison."""
        return info_of(self.run["table"].value).answer

    @cached_property
    def overview(self) -> Overview:
        """The comparison."""
        value = self.run["table.overview"].value
        assert isinstance(value, Overview)
        return value

    @cached_property
    def html(self) -> str:
        """The page of the report."""
        return page(self.study)


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store that tests of the same faces share."""
    return tmp_path_factory.mktemp("store")


def shown(text: str, folder: Path, store: Path | None = None, **choices: Any) -> Shown:
    """Run a graph in this process."""
    (folder / "graph.yaml").write_text(text, encoding="utf-8")
    (folder / "odd.py").write_text(odd_studies.NODES, encoding="utf-8")
    files: dict[str, bytes] = {}

    def write(name: str, content: bytes) -> str:
        files[name] = content
        return ""

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        graph = ng.load(folder / "graph.yaml", plugins=[folder / "odd.py"], **choices)
        run = ng.run(graph, jobs=1, store=store)
        return Shown(run, compose(run, write=write).study, files)


def sentences(shown: Shown, folder: Path) -> Iterator[tuple[str, str]]:
    """Yield the sentence that each place says, by the place."""
    study, run = shown.study, shown.run
    html = shown.html
    match = re.search(r'<p class="(?:lead-)?sentence">(.*?)</p>', html, re.S)
    assert match is not None
    if "The data cannot tell" in match[1]:
        first, *_ = re.split(" Against | Not compared| Without ", match[1])
        assert "<strong" not in first, "no method stands out without a verdict"
    yield "page", unescape(re.sub(r"<[^>]*>", "", match[1]))
    stream = io.StringIO()
    console = Console(file=stream, width=400)
    print_summary(study, run, folder, console, full=False)
    yield "terminal", stream.getvalue().partition("\n")[0]
    yield "runs and gallery", study.short_answer(1)[0]
    answer = run_answer(study, run, folder)
    yield "JSON", answer.answer[0]
    (data,) = (
        each.data for each in answer.results if (each.node, each.output) == ("table", "table")
    )
    yield "JSON of the table", str(data["answer"]["sentence"])  # type: ignore[index]
    certainty = plain(shown.answer.certainty)
    assert data["answer"]["certainty"] == certainty  # type: ignore[index]
    assert certainty in unescape(re.sub(r"<[^>]*>", "", html))
    assert certainty in answer.answer or not certainty
    notebook = re.search(r'<p class="answer">(.*?)</p>', run_html(run), re.S)
    assert notebook is not None
    yield "notebook", unescape(notebook[1])


def read(shown: Shown, folder: Path) -> Iterator[str]:
    """Yield what people read of a run: page, terminal and LaTeX."""
    html = re.sub(r"<(script|style)\b.*?</\1>", "", shown.html, flags=re.S)
    yield unescape(re.sub(r"<[^>]*>", "", html))
    stream = io.StringIO()
    print_summary(shown.study, shown.run, folder, Console(file=stream, width=400), full=True)
    yield stream.getvalue()
    yield from (text.decode() for name, text in shown.files.items() if name.endswith(".tex"))


def check_places(shown: Shown, folder: Path) -> None:
    """Check that all places say what the answer says."""
    answer, overview = shown.answer, shown.overview
    said = " ".join(plain(answer.sentence).split())
    for place, sentence in sentences(shown, folder):
        assert " ".join(sentence.split()) == said, place
    # what is merely not decided has one name
    assert not re.search(
        r"\bt(ied?|ies)\b|not clearly (apart|behind|worse)", "".join(read(shown, folder))
    )
    verdicts = overview.verdicts
    assert overview.answer.sentence == answer.sentence
    assert overview.answer.scope == answer.scope
    marks = [marks_of(found) for found in answer.findings]
    assert [{*found.best, *found.behind, *found.tied} for found in answer.findings] == [
        {*found.mean} if found.verdict and not verdicts.is_sequence else set()
        for found in answer.findings
    ]
    if not verdicts.groups:
        return
    named = [str(method) for method in verdicts.methods]
    assert (answer.overall is None) == (verdicts.overall is None)
    if verdicts.overall is not None and answer.overall is not None:
        assert answer.overall.first == tuple(named[at] for at in verdicts.overall.best)
        first = {*answer.overall.best} if answer.overall.tied else set()
        assert {*answer.overall.tied} | first == {
            named[at] for at in verdicts.overall.marked("tied")
        }
    # charts, heat table, map and face are drawn from this
    data = packed(overview, verdicts, excerpt_of(overview), "table", {})
    for group, found, (_, tied) in zip(data["groups"], answer.findings, marks, strict=True):
        assert {named[at] for at in group["best"]} == ({*found.best} if found.behind else set())
        assert {named[at] for at in group["tied"]} == tied
        drawn = {
            name: mean for name, mean in zip(named, group["mean"], strict=True) if mean is not None
        }
        assert drawn == {name: float(f"{mean:.6g}") for name, mean in found.mean.items()}
    table = shown.run["table"].value
    info = info_of(table)
    for marked, at in ((info.best, 0), (info.tied, 1)):
        every = sum(len(mark[at]) for mark in marks)
        rows = [row for column in marked.values() for row in column if row not in info.overall]
        assert len(rows) == every, (marked, marks)
    check_cards(overview, marks)
    if not any(best for best, _ in marks) and not (verdicts.overall and verdicts.overall.marks):
        assert b"textbf" not in shown.files.get("table.tex", b"")
        assert BEST.encode() not in shown.files.get("table_figure.svg", b"")
    if not verdicts.within or "mean" not in table:
        return
    text = shown.files["table.csv"].decode()
    written = sorted(float(row["mean"]) for row in csv.DictReader(io.StringIO(text)) if row["mean"])
    means = sorted(mean for found in answer.findings for mean in found.mean.values())
    overall = verdicts.overall
    over_all: list[float] = [] if overall is None else overall.mean[overall.known].tolist()
    assert written == sorted([*means, *over_all])


def marks_of(found: Finding) -> tuple[set[str], set[str]]:
    """Return the methods that are marked as the best, or, if several may be, these."""
    if not found.behind:
        return set(), set()
    return (set(), {*found.best, *found.tied}) if found.tied else ({*found.best}, set())


def check_cards(overview: Overview, marks: list[tuple[set[str], set[str]]]) -> None:
    """Check that cards mark the methods that are best, and not certain to be worse."""
    for card, found, (best, tied) in zip(
        overview.answer.cards, overview.answer.findings, marks, strict=False
    ):
        # without a verdict a headline names at most the only method
        named = {part.method for part in card.headline if not isinstance(part, str)}
        assert card.kind == ("best" if best else "tied" if tied else "rest")
        assert not found.behind or named == {*found.best}
        assert ("clearly best" in plain(card.status)) == bool(best and card.status)
        is_behind = overview.answer.take in found.behind
        assert ("clearly behind" in plain(card.status)) == (is_behind and not best)
        if card.rows is None or overview.verdicts.is_sequence:
            continue
        rows = (*card.rows.rows, *card.rows.others)
        assert [{row.name for row in rows if row.kind == kind} for kind in ("best", "tied")] == [
            best, tied,
        ]  # fmt: skip


def check_charts(tab: Page, shown: Shown, folder: Path) -> None:
    """Check that charts, and what is written above and below them, mark what the answer does."""
    (folder / "report.html").write_text(shown.html, encoding="utf-8")
    load(tab, folder / "report.html")
    best = {name for found in shown.answer.findings for name in found.best if found.behind}
    marked = tab.evaluate(
        """[...document.querySelectorAll(
        "[data-chart] :is(.best, .first):not(.map, .row-value), .map.best h4, p.finding b",
        )].map((mark) => mark.closest("[data-method]")?.dataset.method ?? mark.firstChild.data)"""
    )
    assert {*marked} <= best
    said = tab.evaluate("document.querySelector('[data-overview]').textContent")
    assert bool(best) or not re.search(r"\bbest\b", said)


def check_odd(seed: int, folder: Path) -> bool:
    """Check the study of a seed; return whether it has a comparison at all."""
    it = shown(odd_study(seed, most=60).text, folder, folder / "store")
    tables = [s for s in it.study.sections if s.node == "table"]
    assert it.study.answer
    failed = [note.reason for note in it.study.notes if note.kind is NoteSubject.FAILED]
    assert not [reason for reason in failed if "cannot be" in reason]
    if not tables or len([*it.run["table"].labels()]) > 1:
        return False
    check_places(it, folder)
    return True


def test_the_seeds_draw_every_kind_of_study() -> None:
    drawn = [odd_study(seed, most=60) for seed in SEEDS]
    assert {kind for study in drawn for kind in study.methods.values()} == {
        *("plain", "tie", "refused", "fails", "nothing"),
    }
    nodes = [json.loads(study.text)["nodes"] for study in drawn]
    assert {"ranks", "beliefs", "plain"} <= {name for each in nodes for name in each}
    options = {name for each in nodes for name in each["table"]["with"]}
    assert {"blocks", "clusters", "fallback", "better"} <= options
    assert {"baseline", "beside", "columns"} <= options


@pytest.mark.parametrize("seed", SEEDS)
def test_all_places_say_what_the_answer_says(tmp_path: Path, seed: int) -> None:
    check_odd(seed, tmp_path)


@pytest.mark.parametrize("actors", [1, 4, 5, 8])
def test_all_places_agree_with_and_without_a_verdict(
    tab: Page, tmp_path: Path, store: Path, actors: int
) -> None:
    fills = "[fill.linear, fill.ridge, fill.cubic]"
    it = shown(ACTORS.format(actors=actors, fills=fills, more=""), tmp_path, store)
    check_places(it, tmp_path)
    check_charts(tab, it, tmp_path)
    scope = plain(it.answer.scope)
    assert " ".join(it.answer.held.split()) in it.files["table.tex"].decode()
    assert f"<strong>{it.answer.held.split('. ')[-1]}</strong>" in it.html
    assert any(found.verdict for found in it.answer.findings) == (actors > 4)
    held = {
        1: "One synthetic recording, 2 s, 12 markers, 60 Hz: nothing is said for further gaps",
        4: "4 synthetic faces (2 s, 12 markers, 60 Hz): only the intervals hold",
        5: "5 synthetic faces (2 s, 12 markers, 60 Hz): holds for further synthetic faces; "
        "untested on people. Provisional, as of 5 synthetic faces.",
        8: "8 synthetic faces (2 s, 12 markers, 60 Hz): holds for further synthetic faces; "
        "untested on people.",
    }
    assert scope.replace("\N{NO-BREAK SPACE}", " ").startswith(held[actors])
    overview = it.overview
    data = packed(overview, overview.verdicts, excerpt_of(overview), "table", {})
    times = data["within"][0]["times"].replace("\N{NO-BREAK SPACE}", " ")
    assert times == "Length: 5 frames (83 ms), 15 frames (250 ms)."
    titles = [found.title.replace("\N{NO-BREAK SPACE}", " ") for found in it.answer.findings]
    assert titles == ["length 5 frames (83 ms)", "length 15 frames (250 ms)"]


def test_one_method_and_none_that_finished_have_an_answer(tmp_path: Path, store: Path) -> None:
    alone = shown(ACTORS.format(actors=1, fills="[fill.linear]", more=""), tmp_path, store)
    assert "There is nothing to compare it to." in plain(alone.answer.sentence)
    check_places(alone, tmp_path)
    none = ACTORS.format(actors=1, fills="[fill.linear]", more="").replace("count: 4", "count: 400")
    assert shown(none, tmp_path, store).study.answer == (
        "No step that the report shows has a result.",
    )


def test_an_answer_of_the_graph_is_said_everywhere_or_refused_with_its_place(
    tmp_path: Path, store: Path
) -> None:
    words = ", answer: 'Cubic is out: {behind cubic}; {scope}'"
    fills = "[fill.linear, fill.ridge, fill.cubic]"
    it = shown(ACTORS.format(actors=5, fills=fills, more=words), tmp_path, store)
    said = {sentence for place, sentence in sentences(it, tmp_path) if place != "JSON of the table"}
    assert len(said) == 1
    assert said.pop().startswith("Cubic is out: cubic; 5 synthetic faces (2")
    assert it.study.ok
    wrong = ACTORS.format(actors=5, fills=fills, more=words.replace("behind", "best"))
    refused = shown(wrong, tmp_path, store)
    (note,) = (note for note in refused.study.notes if note.kind is NoteSubject.FAILED)
    assert re.match(r".*graph\.yaml:14:27: 'answer': \{best cubic\} for length 5", note.reason)
    check_places(refused, tmp_path)
    # the author wrote of other methods
    fewer = shown(wrong, tmp_path, store, only={"fill": ["linear", "ridge"]})
    assert fewer.study.ok
    assert any("so it is not shown: {best cubic}" in note.reason for note in fewer.study.notes)
    check_places(fewer, tmp_path)
