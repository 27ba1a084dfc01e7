"""The page in a browser: nothing complains, and what should happen happens."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page

from nodegraph.draw import Arrow, Box, Picture, Socket, svg
from nodegraph.draw.picture import folded
from nodegraph.plugin.hook_types import Rendered
from nodegraph.report.page import page
from nodegraph.report.study import NoteSubject, Section, StepNote, Study, TimingRow
from tests.browser import load, needs_axe, until, violations

TABLE = (
    '<figure class="table"><table class="sortable"><caption>Errors</caption><thead><tr>'
    '<th scope="col">method</th><th scope="col" class="number" data-column="1">rmse [mm]</th>'
    "</tr></thead><tbody>"
    '<tr><td>muscle</td><td class="number">10</td></tr>'
    '<tr><td>refused</td><td class="number"></td></tr>'
    '<tr><td>lin</td><td class="number">9.5 \u00b1 0.2</td></tr>'
    '<tr><td>guenter</td><td class="number">\u22121e-3</td></tr>'
    "</tbody></table></figure>"
)
CSV = (
    '<template class="csv">method,rmse [mm]\nmuscle,10.123456\nrefused,\n'
    "lin,9.5 \u00b1 0.2\nguenter,\u22121e-3\n</template></figure>"
)
HEAD = "table.sortable thead button >> nth={}"


def show(tab: Page, folder: Path, *results: Rendered, **more: Any) -> None:
    """Load the page of a study with these results."""
    sections = tuple(Section(f"table {at}", rendered) for at, rendered in enumerate(results))
    file = folder / "report.html"
    file.write_text(page(Study("A title", sections=sections, **more)), encoding="utf-8")
    load(tab, file)


def test_the_console_stays_empty(tab: Page, tmp_path: Path) -> None:
    show(
        tab,
        tmp_path,
        Rendered(TABLE),
        notes_markdown="*why*",
        graph_svg=svg(Picture("drawn", (Box("capture"),))),
        notes=(StepNote("fill", "trial=0", "needs a neutral pose", NoteSubject.REFUSED),),
        timings=(TimingRow("fill", 1, 1.0),),
    )
    assert "needs a neutral pose" in tab.content()


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_boxes_of_the_graph_are_as_bright_as_the_page(
    tab: Page, tmp_path: Path, theme: str
) -> None:
    show(tab, tmp_path, graph_svg=svg(Picture("drawn", (Box("capture"),))))
    face, paper = tab.evaluate(
        "(theme) => { document.documentElement.dataset.theme = theme;"
        " return [getComputedStyle(document.querySelector('.box .frame')).fill,"
        " getComputedStyle(document.body).backgroundColor]; }",
        theme,
    )
    assert face == paper


@needs_axe
def test_a_click_follows_the_path_of_a_node_and_unfolds(tab: Page, tmp_path: Path) -> None:
    ports = (Socket("output"),)
    names = ("capture", "fill", "fill.fine", "other")
    boxes = tuple(Box(name, inputs=(Socket("recording"),), outputs=ports) for name in names)
    reports = tuple(
        Box(name, inputs=(Socket("recording"),), kind="report") for name in ("table", "plot")
    )
    links = (
        ("capture", "fill"), ("fill", "fill.fine"), ("fill.fine", "table"), ("other", "plot"),
    )  # fmt: skip
    arrows = tuple(Arrow(source, "output", target, "recording") for source, target in links)
    picture = Picture("drawn", (*boxes, *reports), arrows)
    chart = '<svg viewBox="0 0 9 9" width="9" height="9"><rect width="9" height="9"/></svg>'
    sections = (
        Section("Errors", Rendered("<p>none</p>"), node="table"),
        Section("Errors", Rendered(chart), node="table"),
    )
    file = tmp_path / "report.html"
    study = Study("A title", sections=sections, graph_svg=svg(folded(picture)))
    study = replace(study, graph_unfolded_svg=svg(picture))
    file.write_text(page(study), encoding="utf-8")
    load(tab, file)
    tab.click("#graph > summary")

    def on_path() -> set[str]:
        every = "[...document.querySelectorAll('#graph .on-path[data-box]')]"
        return set(tab.evaluate(f"{every}.map((box) => box.dataset.box)"))

    tab.click("[data-box='fill'] .name")
    assert on_path() == {"capture", "fill", "fill.fine", "report"}
    followed = tab.locator(".followed-node")
    assert "Depends on: capture" in followed.inner_text()
    assert "Needed by: fill.fine, report" in followed.inner_text()
    assert tab.locator(".arrow.on-path").count() == 3
    assert violations(tab, "#graph") == []
    tab.focus("[data-box='report']")
    tab.keyboard.press("Enter")
    assert "table" in followed.inner_text()
    assert on_path() == {"capture", "fill", "fill.fine", "table"}
    tab.focus("[data-box='table']")
    tab.keyboard.press("Enter")
    assert followed.locator(".thumbnail").all_inner_texts() == ["Errors"]
    assert followed.locator(".thumbnail svg rect").count() == 1
    tab.keyboard.press("Escape")
    assert (on_path(), followed.inner_text()) == (set(), "")
    tab.get_by_text("Fold what is only shown").click()
    assert tab.locator("[data-box='report']").count() == 1
    assert tab.locator("[data-box='table']").count() == 0


@pytest.mark.parametrize(
    ("clicks", "order", "state"),
    [
        ([1], ["guenter", "lin", "muscle", "refused"], "ascending"),
        ([1, 1], ["muscle", "lin", "guenter", "refused"], "descending"),
        ([1, 0], ["guenter", "lin", "muscle", "refused"], "ascending"),
        ([0, 0], ["refused", "muscle", "lin", "guenter"], "descending"),
    ],
)
def test_tables_sort_by_their_heads(
    tab: Page, tmp_path: Path, clicks: list[int], order: list[str], state: str
) -> None:
    show(tab, tmp_path, Rendered(TABLE))
    for column in clicks:
        tab.click(HEAD.format(column))
    assert tab.locator("tbody td:first-child").all_text_contents() == order
    heads = tab.locator("table.sortable th")
    assert heads.nth(clicks[-1]).get_attribute("aria-sort") == state
    assert heads.nth(1 - clicks[-1]).get_attribute("aria-sort") is None


COPIES = (
    (
        "CSV",
        "method,rmse [mm]\nguenter,\u22121e-3\nlin,9.5 \u00b1 0.2\nmuscle,10.123456\nrefused,\n",
    ),
    (
        "Markdown",
        "| method | rmse [mm] |\n|---|---:|\n| guenter | \u22121e-3 |\n"
        "| lin | 9.5 \u00b1 0.2 |\n| muscle | 10 |\n| refused |  |\n",
    ),
    (
        "LaTeX",
        "% needs \\usepackage{booktabs}\n\\begin{table}\n\\caption{Errors}\n"
        "\\begin{tabular}{lr}\n\\toprule\nmethod & rmse {[}mm] \\\\\n\\midrule\n"
        "guenter & \u22121e-3 \\\\\n",
    ),
)


def test_a_table_is_copied_as_it_is_shown(tab: Page, tmp_path: Path) -> None:
    show(tab, tmp_path, Rendered(TABLE.replace("</figure>", CSV)))
    tab.click(HEAD.format(1))
    tab.context.grant_permissions(["clipboard-read", "clipboard-write"])
    for form, text in COPIES:
        tab.click(f".copy [aria-label$={form}]")
        assert tab.evaluate("navigator.clipboard.readText()").startswith(text)
        assert f"{form} copied" in tab.content()


def test_a_table_laid_out_anew_sorts_by_what_it_shows_and_is_copied_as_its_file(
    tab: Page, tmp_path: Path
) -> None:
    whole = "length,method,mean\n5,muscle,1.25\n45,muscle,10.5\n"
    source = f'<template class="csv whole">{whole}</template></figure>'
    show(tab, tmp_path, Rendered(TABLE.replace("</figure>", source)))
    tab.click(HEAD.format(1))
    methods = tab.locator("tbody td:first-child").all_text_contents()
    assert methods == ["guenter", "lin", "muscle", "refused"]
    tab.context.grant_permissions(["clipboard-read", "clipboard-write"])
    tab.click(".copy [aria-label$=CSV]")
    assert tab.evaluate("navigator.clipboard.readText()") == whole


def test_rows_follow_the_selection_and_the_theme_is_chosen(tab: Page, tmp_path: Path) -> None:
    linked = re.sub(r"<tr><td>(\w+)</td>", r'<tr data-method="\1"><th class="name">\1</th>', TABLE)
    show(tab, tmp_path, Rendered(linked))
    tab.click(".pick >> nth=1")
    tab.hover("tr[data-method=muscle] .pick")
    rows = tab.locator("tbody tr")
    assert [rows.nth(at).get_attribute("class") or "" for at in range(4)] == [
        "hovered", "selected", "", "",
    ]  # fmt: skip
    assert tab.get_attribute(".pick >> nth=1", "aria-pressed") == "true"
    assert tab.locator(".pick[tabindex='0']").count() == 1
    tab.click("#theme")
    assert tab.get_attribute("html", "data-theme") == "dark"
    assert tab.text_content("#theme") == "Light"


def test_a_script_that_results_bring_runs_once(tab: Page, tmp_path: Path) -> None:
    count = "document.title = `${document.querySelectorAll('.bait').length} ${document.title}`;"
    rendered = Rendered("<p class=bait>x</p>", scripts=(count,), styles=(".bait { color: red; }",))
    show(tab, tmp_path, rendered, rendered)
    assert tab.title() == "2 A title"


def test_a_handler_in_markup_does_not_run(tab: Page, tmp_path: Path, complaints: list[str]) -> None:
    show(tab, tmp_path, Rendered("<p id=bait onclick=\"document.title = 'ran'\">x</p>"))
    tab.click("#bait")
    assert tab.title() == "A title"
    assert "Content Security Policy" in complaints[0]
    complaints.clear()


def test_the_network_is_out_of_reach(tab: Page, tmp_path: Path, complaints: list[str]) -> None:
    call = 'fetch("https://example.invalid/").catch(() => { document.title = "refused"; });'
    show(tab, tmp_path, Rendered("", scripts=(call,)))
    until(tab, "document.title === 'refused'")
    assert any("Content Security Policy" in text for text in complaints)
    assert not any(text.startswith("GET") for text in complaints)
    complaints.clear()
