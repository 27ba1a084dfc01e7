"""Reports of shipped graphs in a browser: what they show is what the files beside them hold."""

from __future__ import annotations

import base64
import csv
import html
import io
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page

from nodegraph.graphfile.yaml_text import read_yaml
from tests.browser import AXE, assert_all_can_read_it, drag, load, resize, until
from tests.plugins.nodegraph_mocap.player.unpacked import Read
from tests.studies import GRAPHS, Studies

LABELS = {"component", "length", "ghosts", "dropout"}
CLIPBOARD = """
Object.defineProperty(navigator, 'clipboard', {
  configurable: true, value: { writeText: async (text) => { window.copied = text; } } })
"""
PLAYER = "document.querySelector('figure.playback').playback"
DESKTOP, PHONE, SMALLEST = (1280, 800), 390, 320
PAPER = 673
"""What is left of the width of A4 between the margins."""
MOST_PAGES = 6
# what WCAG 2.2 (1.4.12) asks of a page: readers may set letters wider, and fonts differ; what is
# too wide with letters as they are is too wide then as well
WIDER = """
{
  const style = document.createElement("style");
  style.textContent = "* { letter-spacing: 0.12em !important; word-spacing: 0.16em !important; }";
  document.head.append(style);
}
"""

# tables in print of which rows are left out, without a word or with a wrong number
AXES_OF_CARDS = """
[...document.querySelectorAll(".lead-cards")].slice(0, 1).flatMap((cards) =>
  [...cards.querySelectorAll("tr[aria-hidden] svg")].map((svg) => svg.clientWidth))
"""
LEFT_OUT = """
[...document.querySelectorAll("figure.table")].filter((figure) => {
  if (!figure.checkVisibility()) return false;
  const hidden = [...figure.querySelectorAll("tr")].filter((row) => !row.checkVisibility());
  const said = getComputedStyle(figure, "::after").content.includes("more rows are in the CSV");
  return said ? figure.dataset.more !== String(hidden.length) : hidden.length > 0;
}).length
"""
TABLES = """
[...document.querySelectorAll(".result .rendered > figure.table table")].map((table) => {
  const beside = table.closest(".rendered")?.previousElementSibling;
  const link = beside?.querySelector('a[href$=".csv"]');
  return {
    file: link ? decodeURIComponent(link.getAttribute("href").slice(2)) : null,
    laid_out: Boolean(table.closest("figure").querySelector("template.whole")),
    heads: [...table.tHead.rows[0].cells]
      .map((cell) => cell.textContent.replace(/ \\[[^\\]]*\\]$/, "")),
    columns: [...table.tHead.rows[0].cells].map((cell) => Number(cell.dataset.column)),
    percent: [...table.tHead.rows[0].cells]
      .map((cell) => cell.querySelector(".unit")?.textContent.trim() === "[%]"),
    rows: [...table.tBodies[0].rows].map((row) => [...row.cells].map((cell) => cell.textContent)),
  };
})
"""
FIGURES = """
[...document.querySelectorAll(".result figure.figure > svg")].map((one) => ({
  file: decodeURIComponent(one.closest(".rendered").nextElementSibling
    .querySelector('a[href$=".svg"]').getAttribute("href").slice(2)),
  label: one.getAttribute("aria-label"),
  marks: one.querySelectorAll("path, text, use").length,
  texts: [...one.querySelectorAll("text")].map((text) => text.textContent),
}))
"""
# of rows that are alike, a few are looked at, and of a picture nothing that cannot have the focus:
# axe-core takes seconds for thousands of elements
FEW_ELEMENTS = """
for (const body of document.querySelectorAll("tbody"))
  for (const row of [...body.rows].slice(4)) row.remove();
for (const part of document.querySelectorAll("svg[role=img] > :not(title)"))
  if (!part.matches("a, [tabindex]") && !part.querySelector("a, [tabindex]")) part.remove();
"""
SLIDER = "document.querySelector('.playback input[type=range]')"
# what has the focus in turn, by its place in the page; everything that can be pressed has a name
FOCUS = """
[...document.querySelectorAll("a[href], button, input, select, summary, [tabindex]")]
  .filter((one) => one.tabIndex >= 0).map((one) => one.tabIndex)
"""
UNNAMED = """
["button", "input", "select", "canvas", "svg[role=img]", "[role=group]", "table", "figure.playback"]
  .flatMap((one) => [...document.querySelectorAll(one)])
  .filter((one) => !(one.ariaLabel || one.textContent.trim() || one.title || one.labels?.length
    || one.caption || one.querySelector("title")))
  .map((one) => one.outerHTML.slice(0, 200))
"""


