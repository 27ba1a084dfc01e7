"""The gallery of runs, and the guides with the reference, are whole and lead nowhere else."""

from __future__ import annotations

import re
import subprocess
import sys
import textwrap
from contextlib import redirect_stderr
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from io import StringIO
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import unquote

import pytest
from playwright.sync_api import Page

import nodegraph as ng
from nodegraph.cli.main import COMMANDS, main
from nodegraph.graphfile.keys import TOP_LEVEL
from nodegraph.node.description import describe_settings
from nodegraph.plugin.hook_types import Grid, Rendered, expect
from nodegraph.plugin.hooks import HOOKS, Shape
from nodegraph.plugin.registry import Registry
from nodegraph.report.study import (
    Link,
    MethodRow,
    NoteSubject,
    Section,
    StepNote,
    Study,
    study_bytes,
)
from nodegraph.runs.folder import EVENTS, REPORT, STUDY
from tests import readmes
from tests.browser import AXE, load, resize, until, violations

PAGES = Path(readmes.ROOT) / "nodegraph" / "site" / "pages"
HOSTILE = '</title><script>alert(1)</script><img src="https://example.org/x.png">'


class Lips(NamedTuple):
    width: float = 0.0


class Links(HTMLParser):
    """The addresses of a page, and the number of its scripts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.addresses: list[str] = []
        self.scripts = 0
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("href", "src"):
                self.addresses.append(value or "")
        self.scripts += tag == "script"


def write_run(folder: Path, study: Study) -> None:
    folder.mkdir(parents=True)
    (folder / STUDY).write_bytes(study_bytes(study))
    (folder / REPORT).write_text("<!DOCTYPE html><title>A report</title>")


def scores(*rows: tuple[str, ...]) -> Section:
    grid = Grid("Error [mm]", ("fill", "short", "long\nof lips"), rows)
    return Section("Error", Rendered("", grid=grid), node="table")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    failed = StepNote("repair", "repair=median", "no samples", NoteSubject.FAILED)
    linear, spline = (MethodRow("fill", f"fill.{name}") for name in ("linear", "spline"))
    runs = {
        "runs/fill": Study(
            "Fills",
            answer=("It is linear.", "Splines overshoot."),
            methods=(linear, spline),
            sections=(scores(("linear", "0.55", "1.2"), ("spline", "0.6", "1.4")),),
            graph_file="fill.yaml",
            created="2026-11-20T10:00+01:00",
        ),
        "runs/fill-2026-11-20T09-00-00": Study(
            "Fills",
            sections=(scores(("linear", "0.4", "1.2")),),
            graph_file="fill.yaml",
            created="2026-11-20T09:00+01:00",
        ),
        "runs/fill-2026-11-20T08-00-00": Study(
            "Fills",
            sections=(scores(("linear", "0.5", "1.2"), ("spline", "0.6", "1.3")),),
            graph_file="fill.yaml",
            created="2026-11-20T08:00+01:00",
        ),
        "runs/repair": Study("Repairs", notes=(failed,), created="2026-11-22T09:00+00:00"),
        "runs/align": Study("Aligns", methods=(linear,), created="2026-11-21T09:00+00:00"),
        "more/fill": Study(HOSTILE, answer=(HOSTILE,), created="last week"),
    }
    for name, study in runs.items():
        write_run(folder / name, study)
    (folder / "runs" / "going").mkdir()
    (folder / "runs" / "going" / EVENTS).touch()
    words = ["site", str(folder / "runs"), str(folder / "more" / "fill")]
    with redirect_stderr(StringIO()) as said:
        assert main([*words, "--out", str(folder / "out")]) == 0
    assert "runs: 1 run without a report left out: going" in said.getvalue()
    return folder / "out"


def test_every_link_leads_to_a_file(site: Path) -> None:
    pages = [Links((site / name).read_text()).addresses for name in ("index.html", "fill.html")]
    assert [len({*addresses} - {"data:,"}) for addresses in pages] == [7, 4]
    for address in {*chain(*pages)} - {"data:,"}:
        assert (site / unquote(address)).is_file()


@pytest.mark.parametrize("page", ["index.html", "fill.html"])
def test_the_page_cannot_reach_the_network(site: Path, page: str) -> None:
    text = (site / page).read_text()
    assert "default-src 'none'" in unescape(text.partition("<title>")[0])
    assert not re.search(r'(src|href)="(?!data:,")[a-z]+:', text)


@pytest.fixture(scope="module")
def guides(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the guides and the reference, as mkdocs builds them; a broken link is an error."""
    out = tmp_path_factory.mktemp("guides")
    configuration = str(PAGES.parent / "mkdocs.yml")
    words = ["-m", "mkdocs", "build", "--strict", "--quiet", "-f", configuration, "-d", str(out)]
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return out


