"""The modules of a page: their exports reach those that need them; the selection is shared."""

from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph import Rendered, json_script
from nodegraph.report import Section, Study, page
from tests.browser import BROWSER, open_tab

pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")

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


def report(tmp_path: Path) -> Path:
    rendered = Rendered(json_script({"value": 21}, "numbers"), scripts=(READER, DOUBLE, LOST))
    path = tmp_path / "report.html"
    path.write_text(page(Study("A study", sections=(Section("table", rendered),))), "utf-8")
    return path


def test_a_module_gets_what_it_needs_and_another_fails_alone(tmp_path: Path) -> None:
    with open_tab(tmp_path / "profile") as tab:
        tab.show(report(tmp_path))
        assert tab.value("[window.read.value, window.read.server]") == [42, None]
        assert [text for text in tab.console if "lost" in text and "nowhere" in text]


def test_the_selection_reaches_its_readers_and_the_address(tmp_path: Path) -> None:
    with open_tab(tmp_path / "profile") as tab:
        tab.show(report(tmp_path))
        tab.value("window.selection.set({method: 'ridge', block: 3})")
        tab.value("window.selection.toggle('method', 'ridge')")
        assert tab.value("window.read.chosen") == [
            ["ridge", ["method", "block"]],
            [None, ["method"]],
        ]
        assert tab.value("location.hash") == "#select:block=3"
        tab.value("window.selection.clear()")
        assert tab.value("[window.selection.state.block, window.selection.state.suspects]") == [
            None,
            True,
        ]