def kinds_of_results(graph: Path) -> set[tuple[str, str]]:
    """Return the nodes whose results a report shows, with the output where one is named."""
    plain: Any = read_yaml(graph.read_text(), graph.name).plain()
    shown = [each["show"] if isinstance(each, dict) else each for each in plain["report"]]
    places = [place.partition(".") for place in shown]
    return {(plain["nodes"][node]["use"], output) for node, _, output in places}


def varied() -> list[str]:
    """Return graphs whose reports show, together, every kind of result that any of them shows."""
    kinds = {path.stem: kinds_of_results(path) for path in GRAPHS}
    chosen: dict[str, set[tuple[str, str]]] = {}
    for name in sorted(kinds, key=lambda name: -len(kinds[name])):
        if kinds[name] - set().union(*chosen.values()):
            chosen[name] = kinds[name]
    return [*chosen]


def cells(text: str) -> tuple[list[str], list[list[str]]]:
    heads, *rows = csv.reader(io.StringIO(text))
    return heads, rows


def alike(shown: str, stored: str, *, percent: bool) -> bool:
    """Return whether a cell says what the file says, intervals and daggers after it aside."""
    if shown == stored or (shown in ("", "all") and stored in ("", "nan")):
        return True
    if stored in ("True", "False"):
        return shown == {"True": "yes", "False": "no"}[stored]
    if shown == "< 0.0001":
        return float(stored) < 1e-4
    try:
        number = shown.split(" ")[0]
        half = 0.501 * 10.0 ** -len(number.partition(".")[2].partition("e")[0])
        within = 1e-3 if "e" not in number else 5.1e-3  # three digits and a power of ten
        exact = float(stored) * (100.0 if percent else 1.0)
        close = math.isclose(float(number), exact, rel_tol=within)
        return close or ("e" not in number and abs(float(number) - exact) <= half)
    except ValueError:
        return False


@pytest.mark.parametrize("name", [*varied(), "live"])
def test_the_page_says_what_its_files_hold_fits_screens_and_paper_and_can_be_used(
    studies: Studies, tab: Page, name: str
) -> None:
    run = studies.few(name)
    load(tab, run / "report.html", width=DESKTOP[0], height=DESKTOP[1])
    assert_it_says_what_its_files_hold(run, tab)
    assert_it_fits_paper_and_screens(tab)
    assert_it_can_be_used_by_keys_and_mouse(run, tab)
    assert tab.evaluate("performance.getEntriesByType('resource').length") == 0
    if AXE:
        tab.evaluate(FEW_ELEMENTS)
        assert_all_can_read_it(tab)


def assert_it_says_what_its_files_hold(run: Path, page: Page) -> None:
    title = page.evaluate("document.querySelector('h1').textContent")
    assert title in (run / "graph.yaml").read_text()
    assert page.evaluate("document.querySelectorAll('main .result').length") > 0
    terms = page.locator(".answer .lead-words dd").all_text_contents()
    captions = page.locator(".caption").all_text_contents()
    assert not [term for term in terms if any(term in caption for caption in captions)]
    assert_tables_hold_what_their_files_hold(run, page)
    assert_figures_are_those_of_the_files_beside_the_page(run, page)


def assert_it_fits_paper_and_screens(page: Page) -> None:
    answer = page.locator(".answer").first.bounding_box()
    assert answer is not None
    assert answer["y"] + answer["height"] <= DESKTOP[1]
    widths = page.evaluate(AXES_OF_CARDS)
    assert max(widths, default=0.0) - min(widths, default=0.0) <= 2.0
    page.emulate_media(media="print")
    resize(page, PAPER)
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator(".printed").is_visible()
    assert page.evaluate(LEFT_OUT) == 0
    useless = page.locator(".files, .hint, details:not([open]) > summary")
    assert not useless.filter(visible=True).count()
    assert page.evaluate("document.documentElement.scrollWidth") <= PAPER
    assert 0 < len(re.findall(rb"/Type /Page\b", page.pdf(format="A4"))) <= MOST_PAGES
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    page.emulate_media(media="screen")
    page.evaluate(WIDER)
    for width in (1200, PHONE, SMALLEST):
        resize(page, width)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    page.evaluate("document.head.lastElementChild.remove()")
    resize(page, *DESKTOP)