def test_every_node_command_hook_and_key_appears(guides: Path) -> None:
    texts = {path.stem: unescape(path.read_text()) for path in guides.glob("reference/*.html")}
    for entry in Registry.installed():
        page = texts[entry.node.family]
        assert f'id="{entry.node.name.replace(".", "-")}"' in page
        assert all(f"<td>{name}</td>" in page for name in entry.node.settings)
        assert all(text.meaning in page for text in describe_settings(entry.node))
    assert all(f">nodegraph {name}</h2>" in texts["commands"] for name in COMMANDS)
    assert all(f"nodegraph_{name}</code></h2>" in texts["hooks"] for name in HOOKS)
    assert all(f"<td><code>{name}</code></td>" in texts["keys"] for name in TOP_LEVEL)


@pytest.mark.parametrize("name", HOOKS)
def test_the_example_of_a_hook_gives_what_the_hook_returns(name: str, tmp_path: Path) -> None:
    hook = HOOKS[name]
    names = dict.fromkeys(re.findall(r"\b[a-z]+(?:_[a-z]+)+\b", hook.example), callable)
    space = {**names, **{each: getattr(ng, each) for each in ng.__all__}}
    space |= {"Path": Path, "Lips": Lips, "__file__": str(tmp_path / "plugin.py")}
    exec(f"def example():\n{textwrap.indent(hook.example, '    ')}", space)
    if name == "nodes":
        return  # it imports a package
    value: Any = space["example"]()
    expect(value, hook.shape.value)
    items = value.values() if hook.shape is Shape.NAMED else [value]
    for item in value if hook.shape is Shape.LIST else items:
        expect(item, hook.item)


def test_every_run_has_its_answer_and_report(site: Path) -> None:
    assert "It is linear." in unescape((site / "index.html").read_text())
    assert (site / "fill" / REPORT).is_file()
    assert (site / "fill-2" / REPORT).is_file()


def test_a_hostile_title_is_text(site: Path) -> None:
    text = (site / "index.html").read_text()
    assert "alert(1)" in text
    assert "<script>alert" not in text
    assert '<img src="https' not in text


@pytest.mark.parametrize("lost", [STUDY, REPORT])
def test_a_damaged_run_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], lost: str
) -> None:
    write_run(tmp_path / "a", Study("A"))
    (tmp_path / "a" / lost).unlink()
    assert main(["site", str(tmp_path / "a"), "--out", str(tmp_path / "out")]) == 2
    assert str(tmp_path / "a") in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("row", [(), ("linear", "0.5"), ("linear", "0.5", "1", "2")])
