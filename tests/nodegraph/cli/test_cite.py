"""``cite`` prints what a paper needs, or writes it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.nodegraph.cli.conftest import Command
from tests.texts import edit


@pytest.fixture
def ran(command: Command) -> str:
    assert command("run", "toy.yaml")[0] == 0
    return "runs/toy"


def test_it_prints_paragraphs_a_table_and_the_sources(command: Command, ran: str) -> None:
    status, out, _ = command("cite", ran, nodes=False)
    assert status == 0
    assert out.startswith(
        "The study ran over `length` 2 (1, 5 frames). The steps were `toy.number`"
    )
    assert "| gaps | toy.cut | length | 1, 5 | frames |" in out


def test_it_writes_files_and_overwrites_none(command: Command, ran: str) -> None:
    status, out, _ = command("cite", ran, "--out", "paper", nodes=False)
    assert status == 0
    names = {path.name for path in Path("paper").iterdir()}
    assert names == {"methods.md", "methods.tex", "settings.md", "settings.tex", "references.bib"}
    assert out.count("\n") == len(names)
    status, _, err = command("cite", ran, "--out", "paper", nodes=False)
    assert (status, "already exists" in err) == (2, True)


def test_a_folder_without_a_run_is_named(command: Command) -> None:
    status, _, err = command("cite", "nowhere", nodes=False)
    assert (status, "there is no finished run" in err) == (2, True)


NEVER = """

@node("bad.boom", cite="boom1999")
def boom(x: float) -> float:
    raise ValueError("no good")

@node("bad.never", cite="never1999")
def never(x: float) -> float:
    raise Refusal("never")

from nodegraph import InputFile

@node("read.file")
def read_file(*, path: InputFile) -> float:
    return 5.0

from nodegraph import hookimpl

@hookimpl
def nodegraph_bibtex():
    return "".join(
        f"@article{{{key}, author={{A, B}}, title={{T}}, journal={{J}}, year={{1999}}}}"
        for key in ("boom1999", "never1999", "hold2001")
    )
"""


def with_methods_that_never_end() -> None:
    Path("toys.py").write_text(Path("toys.py").read_text() + NEVER)
    text = (
        Path("toy.yaml")
        .read_text()
        .replace(
            "alternatives: fill.*", "alternatives: [fill.hold, fill.strict, bad.boom, bad.never]"
        )
    )
    more = "  f: {use: bad.boom, in: gaps}\n  z: {use: toy.sum, in: {from: f}}\n"
    Path("toy.yaml").write_text(text + more)


def test_methods_that_gave_no_result_are_not_among_those_that_did(command: Command) -> None:
    with_methods_that_never_end()
    assert command("run", "toy.yaml")[0] == 1
    status, out, err = command("cite", "runs/toy", nodes=False)
    assert status == 0
    assert "Step `fill` compared 2 methods: `hold` [@hold2001], `strict`" in out
    for name in ("bad.boom", "bad.never", "boom1999", "never1999"):
        assert name not in out
    assert out.count("hold2001") > 1
    assert err.splitlines() == [
        "not cited, because it gave no result: fill=boom (bad.boom): 2 failed",
        "not cited, because it gave no result: fill=never (bad.never): 2 refused",
        "not cited, because it gave no result: f (bad.boom): 2 failed",
        "not cited, because it gave no result: z (toy.sum): 1 left out",
    ]
    report = Path("runs/toy/report.html").read_text()
    assert "fill=never (bad.never): 2 refused" in report
    assert "never1999" not in report


def test_results_that_were_stored_and_not_needed_count_as_such(command: Command) -> None:
    assert command("run", "toy.yaml")[0] == 0
    first = command("cite", "runs/toy", nodes=False)
    assert command("run", "toy.yaml")[0] == 0
    assert '"unneeded"' in Path("runs/toy/run.json").read_text()
    assert command("cite", "runs/toy", nodes=False) == first


def test_values_at_which_there_is_no_result_are_not_named(command: Command) -> None:
    Path("toys.py").write_text(
        Path("toys.py").read_text().replace("return Cut(x", "return Cut(1 / (length != 5) and x")
    )
    assert command("run", "toy.yaml")[0] == 1
    assert "`toy.cut` (`length` 1 frame)" in command("cite", "runs/toy", nodes=False)[1]


def test_a_run_without_results_cites_nothing(command: Command) -> None:
    with_methods_that_never_end()
    edit("toys.py", "return start", "return 1 / 0")
    assert command("run", "toy.yaml")[0] == 1
    assert command("cite", "runs/toy", nodes=False)[1].startswith("No step gave a result.\n")


def test_files_are_named_without_their_folders(command: Command, tmp_path: Path) -> None:
    with_methods_that_never_end()
    Path("far away").mkdir()
    Path("far away/take.txt").write_text("1")
    text = Path("toy.yaml").read_text().replace("{start: 5}", "{start: 5, file: toys.py}")
    Path("toy.yaml").write_text(f"{text}  r: {{use: read.file, with: {{path: $file}}}}\n")
    command("run", "toy.yaml", "--set", f"file={tmp_path}/far away/take.txt")
    assert command("cite", "runs/toy", "--out", "paper", nodes=False)[0] == 0
    for path in Path("paper").iterdir():
        assert str(tmp_path) not in path.read_text()
    assert "`read.file` (`path` take.txt)." in Path("paper/methods.md").read_text()
    assert "| r | read.file | path | take.txt |  |" in Path("paper/settings.md").read_text()
    assert f"{tmp_path}/far away/take.txt" in Path("runs/toy/report.html").read_text()


def test_a_file_where_the_folder_should_be_is_named(command: Command, ran: str) -> None:
    Path("paper").write_text("mine")
    for place in ("paper", "paper/deeper"):
        status, out, err = command("cite", ran, "--out", place, nodes=False)
        assert (status, out) == (2, "")
        assert "paper is a file" in err
    assert Path("paper").read_text() == "mine"