def assert_tables_hold_what_their_files_hold(run: Path, page: Page) -> None:
    tables = [table for table in page.evaluate(TABLES) if table["file"]]
    stored = sorted(path.name for path in run.glob("*.csv"))
    assert sorted(table["file"] for table in tables) == stored
    for table in tables:
        heads, rows = cells((run / table["file"]).read_text())
        if table["laid_out"]:
            assert_each_mean_stands_where_its_labels_say(table, heads, rows)
            continue
        assert len(table["rows"]) == len(rows)
        for column, place in enumerate(table["columns"]):
            for shown, row in zip(table["rows"], rows, strict=True):
                percent = table["percent"][column]
                where = table["file"], heads[place]
                assert alike(shown[column], row[place], percent=percent), where


def assert_each_mean_stands_where_its_labels_say(
    table: dict[str, Any], heads: list[str], rows: list[list[str]]
) -> None:
    labels, mean = range(heads.index("blocks")), heads.index("mean")
    side = {place: column for column, place in enumerate(table["columns"]) if place in labels}
    seen = set()
    for row in rows:
        (down,) = [
            at
            for at, shown in enumerate(table["rows"])
            if all(alike(shown[side[place]], row[place], percent=False) for place in side)
        ]
        (along,) = [
            column
            for column, head in enumerate(table["heads"])
            if column not in side.values()
            and all(stands_in(head, heads[at], row[at]) for at in labels if at not in side)
        ]
        seen.add((down, along))
        percent = table["percent"][along]
        assert alike(table["rows"][down][along], row[mean], percent=percent), (table["file"], row)
    assert len(seen) == len(rows)
    empty = [
        not cell
        for down, shown in enumerate(table["rows"])
        for along, cell in enumerate(shown)
        if along not in side.values() and (down, along) not in seen
    ]
    assert all(empty)


def stands_in(head: str, name: str, label: str) -> bool:
    """Return whether a head names a label, a number with what it is."""
    is_number = is_text_of_number(label)
    text = f"{name} {float(label):.12g}" if is_number else label
    return f", {text}, " in f", {head}, "


def is_text_of_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def is_number(rows: list[list[str]], place: int) -> bool:
    values = [row[place] for row in rows]
    return any(values) and all(is_text_of_number(value) for value in values if value)


def plain_text(text: str) -> str:
    """Return what a text of an SVG file says; a power stands in a part of its own."""
    return " ".join(html.unescape(re.sub("<[^>]*>", "", text)).split())


def assert_figures_are_those_of_the_files_beside_the_page(run: Path, page: Page) -> None:
    drawn = page.evaluate(FIGURES)
    for figure in drawn:
        assert figure["label"]
        assert figure["marks"] > 10
        beside = (run / figure["file"]).with_suffix(".svg").read_text()
        texts = re.findall(r"<text\b[^>]*>(.*?)</text>", beside, re.DOTALL)
        assert [plain_text(text) for text in figure["texts"]] == [
            plain_text(text) for text in texts
        ]
    # what a chart of the page shows too is linked, and not drawn again
    links = page.evaluate(
        "[...document.querySelectorAll('.caption a[href$=\".svg\"]')]"
        ".map((one) => decodeURIComponent(one.getAttribute('href').slice(2)))"
    )
    assert sorted(links) == sorted(path.name for path in run.glob("*.svg"))
    assert {figure["file"] for figure in drawn} <= set(links)
    for path in run.glob("*.svg"):
        assert path.with_suffix(".pdf").read_bytes().startswith(b"%PDF")


def assert_it_can_be_used_by_keys_and_mouse(run: Path, page: Page) -> None:
    assert page.evaluate(UNNAMED) == []
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    order = page.evaluate(FOCUS)
    assert order == sorted(order)
    assert_a_table_sorts_by_a_click_and_is_copied_with_all_its_numbers(run, page)
    assert_playback_shows_what_the_data_say_plays_scrubs_and_turns(run, page)


def assert_a_table_sorts_by_a_click_and_is_copied_with_all_its_numbers(
    run: Path, page: Page
) -> None:
    table = page.evaluate(TABLES)[0]
    heads, rows = cells((run / table["file"]).read_text())
    place = next(
        place for place in table["columns"] if heads[place] not in LABELS and is_number(rows, place)
    )
    head = f"document.querySelector('figure.table thead th[data-column=\"{place}\"]')"
    page.evaluate(f"{head}.querySelector('button').click()")
    assert page.evaluate(f"{head}.ariaSort") == "ascending"
    page.evaluate(CLIPBOARD)
    page.evaluate("document.querySelector('.copy [aria-label$=CSV]').click()")
    names, copied = cells(page.evaluate("window.copied"))
    assert names == heads
    assert sorted(copied) == sorted(rows)
    numbers = [float(row[place]) for row in copied if row[place]]
    assert numbers == sorted(numbers)
    for name, start in (("LaTeX", "% needs"), ("Markdown", "| ")):
        page.evaluate(f"document.querySelector('.copy [aria-label$={name}]').click()")
        assert page.evaluate("window.copied").startswith(start)


