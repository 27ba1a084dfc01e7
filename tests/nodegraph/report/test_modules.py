"""The modules of a page: their exports reach those that need them; the selection is shared."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import Page

from nodegraph import Rendered, json_script
from nodegraph.report.page import page
from nodegraph.report.study import Section, Study
from tests.browser import load, until

READER = """
nodegraph.define("reader", ["page", "double", "selection", "server"],
  (page, double, selection, server) => {
    window.read = { value: double(page.data("numbers").value), server, chosen: [] };
    selection.on((state, changed) => window.read.chosen.push([state.method, [...changed]]));
    window.selection = selection;
  });
"""
DOUBLE = 'nodegraph.define("double", [], () => (value) => 2 * value);'
LOST = 'nodegraph.define("lost", ["nowhere"], () => { window.read = null; });'


def report(tmp_path: Path, *more: str) -> Path:
    rendered = Rendered(json_script({"value": 21}, "numbers"), scripts=(READER, DOUBLE, *more))
    path = tmp_path / "report.html"
    path.write_text(page(Study("A study", sections=(Section("table", rendered),))), "utf-8")
    return path


def test_a_module_gets_what_it_needs_and_another_fails_alone(
    tab: Page, tmp_path: Path, complaints: list[str]
) -> None:
    load(tab, report(tmp_path, LOST))
    assert tab.evaluate("[window.read.value, window.read.server]") == [42, None]
    (text,) = complaints
    assert "lost" in text
    assert "nowhere" in text
    complaints.clear()


def test_the_selection_reaches_its_readers_and_the_address(tab: Page, tmp_path: Path) -> None:
    load(tab, report(tmp_path))
    tab.evaluate("window.selection.set({method: 'ridge', block: 3})")
    tab.evaluate("window.selection.toggle('method', 'ridge')")
    assert tab.evaluate("window.read.chosen") == [
        ["ridge", ["method", "block"]],
        [None, ["method"]],
    ]
    assert tab.evaluate("location.hash") == "#select:block=3"
    tab.evaluate("window.selection.clear()")
    assert tab.evaluate("[window.selection.state.block, window.selection.state.suspects]") == [
        None,
        True,
    ]


def test_a_link_to_a_place_of_the_page_keeps_what_is_selected(tab: Page, tmp_path: Path) -> None:
    path = report(tmp_path)
    load(tab, path)
    tab.evaluate("window.selection.set({method: 'ridge', '2.group': 3})")
    tab.evaluate("document.querySelector('.contents a[href=\"#methods\"]').click()")
    until(tab, "location.hash.includes('at=')")
    address = tab.evaluate("location.hash")
    assert address == "#select:method=ridge&2.group=3&at=methods"
    tab.goto("about:blank")
    tab.goto(f"{path.as_uri()}{address}")
    state = tab.evaluate("window.selection.state")
    assert (state["method"], state["2.group"]) == ("ridge", 3)
    assert tab.evaluate("document.querySelector('#methods').open")
    tab.evaluate("window.selection.clear()")
    assert tab.evaluate("location.hash") == "#methods"
