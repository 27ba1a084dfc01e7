"""A study says what the run came to: results, methods, and everything that did not go well."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from nodegraph import Files, Kind, Rendered, hookimpl, node
from nodegraph.execute.results import Run
from nodegraph.execute.run import execute
from nodegraph.execute.settings import RunSettings
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry
from nodegraph.report.from_run import compose
from nodegraph.report.page import page
from nodegraph.report.study import StepNote, Study

SETTINGS = RunSettings("toy.yaml")
COMMAND = SETTINGS.command
TEXT = """
    title: A toy
    inputs: {start: 3}
    axes: {length: [5, 15], trial: {count: 2}}
    nodes:
      capture: {use: read.number, with: {start: $start}}
      gaps: {use: gaps.cut, in: capture, with: {length: $length, seed: $trial}}
      fill: {in: gaps.gappy, alternatives: [fill.hold, strict.positive, strict.fails]}
      text: {use: text.write, with: {number: $length}}
    skip: [{fill: hold, trial: 1}]
    report: [text, gaps.hidden]
"""


def _study(run: Run) -> Study:
    return compose(run)[0]


def _kinds(notes: tuple[StepNote, ...], kind: str) -> list[tuple[str, str]]:
    return [(note.node, note.labels) for note in notes if note.kind == kind]


def test_sections_are_what_the_report_lists_at_every_combination(
    run_of: Callable[..., Run],
) -> None:
    study = _study(run_of(TEXT))
    shown = [(section.title, section.labels, section.rendered.text) for section in study.sections]
    assert shown == [
        ("Text", "length=5", "5"),
        ("Text", "length=15", "15"),
        ("Gaps hidden", "length=5, trial=0", "5"),
        ("Gaps hidden", "length=5, trial=1", "5"),
        ("Gaps hidden", "length=15, trial=0", "15"),
        ("Gaps hidden", "length=15, trial=1", "15"),
    ]


def test_without_a_list_the_nodes_that_nothing_reads_are_shown(
    run_of: Callable[..., Run],
) -> None:
    text = "nodes: {a: {use: read.number}, b: {use: fill.hold, in: a}, c: {use: text.write}}"
    assert [section.title for section in _study(run_of(text)).sections] == ["B", "C"]


def test_an_entry_gives_its_title_its_caption_and_notes(run_of: Callable[..., Run]) -> None:
    entry = "{show: text, at: {length: $first}, title: A title, caption: In words., notes: '*So.*'}"
    study = _study(run_of(TEXT.replace("report: [text,", f"report: [{entry},")))
    shown = [
        (each.title, each.labels, each.caption, each.notes_markdown) for each in study.sections
    ]
    assert shown[:2] == [
        ("A title", "length=5", "In words.", "*So.*"),
        ("Gaps hidden", "length=5, trial=0", "", ""),
    ]


def test_whatever_did_not_go_well_is_noted(run_of: Callable[..., Run]) -> None:
    notes = _study(run_of(TEXT)).notes
    below = ["length=5, trial=0", "length=5, trial=1", "length=15, trial=0", "length=15, trial=1"]
    refused = [("fill", f"{value}, fill=positive") for value in below]
    failed = [("fill", f"{value}, fill=fails") for value in below]
    assert sorted(_kinds(notes, "refused")) == sorted(refused)
    assert sorted(_kinds(notes, "failed")) == sorted(failed)
    (skipped,) = [note for note in notes if note.kind == "left out"]
    assert (skipped.node, skipped.count) == ("fill", 2)
    assert "fill = hold, trial = 1" in skipped.reason
    again = [note.repeat for note in notes if note.kind == "failed"]
    step = "--only length=5 --only trial=0 --only fill=fails --until fill"
    assert f"{COMMAND} {step} --out runs/toy-fill" in again
    assert all("in fails" in note.trace for note in notes if note.kind == "failed")


def test_what_the_command_leaves_out_is_noted_once_with_its_reason(
    run_of: Callable[..., Run],
) -> None:
    both = "{recordings: {a: {from: fill, at: {length: 15}}, b: {from: gaps, at: {length: 15}}}}"
    more = "".join(f"      {name}: {{use: plot.stages, in: {both}}}\n" for name in ("one", "two"))
    run = run_of(TEXT.replace("    skip:", f"{more}    skip:"), only={"length": (5,)})
    (note,) = [note for note in _study(run).notes if "," in note.node]
    assert (note.node, note.count) == ("one, two", 2)
    assert note.reason == "the command has removed length=15"


def test_settings_show_every_value_and_whether_it_is_the_default(
    run_of: Callable[..., Run],
) -> None:
    study = _study(run_of(TEXT))
    gaps = next(method for method in study.methods if method.use == "gaps.cut")
    rows = {row.name: (row.value, row.unit, row.default) for row in gaps.settings}
    assert {row.name: row.meaning for row in gaps.settings}["length"] == "Length of each gap."
    assert gaps.plugin == "toys"
    assert rows == {"length": ("5, 15", "frames", False), "seed": ("0, 1", "", False)}
    hold = next(method for method in study.methods if method.use == "fill.hold")
    assert [(row.value, row.default) for row in hold.settings] == [("null", True)]
    assert hold.citation == "hold2001 (no BibTeX entry is installed)"
    assert study.seeds == (("gaps", "0, 1"),)


def test_every_computed_step_is_timed(run_of: Callable[..., Run]) -> None:
    study = _study(run_of(TEXT))
    timed = {row.node: row.steps for row in study.timings}
    assert timed == {"capture": 1, "gaps": 4, "fill": 2, "text": 2}


def test_a_word_of_a_command_is_quoted(run_of: Callable[..., Run]) -> None:
    text = """
        axes: {start: {two words: -1, one: 1}}
        nodes: {a: {use: read.number, with: {start: $start}}, b: {use: strict.fails, in: a}}
        """
    [note] = _study(run_of(text)).notes
    assert note.repeat == f"{COMMAND} --only 'start=two words' --until b --out runs/toy-b"


def test_a_value_that_cannot_be_shown_costs_no_other_result(toys: Registry) -> None:
    def explode(value: object, title: str) -> Rendered:
        raise RuntimeError("no ink")

    toys.hooks.__dict__["kinds"] = (Kind(float, explode),)
    text = "nodegraph: 1\nnodes: {a: {use: read.number}, b: {use: text.write}}"
    run = execute(plan(build(read_graph_text(text, "toy.yaml", Path()), toys)))
    with pytest.warns(UserWarning, match="a: cannot be shown: RuntimeError: no ink"):
        study = _study(run)
    shown = [(section.title, section.rendered.text) for section in study.sections]
    assert shown == [("A", "cannot be shown: RuntimeError: no ink"), ("B", "0")]
    (note,) = study.notes
    assert (note.node, note.kind, note.reason) == ("a", "failed", shown[0][1])
    assert "in explode" in note.trace
    assert run.ok
    assert not study.ok


class Ordered(NamedTuple):
    value: float
    note: str


class Swapped(NamedTuple):
    note: str
    value: float


def test_an_output_is_found_by_its_name_in_every_alternative() -> None:
    @node("pair.ordered")
    def ordered() -> Ordered:
        return Ordered(1.0, "one")

    @node("pair.swapped")
    def swapped() -> Swapped:
        return Swapped("two", 2.0)

    nodes = "nodes: {a: {alternatives: [pair.ordered, pair.swapped]}}"
    text = f"nodegraph: 1\n{nodes}\nreport: [a.value]"
    registry = Registry.of([ordered, swapped])
    run = execute(plan(build(read_graph_text(text, "toy.yaml", Path()), registry)))
    assert [value for _, value in run["a.value"]] == [1.0, 2.0]
    assert [value for _, value in run["a"]] == [1.0, "two"]
    assert [section.rendered.text for section in _study(run).sections] == ["1.0", "2.0"]


class Size(float):
    """A number whose renderer states an answer, and what it holds for."""


@hookimpl
def nodegraph_kinds() -> list[Kind]:
    return [Kind(Size, lambda size, title: Rendered("", answer=(f"It is {size:.0f}.", "Here.")))]


@pytest.mark.parametrize(
    ("value", "answer"),
    [
        ("3", ["It is 3.", "Here."]),
        ("$size", ["size 5: It is 5.", "size 5: Here.", "size 15: It is 15.", "size 15: Here."]),
    ],
)
def test_the_answer_says_which_combination_it_is_about(value: str, answer: list[str]) -> None:
    @node("read.size")
    def read(*, size: int) -> Size:
        return Size(size)

    text = (
        "nodegraph: 1\naxes: {size: [5, 15]}\n"
        f"nodes: {{a: {{use: read.size, with: {{size: {value}}}}}, "
        "b: {use: read.size, with: {size: $size}}}\nreport: [a]"
    )
    registry = Registry.of([read])
    registry.loaded.append(Plugin("sizes", sys.modules[__name__]))
    study = _study(execute(plan(build(read_graph_text(text, "toy.yaml", Path()), registry))))
    assert list(study.answer) == answer
    first = [section.first_answer for section in study.sections]
    assert first == [f"{sentence} Here." for sentence in answer[::2]]


def test_stored_steps_are_counted_as_such(run_of: Callable[..., Run], tmp_path: Path) -> None:
    text = "nodes: {a: {use: read.number}, b: {use: text.write, with: {number: 3}}}"
    run_of(text, store=tmp_path)
    study = _study(run_of(text, store=tmp_path))
    assert all(row.steps == row.stored == 1 for row in study.timings)
    shown = page(study)
    assert "all of them from stored results" in shown
    assert "a stored result counts with the time that it took to compute" in shown


def test_files_lie_in_a_folder_for_each_combination_whatever_the_report_lists() -> None:
    @node("read.one")
    def number_of(*, start: float) -> float:
        return start

    @node("write.number")
    def written(number: float, *, name: str = "one") -> Files:
        return Files({f"{name}.txt": str(number).encode(), "more/about.md": b"a number"})

    text = """
nodegraph: 1
axes: {start: [1.5, 2.5]}
nodes:
  one: {use: read.one, with: {start: $start}}
  out: {use: write.number, in: one}
report: [one]
"""
    spec = read_graph_text(text, "toy.yaml", Path())
    graph = build(spec, Registry.of([number_of, written]))
    files: dict[str, bytes] = {}

    def write(name: str, content: bytes) -> str:
        files[name] = content
        return ""

    study = compose(execute(plan(graph)), write=write).study
    assert files["out_start-1.5/one.txt"] == b"1.5"
    assert files["out_start-2.5/more/about.md"] == b"a number"
    last = study.sections[-1]
    assert (last.title, last.labels) == ("Out", "start=2.5")
    assert last.rendered.text == ("out_start-2.5/one.txt (3 B)\nout_start-2.5/more/about.md (8 B)")
    assert [link.text for link in last.files] == ["one.txt", "about.md"]
    assert 'out_start-1.5/one.txt">one.txt</a>' in page(study)
