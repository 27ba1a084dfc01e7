"""Results of several runs stand beside each other where there is room, else below each other."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Page

from nodegraph.plugin.hook_types import Rendered
from nodegraph.report.merge import merged
from nodegraph.report.page import page
from nodegraph.report.study import Section, Study
from tests.browser import load, resize

FIGURE = (
    '<figure class="figure"><svg width="700" height="300" viewBox="0 0 700 300"></svg></figure>'
)
TABLE = '<figure class="table"><table><tbody><tr><td>muscle</td></tr></tbody></table></figure>'
CORNERS = """
[...document.querySelectorAll(".result .section")].map((section) => {
  const box = section.getBoundingClientRect();
  return [section.querySelector("h3").textContent, Math.round(box.left), Math.round(box.top)];
})
"""


@pytest.mark.parametrize("html", [FIGURE, TABLE], ids=["figure", "table"])
def test_two_runs_stand_beside_each_other_on_a_desktop_and_below_on_a_phone(
    tab: Page, tmp_path: Path, html: str
) -> None:
    study = Study("A title", sections=(Section("result", Rendered(html)),))
    file = tmp_path / "both.html"
    file.write_text(page(merged({"one": study, "other": study})), encoding="utf-8")
    load(tab, file, width=1900)
    (value, left, top), (other, right, beside) = tab.evaluate(CORNERS)
    assert (value, other) == ("one", "other")
    assert top == beside
    assert left + 300 < right
    resize(tab, 390, 844)
    (_, left, top), (_, below, lower) = tab.evaluate(CORNERS)
    assert left == below
    assert top < lower
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390


def test_the_results_of_one_run_take_the_whole_width(tab: Page, tmp_path: Path) -> None:
    labelled = tuple(Section("result", Rendered(FIGURE), f"length {n}") for n in (5, 15))
    file = tmp_path / "one.html"
    file.write_text(page(Study("A title", sections=labelled)), encoding="utf-8")
    load(tab, file, width=1900)
    (_, left, top), (_, right, lower) = tab.evaluate(CORNERS)
    assert left == right
    assert top < lower


def test_ids_of_one_run_are_not_those_of_another() -> None:
    html = '<p id="chart"></p><p id="chart-2"></p><a href="#chart-2"></a>'
    study = Study("one", sections=(Section("all", Rendered(html)),))
    content = page(merged({"first": study, "second": study}))
    names = re.findall(r'<p id="(chart[^"]*)"', content)
    assert len(set(names)) == 4
    assert set(re.findall(r'href="#(chart[^"]*)"', content)) < set(names)


def test_unlike_studies_stand_in_tabs_without_a_script_and_keep_their_ids_apart(
    tab: Page, tmp_path: Path
) -> None:
    lead = '<p id="a-lead"><a href="#a-lead">x</a></p>'
    studies = {
        name: Study(title, sections=(Section("Result", Rendered(FIGURE, lead=lead)),))
        for name, title in (("one", "Which?"), ("two", "Which?"), ("other", "How many?"))
    }
    html = page(merged(studies))
    assert [
        html.count(text) for text in ('id="a-lead"', 'id="a-lead-run-2"', '"#a-lead-run-3"')
    ] == [1] * 3
    file = tmp_path / "tabs.html"
    file.write_text(html.partition("<script>")[0] + "</body></html>", encoding="utf-8")
    load(tab, file)
    seen = "[...document.querySelectorAll('.question')].map((one) => one.checkVisibility())"
    assert tab.evaluate("document.querySelector('h1').textContent") == "2 studies"
    assert tab.evaluate(f"{seen}") == [True, False]
    tab.evaluate("document.querySelectorAll('.tabs input')[1].click()")
    assert tab.evaluate(f"{seen}") == [False, True]
    assert tab.evaluate("document.querySelectorAll('.question .answer').length") == 3
