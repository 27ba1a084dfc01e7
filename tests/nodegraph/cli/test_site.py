"""``site`` says what changed between the runs of one study, and compares those of the same data."""

from __future__ import annotations

from dataclasses import replace
from html import unescape
from pathlib import Path

import pytest
from playwright.sync_api import Page

from nodegraph.plugin.hook_types import Grid, Rendered
from nodegraph.report.study import Section, read_study, study_bytes
from nodegraph.runs.folder import STUDY
from tests.browser import load
from tests.nodegraph.cli.conftest import Command


def test_what_changed_between_runs_is_said_as_in_diff(command: Command) -> None:
    for start in ("5", "5", "6"):
        graph = Path("toy.yaml").read_text().replace("start: 5", f"start: {start}")
        Path("toy.yaml").write_text(graph)
        place = f"runs/{len([*Path().glob('runs/*')])}"
        assert command("run", "toy.yaml", "--store", "kept", "--out", place)[0] == 0
    assert command("site", "runs", nodes=False)[0] == 0
    page = unescape(Path("site", "toy.html").read_text())
    assert page.count("Nothing: 9 combinations, all with the same results.") == 1
    assert "<li>input start was 5, now 6</li>" in page
    assert "<li>a: start was 5, now 6</li>" in page
    Path("runs", "1", "run.json").write_text("{}")
    assert command("site", "runs", nodes=False)[0] == 0
    assert Path("site", "toy.html").read_text().count("cannot be read") == 2


@pytest.mark.parametrize("stored", [("--store", "kept"), ("--no-cache",)])
def test_numbers_of_other_data_are_not_compared(
    command: Command, tab: Page, stored: tuple[str, ...]
) -> None:
    def shown() -> list[str]:
        after = "getComputedStyle(cell, '::after').content.replaceAll('\"', '').replace('none', '')"
        cells = tab.locator("[data-run]:is(th, td):visible")
        texts: list[str] = cells.evaluate_all(
            f"cells => cells.map((cell) => cell.textContent + {after})"
        )
        return texts

    for name, start, error in (("a", 5, "0.5"), ("b", 6, "0.4"), ("c", 6, "0.2"), ("d", 5, "0.6")):
        words = ["--set", f"start={start}", *stored, "--out", f"runs/{name}"]
        assert command("run", "toy.yaml", *words)[0] == 0
        grid = Grid("Error", ("fill", "all"), (("hold", error),))
        study = replace(
            read_study(Path("runs", name)),
            sections=(Section("Error", Rendered("", grid=grid), node="table"),),
            created=f"2026-11-20T10:0{'abcd'.index(name)}+00:00",
        )
        Path("runs", name, STUDY).write_bytes(study_bytes(study))
    assert command("site", "runs", nodes=False)[0] == 0
    load(tab, Path("site", "toy.html").absolute())
    heads = ["a", "b (other data)", "c", "d (other data)"]
    assert shown() == [*heads, "0.5", "0.4", "0.2 (\u221250 %)", "0.6"]
    assert "--set start=6" in tab.inner_text("li[data-run='b']")
    tab.get_by_label("Compare").select_option("a")
    assert shown() == ["a", "d", "0.5", "0.6 (+20 %)"]
