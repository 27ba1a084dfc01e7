"""What a run prints at its end fits the terminal and marks the best methods."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from rich.cells import cell_len
from rich.console import Console

from nodegraph import Grid, Rendered, load, run
from nodegraph.cli.summary import print_summary
from nodegraph.execute.results import Run
from nodegraph.report.study import Link, NoteSubject, Section, StepNote, Study

GRAPH = """\
nodegraph: 1
nodes: {face: {use: synthesize.face, with: {seconds: 0.1, markers: 12}}}
report: [face.neutral]
"""
HEADS = [f"{ends}\nlength {length}" for ends in ("published", "met") for length in (5, 15, 45)]
GRID = Grid(
    "rmse [mm]",
    ("fill", *HEADS),
    (("linear", *["0.25"] * 6), ("ridge [b]", *["0.50"] * 6)),
    best=((0, 1), (1, 2)),
    tied=((1, 1),),
)


ANSWERS = [("curves", 9), ("table", 1), ("ranks", 4)]


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Run:
    path = tmp_path_factory.mktemp("summary") / "a.yaml"
    path.write_text(GRAPH)
    return run(load(path), cache=False)


def printed(study: Study, finished: Run, *, width: int = 80, full: bool = False) -> list[str]:
    stream = io.StringIO()
    console = Console(file=stream, width=width, color_system=None)
    print_summary(study, finished, Path("runs/a"), console, full=full)
    return stream.getvalue().splitlines()


@pytest.mark.parametrize(("width", "tables"), [(40, 4), (60, 2), (120, 1)])
def test_a_comparison_fits_the_width(finished: Run, width: int, tables: int) -> None:
    study = Study("A", sections=(Section("table", Rendered("", "long", grid=GRID)),))
    lines = printed(study, finished, width=width)
    assert max(map(len, lines)) <= width
    assert sum(line.startswith("ridge [b]") for line in lines) == tables
    assert "long" not in lines
    assert "long" in printed(study, finished, width=width, full=True)


@pytest.mark.parametrize("width", [30, 80])
def test_names_are_cut_and_never_numbers(finished: Run, width: int) -> None:
    numbers = ("0.3142", "1.23e-05", "12345.6789")
    names = ("x" * 200, "日本語" * 30, "short")
    rows = tuple((name, number) for name, number in zip(names, numbers, strict=True))
    grid = Grid("rmse", ("fill", "published " * 12), rows, best=((0, 1),))
    study = Study("A", sections=(Section("table", Rendered("", grid=grid)),))
    lines = printed(study, finished, width=width)
    assert max(map(cell_len, lines)) <= width
    for name, number in rows:
        (line,) = (line for line in lines if number in line)
        assert line.startswith(name[:4])


def test_the_best_and_what_is_tied_with_it_are_marked(finished: Run) -> None:
    study = Study("A", sections=(Section("table", Rendered("", grid=GRID)),))
    lines = printed(study, finished, width=120)
    linear, ridge = (next(line for line in lines if line.startswith(name)) for name in "lr")
    assert linear.split()[1:3] == ["0.25*", "0.25"]
    assert ridge.split()[2:4] == ["0.50~", "0.50*"]


def test_equal_warnings_and_failures_are_counted(finished: Run) -> None:
    notes = [
        StepNote(node, f"k={k}", reason, kind, repeat=f"again {k}")
        for node, reason, kind in [
            ("b", "two frames are missing", NoteSubject.WARNING),
            ("c", "no frame", NoteSubject.FAILED),
        ]
        for k in range(63)
    ]
    lines = printed(Study("A", notes=tuple(notes)), finished)
    assert [line for line in lines if line.startswith("warning")] == [
        "warning: b: two frames are missing (63 times)"
    ]
    failed = next(number for number, line in enumerate(lines) if line.startswith("failed"))
    assert lines[failed : failed + 2] == [
        "failed: c at k=0 and 62 more: no frame", "    repeat it alone: again 0",
    ]  # fmt: skip


def test_long_answers_and_texts_are_cut_unless_all_is_wanted(finished: Run) -> None:
    text = "\n".join(f"line {number}" for number in range(40))
    answer = tuple(f"Sentence {number}." for number in range(9))
    study = Study("A", answer=answer, sections=(Section("table", Rendered("", text)),))
    lines = printed(study, finished)
    assert "Sentence 5." in lines
    assert "Sentence 6." not in lines
    assert "line 11" in lines
    assert "line 12" not in lines
    assert sum("--full" in line for line in lines) == 2
    assert {"Sentence 8.", "line 39"} <= set(printed(study, finished, full=True))


def test_a_result_with_many_sentences_leaves_room_for_the_others(finished: Run) -> None:
    answers = [tuple(f"{name} {line}." for line in range(count)) for name, count in ANSWERS]
    sections = tuple(
        Section("s", Rendered("", answer=answer, lead="<p>at a glance</p>")) for answer in answers
    )
    lines = printed(Study("A", answer=sum(answers, ()), sections=sections), finished)
    expected = ["curves 0.", "curves 1.", "curves 2.", "table 0.", "ranks 0.", "ranks 1."]
    assert lines[: len(expected) + 1] == [*expected, "8 more sentences: --full, or the report"]


def test_what_two_results_say_stands_once(finished: Run) -> None:
    answers = [("a is best.", "Eight faces."), ("b is best.", "Eight faces.", "b: 1 mm.")]
    sections = tuple(
        Section("s", Rendered("", answer=answer, lead="<p>at a glance</p>")) for answer in answers
    )
    together = ("a is best.", "Eight faces.", "b is best.", "b: 1 mm.")
    lines = printed(Study("A", answer=together, sections=sections), finished)
    assert lines[:4] == list(together)
    assert not any("more sentence" in line for line in lines)


def test_files_are_counted_by_kind(finished: Run) -> None:
    links = (Link("CSV", "a.csv"), Link("two: CSV", "b.csv"), Link("x.c3d", "file/x.c3d"))
    study = Study("A", sections=(Section("table", Rendered(""), files=links),))
    assert printed(study, finished)[-1] == "runs/a/report.html, run.json, 2 CSV, 1 C3D"