def test_a_damaged_table_of_a_study_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], row: tuple[str, ...]
) -> None:
    for name in ("a", "b"):
        write_run(tmp_path / name, Study("Fills", sections=(scores(row),)))
    assert main(["site", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    assert "Fills: a row of the table 'Error' is not as long" in capsys.readouterr().err


def test_a_folder_that_is_no_site_is_not_written_to(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_run(tmp_path / "run", Study("A"))
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.txt").write_text("of the user")
    assert main(["site", str(tmp_path / "run"), "--out", str(tmp_path / "out")]) == 2
    assert str(tmp_path / "out") in capsys.readouterr().err
    assert len(list((tmp_path / "out").iterdir())) == 1


def test_the_tutorial_works_as_it_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text = (PAGES / "tutorial.md").read_text()
    for graph in readmes.blocks(text, "yaml"):
        (tmp_path / graph.partition("\n")[0].removeprefix("# ")).write_text(graph)
    for words in readmes.commands(text):
        if readmes.is_ours(words):
            readmes.run_command(words)
        else:
            subprocess.run(words, check=True)
    assert (tmp_path / "runs" / "clean" / "file" / "filled.c3d").stat().st_size > 10_000


def test_the_gallery_filters_and_sorts_with_keys_and_keeps_that_in_its_address(
    site: Path, tab: Page
) -> None:
    def shown() -> list[str]:
        return tab.locator("h2:visible").all_inner_texts()

    def press(*keys: str) -> None:
        for key in keys:
            tab.keyboard.press(key)

    load(tab, site / "index.html", width=390)
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390
    assert tab.inner_text("#count") == "3 of 6 runs; not shown: 1 failed, 2 replaced"
    assert shown() == ["Aligns", "Fills", HOSTILE]
    press("Tab", "Tab", *"overshoot")  # past the button of the theme
    assert shown() == ["Fills"]
    assert tab.locator("details:visible").first.get_attribute("open") is not None
    press(*["Backspace"] * len("overshoot"), "Tab", *"fill.l")
    assert shown() == ["Aligns", "Fills"]
    tab.get_by_label("Method").select_option("any")
    tab.get_by_label("From").fill("2026-11-21")
    tab.get_by_label("Show failed").press("Space")
    tab.get_by_label("Show replaced").press("Space")
    assert shown() == ["Repairs", "Aligns"]
    assert "1 failed" in tab.locator("article:visible").first.inner_text()
    tab.get_by_label("From").fill("")
    tab.get_by_label("To").fill("2026-11-21")
    tab.get_by_label("Sort by").select_option("date, earliest first")
    sorted_runs = ["Fills", "Fills", "Fills", "Aligns"]
    assert shown() == sorted_runs
    assert "replaced by fill" in tab.locator("article:visible").first.inner_text()
    address = tab.url
    tab.goto("about:blank")
    tab.emulate_media(color_scheme="dark")
    tab.goto(address)
    assert shown() == sorted_runs
    if AXE:
        assert violations(tab) == []
    tab.get_by_role("button", name="Clear").press("Enter")
    tab.emulate_media(color_scheme="light")
    assert tab.inner_text("#count") == "3 of 6 runs; not shown: 1 failed, 2 replaced"
    assert "#" not in tab.url
    if AXE:
        assert violations(tab) == []
    tab.goto(f"{address}&method=fill.none&more=%E0")  # somebody has changed it
    assert shown() == sorted_runs


@pytest.mark.parametrize("size", [(1600, 200), (500, 1500)])
def test_a_figure_is_shown_whole_beside_the_words_and_options(
    tmp_path: Path, tab: Page, size: tuple[int, int]
) -> None:
    link = Link("figure", "table_figure.svg")
    study = Study(
        "Fills",
        answer=("It is linear.",),
        sections=(replace(scores(), files=(link,)),),
        command="nodegraph run fill.yaml --axis 'recording=my take.c3d'",
    )
    write_run(tmp_path / "run", study)
    across, down = size
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" width="{across}" height="{down}"/>'
    (tmp_path / "run" / link.path).write_text(svg)
    assert main(["site", str(tmp_path / "run"), "--out", str(tmp_path / "out")]) == 0
    load(tab, tmp_path / "out" / "index.html", width=390)
    for width in (390, 1200):
        resize(tab, width)
        assert "--axis 'recording=my take.c3d'" in tab.inner_text(".front")
        tab.locator(".picture img").scroll_into_view_if_needed()
        until(tab, "document.querySelector('.picture img').complete")
        card, picture, words = (
            tab.locator(each).bounding_box() for each in ("article", ".picture img", ".front")
        )
        assert card
        assert picture
        assert words
        assert picture["width"] / picture["height"] == pytest.approx(across / down, rel=0.02)
        assert picture["x"] >= card["x"]
        assert picture["x"] + picture["width"] <= card["x"] + card["width"]
        assert picture["y"] + picture["height"] <= card["y"] + card["height"]
        if width > 1000:
            assert picture["x"] >= words["x"] + words["width"]
        if AXE:
            assert violations(tab) == []


def test_runs_of_a_study_are_compared_all_or_two_of_them(site: Path, tab: Page) -> None:
    def rows() -> list[str]:
        by = "getComputedStyle(cell, '::after').content.replaceAll('\"', '')"
        cells = f"cells => cells.map((cell) => cell.textContent + {by}.replace('none', ''))"
        rows = tab.locator("tbody tr").all()
        return [" | ".join(row.locator(":visible").evaluate_all(cells)) for row in rows]

    load(tab, site / "index.html")
    tab.get_by_role("link", name="All runs").first.click()
    titles = tab.locator("section.result h2").all_inner_texts()
    assert titles == ["Error, short", "Error, long, of lips"]
    assert rows() == [
        "linear | 0.5 | 0.4 (\u221220 %) | 0.55 (+38 %)",
        "spline | 0.6 | \u2013 | 0.6",
        "linear | 1.2 | 1.2 | 1.2",
        "spline | 1.3 | \u2013 | 1.4 (+8 %)",
    ]
    if AXE:
        assert violations(tab) == []
    tab.get_by_label("Compare").select_option("fill-2026-11-20T08-00-00")
    address = tab.url
    tab.goto("about:blank")
    tab.emulate_media(color_scheme="dark")
    resize(tab, 390)
    tab.goto(address)
    assert rows() == [
        "linear | 0.5 | 0.55 (+10 %)",
        "spline | 0.6 | 0.6",
        "linear | 1.2 | 1.2",
        "spline | 1.3 | 1.4 (+8 %)",
    ]
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390
    if AXE:
        assert violations(tab) == []
