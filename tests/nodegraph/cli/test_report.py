"""``report`` makes a page again, and lays runs side by side."""

from __future__ import annotations

import gzip
import shutil
from pathlib import Path

import pytest

from tests.nodegraph.cli.conftest import Command


@pytest.fixture
def runs(command: Command) -> tuple[str, str]:
    """Two runs of the toy graph with another start."""
    for folder, start in (("runs/five", 5), ("runs/six", 6)):
        assert command("run", "toy.yaml", "--set", f"start={start}", "--out", folder)[0] in (0, 1)
    return "runs/five", "runs/six"


def test_the_report_of_a_run_is_made_again_the_same(
    command: Command, runs: tuple[str, str]
) -> None:
    page = Path(runs[0], "report.html")
    before = page.read_text()
    page.unlink()
    status, out, _ = command("report", runs[0], nodes=False)
    assert status == 0
    assert out.startswith("runs/five/report.html (")
    assert page.read_text() == before


def test_a_report_in_another_folder_links_the_files(
    command: Command, runs: tuple[str, str]
) -> None:
    assert command("report", runs[0], "--out", "pages/five.html", nodes=False)[0] == 0
    page = Path("pages/five.html").read_text()
    assert 'href="./../runs/five/run.json"' in page
    assert Path("pages/../runs/five/run.json").is_file()


def test_several_runs_lie_side_by_side(command: Command, runs: tuple[str, str]) -> None:
    status, _, _ = command("report", *runs, "--out", "both.html", nodes=False)
    assert status == 0
    page = Path("both.html").read_text()
    assert "<h3>five</h3>" in page
    assert "<h3>six</h3>" in page
    assert page.index("<h3>five</h3>") < page.index("<h3>six</h3>")
    assert 'href="./runs/six/run.json"' in page
    assert "start (five)" in page


def test_runs_of_one_name_are_named_by_their_paths(command: Command, runs: tuple[str, str]) -> None:
    shutil.copytree(runs[0], Path("other", "five"))
    status, _, _ = command("report", runs[0], "other/five", "--out", "both.html", nodes=False)
    assert status == 0
    page = Path("both.html").read_text()
    assert "<h3>runs/five</h3>" in page
    assert "<h3>other/five</h3>" in page


def test_several_runs_need_a_place_and_overwrite_nothing(
    command: Command, runs: tuple[str, str]
) -> None:
    status, _, err = command("report", *runs, nodes=False)
    assert (status, "--out FILE" in err) == (2, True)
    Path("there.html").write_text("mine")
    status, _, err = command("report", *runs, "--out", "there.html", nodes=False)
    assert (status, "already exists" in err) == (2, True)
    assert Path("there.html").read_text() == "mine"


@pytest.mark.parametrize(
    "content",
    [b"", b"no gzip", gzip.compress(b"{}", mtime=0), gzip.compress(b"[", mtime=0)],
    ids=["empty", "no gzip", "nothing in it", "cut off"],
)
def test_a_study_that_is_damaged_is_named(
    command: Command, runs: tuple[str, str], content: bytes
) -> None:
    Path(runs[0], "study.json.gz").write_bytes(content)
    status, _, err = command("report", runs[0], nodes=False)
    assert status == 2
    assert "runs/five/study.json.gz cannot be read" in err


def test_a_folder_without_a_run_is_named(command: Command) -> None:
    status, _, err = command("report", "nowhere", nodes=False)
    assert status == 2
    assert "nowhere: there is no finished run" in err