def assert_playback_shows_what_the_data_say_plays_scrubs_and_turns(run: Path, page: Page) -> None:
    played = page.evaluate("document.querySelectorAll('figure.playback').length")
    assert bool(played) == ("use: plot.playback" in (run / "graph.yaml").read_text())
    if not played:
        return
    page.evaluate("for (const fold of document.querySelectorAll('.more')) fold.open = true")
    packed = page.evaluate("document.querySelector('figure.playback template').innerHTML")
    data = Read(base64.b64decode(packed))
    last = state(page)["tick"]
    for tick in dict.fromkeys((last, 0, 7)):
        page.evaluate(f"{SLIDER}.value = {tick}; {SLIDER}.dispatchEvent(new Event('input'))")
        playback = state(page)
        assert playback["tick"] == tick
        assert_drawn(playback, data, yaw=0.0)
    page.click(".playback [aria-label=Play]")
    until(page, f"{PLAYER}.state.tick > 9")
    page.click(".playback [aria-label=Pause]")
    still = state(page)
    assert_drawn(still, data, yaw=0.0)
    drag(page, "figure.playback canvas", 60, 0)
    turned = state(page)
    assert turned["tick"] == still["tick"]
    width = page.evaluate("document.querySelector('figure.playback canvas').clientWidth")
    assert_drawn(turned, data, yaw=math.pi * 60 / width)


def assert_drawn(playback: Any, data: Read, yaw: float) -> None:
    """Compare the markers' dots with the positions, seen from the front and turned by an angle."""
    panels = data.head["panels"]
    places = {panel["label"]: place for place, panel in enumerate(panels)}
    assert len(playback["panels"]) == (len(panels) if len(panels) <= 6 else 4)
    radius = max((panel["radius"] for panel in panels if panel["kind"] == "markers"), default=1.0)
    for shown in playback["panels"]:
        place = places[shown["label"]]
        panel = panels[place]
        if panel["kind"] != "markers":
            assert len(shown["dots"]) > 0
            continue
        right, up = np.array(panel["right"]), np.array(panel["up"])
        across = math.cos(yaw) * right + math.sin(yaw) * np.cross(right, up)
        scale = shown["size"] / (2 * radius)
        apart = (data.positions(place)[shown["frame"]] - panel["centre"]) * scale
        expected = np.stack([apart @ across, -(apart @ up)], axis=1) + shown["size"] / 2
        # a missing marker has no dot: NaN becomes null on the way here
        dots = np.array(shown["dots"], dtype=float).reshape(-1, 3)[:, :2]
        assert dots == pytest.approx(expected, abs=0.05, nan_ok=True)


def test_a_gap_is_opened_from_a_dot_a_row_and_a_place(studies: Studies, tab: Page) -> None:
    load(tab, studies.few("fill") / "report.html")
    views = 0

    def names_its_gap(*labels: str) -> None:
        nonlocal views
        head = tab.inner_text("dialog[open] .head")
        assert all(label in head for label in labels), head
        views += tab.locator("dialog[open] .gap-view .curves").count()
        tab.keyboard.press("Escape")
        tab.wait_for_selector("dialog", state="hidden")

    tab.focus(".dots canvas")
    for key in ("ArrowLeft", "Enter"):
        tab.keyboard.press(key)
    names_its_gap("length 45", "frames ")
    row = "figure.table tr[data-method]:visible >> nth=0"
    # a gap is named by what differs: all of these are of one condition
    labels = tab.locator(row).locator("th").all_inner_texts()[1:2]
    assert labels[0] in {"5", "45"}
    tab.click(f"{row} >> button.worst")
    names_its_gap(*labels)
    tab.focus(f"{row} >> .pick")
    for key in ("ArrowRight", "Enter"):
        tab.keyboard.press(key)
    names_its_gap(*labels)
    marker = tab.get_attribute("circle.disc >> nth=0", "data-marker")
    tab.focus("circle.disc >> nth=0")
    tab.keyboard.press("Enter")
    tab.click(".map-chart .here button >> nth=0")
    names_its_gap(f"marker {marker}")
    assert views >= 2  # the page holds how most of them look


def state(page: Page) -> Any:
    return page.evaluate(f"{PLAYER}.state")
