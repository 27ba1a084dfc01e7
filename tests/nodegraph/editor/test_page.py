"""The page in a browser: text and picture are the same, whichever is touched."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Page

import nodegraph as ng
from nodegraph.editor import file
from tests.browser import needs_axe, resize, until, violations
from tests.nodegraph.editor.conftest import GRAPH

EDITOR = ".cm-content"
TEXT = "[...document.querySelectorAll('.cm-line')].map((line) => line.textContent).join('\\n')"

_DRAWN = r"document.querySelector('#picture svg').outerHTML.replaceAll('\n', '')"
CHOSEN = "document.querySelector('#picture [aria-pressed=true]')?.dataset.box"


def has_box(name: str) -> str:
    return f"document.querySelector('#picture [data-box={name}]')"


def state(text: str) -> str:
    return f"document.getElementById('state').textContent.startsWith({text!r})"


@pytest.fixture
def page(address: str, tab: Page) -> Page:
    """The page of the file, which the tab, the later fixture, leaves before the server ends."""
    resize(tab, 1600, 900)
    tab.goto(address)
    tab.wait_for_selector("#picture [data-box=error]")
    return tab


_END_OF_TEXT = """
([line, column]) => {
  const whole = document.querySelectorAll(".cm-line")[line];
  const texts = document.createTreeWalker(whole, NodeFilter.SHOW_TEXT);
  let text = texts.nextNode();
  for (; column > text.length; text = texts.nextNode()) column -= text.length;
  const range = document.createRange();
  range.setStart(text, column - 1);
  range.setEnd(text, column);
  const { right, top, bottom } = range.getBoundingClientRect();
  return [right, (top + bottom) / 2];
}
"""


def put_cursor(page: Page, before: str) -> None:
    """Put the cursor behind a part of the text."""
    *above, line = GRAPH[: GRAPH.index(before) + len(before)].split("\n")
    page.mouse.click(*page.evaluate(_END_OF_TEXT, [len(above), len(line)]))


def test_what_is_typed_is_drawn_undone_and_saved(page: Page, path: Path) -> None:
    assert page.evaluate(TEXT) == GRAPH
    put_cursor(page, "[5, 15")
    page.keyboard.type(", 45")
    until(page, state("not saved"))
    until(page, "document.querySelector('#picture').textContent.includes('length: 5, 15, 45')")
    page.keyboard.press("Control+z")
    until(page, state("saved"))
    assert page.evaluate(TEXT) == GRAPH
    page.keyboard.press("Control+Shift+Z")
    until(page, state("not saved"))
    page.keyboard.press("Control+s")
    until(page, state("saved"))
    assert path.read_text() == GRAPH.replace("[5, 15]", "[5, 15, 45]")
    page.click("#undo")
    until(page, state("not saved"))
    assert not page.is_disabled("#save")


def test_what_is_typed_before_the_last_edit_is_answered_goes_on_from_it(page: Page) -> None:
    page.evaluate(
        """() => {
          const ask = window.fetch;
          window.fetch = async (...request) => {
            const answer = await ask(...request);
            if (request[0] === "/edit") await new Promise((done) => { window.release = done; });
            window.fetch = request[0] === "/edit" ? ask : window.fetch;
            return answer;
          };
        }"""
    )
    put_cursor(page, "[5, 15")
    page.keyboard.type(", 4")
    until(page, "window.release")
    page.keyboard.type("5")
    page.evaluate("window.release()")
    until(page, "document.querySelector('#picture').textContent.includes('length: 5, 15, 45')")
    assert not page.evaluate("document.getElementById('conflict').open")


def test_cards_that_an_edit_does_not_change_stay_and_move(page: Page) -> None:
    place = f"{has_box('error')}.getAttribute('transform')"
    before = page.evaluate(place)
    page.evaluate(f"{has_box('capture')}.stays = {has_box('error')}.stays = true")
    put_cursor(page, "fill.muscle")
    page.keyboard.type(", fill.neighbour_kalman")
    until(page, f"/neighbour_kalman/.test({has_box('fill')}.textContent)")
    until(page, "!document.querySelector('#problems li')")
    assert page.evaluate(f"{has_box('capture')}.stays && {has_box('error')}.stays")
    assert page.evaluate(place) != before
    drawn = page.evaluate(_DRAWN)
    page.reload()
    until(page, f"document.querySelector('#picture svg') && {CHOSEN}")
    assert page.evaluate(_DRAWN) == drawn
    page.click("#undo")
    until(page, f"{has_box('error')}.getAttribute('transform') === {before!r}")


def test_a_mistake_stands_at_its_place_until_it_is_mended(page: Page) -> None:
    put_cursor(page, "fill.muscle")
    page.keyboard.type("s")
    page.keyboard.press("Escape")
    until(page, "document.querySelector('#problems li.error')")
    assert "no node 'fill.muscles'" in page.inner_text("#problems")
    assert page.inner_text(".cm-lintRange-error") == "fill.muscles"
    assert "mistake" in page.inner_text("#reason")
    page.keyboard.press("Control+Home")
    page.click("#problems li button")
    page.keyboard.press("Control+ArrowRight")
    page.keyboard.press("Control+ArrowRight")
    page.keyboard.press("Control+ArrowRight")
    page.keyboard.press("Backspace")
    until(page, "!document.querySelector('#problems li')")
    assert page.evaluate(TEXT) == GRAPH
    assert page.inner_text("#reason") == ""


def test_words_are_completed_and_explained(page: Page) -> None:
    put_cursor(page, "with: {length: $length")
    page.keyboard.type(", coun")
    until(page, "document.querySelector('.cm-tooltip-autocomplete li[aria-selected]')")
    assert "count" in page.inner_text(".cm-tooltip-autocomplete li[aria-selected]")
    page.click(".cm-tooltip-autocomplete li[aria-selected]")
    page.keyboard.type("3")
    until(page, state("not saved"))
    until(page, "document.querySelector('.cm-content').textContent.includes('count: 3}')")
    until(page, "!document.querySelector('#problems li')")
    for _ in range(4):
        page.keyboard.press("ArrowLeft")
    until(page, "document.querySelector('#about b')?.textContent === 'count'")
    # keys that come slowly are several edits
    until(page, f"{state('saved')} || document.getElementById('undo').click()")


def test_a_card_and_its_lines_are_chosen_together(page: Page) -> None:
    page.click("#picture [data-box=fill] .frame")
    assert page.evaluate(CHOSEN) == "fill"
    assert page.evaluate("location.hash") == "#fill"
    marked = page.locator(".cm-chosen").all_inner_texts()
    assert "\n".join(marked) == GRAPH[GRAPH.index("  fill:") : GRAPH.index("\n  error:")]
    put_cursor(page, "use: score.ga")
    until(page, f"{CHOSEN} === 'error'")
    page.focus("#picture [aria-pressed=true]")
    page.keyboard.press("Home")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    assert page.evaluate(CHOSEN) == "gaps"
    page.evaluate("location.hash = '#capture'")
    until(page, f"{CHOSEN} === 'capture'")
    page.goto(page.url.partition("#")[0] + "#fill")
    until(page, f"{CHOSEN} === 'fill'")


def test_a_card_stays_in_hand_while_the_cursor_is_elsewhere(page: Page) -> None:
    put_cursor(page, "use: read.rec")
    until(page, f"{CHOSEN} === 'capture'")
    page.click("#picture [data-box=gaps] .frame")
    page.get_by_label("count", exact=True).fill("3")
    page.keyboard.press("Tab")
    until(page, has_text("count: 3"))
    assert page.evaluate(CHOSEN) == "gaps"
    assert page.get_by_label("count", exact=True).input_value() == "3"
    assert page.evaluate("document.activeElement.closest('#panel') !== null")


def test_a_picture_is_as_large_as_one_likes(page: Page) -> None:
    width = "document.querySelector('#picture svg').getBoundingClientRect().width"
    room = "document.querySelector('#picture').clientWidth"
    first = page.evaluate(width)
    for _ in range(5):
        page.click("#larger")
    assert page.evaluate(width) > page.evaluate(room) > first
    put_cursor(page, "[5, 15")
    page.keyboard.type(", 45")
    until(page, "document.querySelector('#picture').textContent.includes('length: 5, 15, 45')")
    assert page.evaluate(width) > page.evaluate(room)
    page.click("#fit")
    assert page.evaluate(width) < page.evaluate(room)
    before = page.evaluate(width)
    page.click("#smaller")
    assert page.evaluate(width) < before
    before = page.evaluate(width)
    page.mouse.move(*bottom(page))
    page.keyboard.down("Control")
    page.mouse.wheel(0, -100)
    until(page, f"{width} > 1.2 * {before}")
    page.mouse.wheel(0, -1000)
    page.mouse.wheel(0, -1000)
    page.mouse.wheel(0, -1000)
    page.keyboard.up("Control")
    until(page, f"{width} > {room}")
    left = "document.querySelector('#picture').scrollLeft"
    page.mouse.down()
    before = page.evaluate(f"{left}")
    page.mouse.move(bottom(page)[0] + 100, bottom(page)[1])
    page.mouse.up()
    until(page, "document.querySelector('#picture svg').parentElement.style.transform === ''")
    assert page.evaluate(left) == before - 100
    assert page.evaluate(width) > page.evaluate(room)
    page.click("#fit")
    page.evaluate("location.hash = '#%'")  # no name of a node
    page.dblclick("#picture", position={"x": 5, "y": 5})
    until(page, "document.getElementById('search').open")
    page.click("#search-cancel")
    assert page.evaluate("document.querySelector('[aria-pressed=true]')") is None


def drag_link(page: Page, output: str, x: float, y: float) -> None:
    """Drag from an output, ``gaps.gappy``, to a place of the window."""
    box, _, port = output.partition(".")
    page.mouse.move(*centre(page, f"[data-box={box}] [data-output={port}]"))
    page.mouse.down()
    page.mouse.move(x + 8, y)
    page.mouse.move(x, y)


def centre(page: Page, selector: str) -> tuple[float, float]:
    box = page.locator(selector).bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def test_a_link_is_drawn_from_an_output_to_a_port(page: Page) -> None:
    estimate = "[data-box=error] [data-input=estimate]"
    drag_link(page, "gaps.gappy", *centre(page, estimate))
    until(page, "document.querySelector('#picture [data-fits]')")
    marked = "[...document.querySelectorAll('[data-fits]')].map(({ dataset }) => dataset.input)"
    assert page.evaluate(marked) == ["recording", "estimate", "truth"]
    page.mouse.up()
    until(page, has_text("estimate: gaps.gappy"))
    assert page.evaluate(marked) == []
    until(page, f"{CHOSEN} === 'error'")
    page.click("#undo")
    until(page, state("saved"))
    assert page.evaluate(TEXT) == GRAPH
    for target, said in (
        (estimate, "error.estimate: 'estimate' takes Trajectories, not Mask"),
        ("[data-box=fill] .name", "fill: 'recording' takes Trajectories, not Mask"),
    ):
        drag_link(page, "gaps.hidden", *centre(page, target))
        page.mouse.up()
        said = f"gaps.hidden does not feed {said}"
        until(page, f"document.getElementById('notice').textContent === {said!r}")
    drag_link(page, "gaps.gappy", *centre(page, "[data-box=error] .name"))
    page.mouse.up()
    until(page, "document.getElementById('notice').textContent.includes('fits estimate, truth')")
    drag_link(page, "gaps.gappy", *centre(page, estimate))
    page.keyboard.press("Escape")
    page.mouse.up()
    assert page.query_selector("#picture .drawn") is None
    drag_link(page, "error.output", *bottom(page))
    page.mouse.up()
    until(page, "document.getElementById('search').open")
    assert page.inner_text("#search-title") == "Add a node that error feeds"
    page.keyboard.type("compare.table")
    page.keyboard.press("Enter")
    until(page, has_text("compare: {use: compare.table, in: error}"))


def bottom(page: Page) -> tuple[float, float]:
    """Return a place below all cards."""
    pane = page.locator("#picture").bounding_box()
    assert pane is not None
    return pane["x"] + pane["width"] / 2, pane["y"] + pane["height"] - 30


def test_another_program_changes_the_file(page: Page, path: Path) -> None:
    put_cursor(page, "Two")
    page.keyboard.type(" good")
    until(page, state("not saved"))
    path.write_text(GRAPH.replace("report: [error]", "report: [error, gaps.hidden]"))
    until(page, "document.querySelector('.cm-content').textContent.includes('gaps.hidden]')")
    assert "taken over" in page.inner_text("#notice")
    assert "Two good fills" in page.evaluate(TEXT)
    path.write_text(GRAPH.replace("Two", "Three"))
    until(page, "document.getElementById('conflict').open")
    theirs, mine = page.locator("#conflict pre").all_inner_texts()
    assert "title: Three fills" in theirs
    assert "title: Two good fills" in mine
    page.click("#conflict button[value=theirs]")
    until(page, state("saved"))
    assert page.evaluate(TEXT) == path.read_text()
    page.keyboard.press("Control+z")
    until(page, state("not saved"))
    assert "Two good fills" in page.evaluate(TEXT)


def test_two_pages_of_one_file_show_the_same(page: Page) -> None:
    other = page.context.new_page()
    resize(other, 1600, 900)
    other.goto(page.url)
    until(other, has_box("error"))
    put_cursor(page, "Two")
    page.keyboard.type(" good")
    until(other, "document.querySelector('.cm-content').textContent.includes('Two good')")
    assert other.evaluate(TEXT) == page.evaluate(TEXT)
    other.click("#undo")
    until(page, "document.querySelector('.cm-content').textContent.includes('Two fills')")


_DEAF = """
const told = fetch;
window.fetch = (address, ...rest) =>
  address.startsWith("/revision") ? new Promise(() => {}) : told(address, ...rest);
0;
"""


@pytest.mark.parametrize("choice", ["theirs", "mine"])
def test_two_pages_edit_one_line(page: Page, choice: str) -> None:
    other = page.context.new_page()
    resize(other, 1600, 900)
    other.goto(page.url)
    until(other, has_box("error"))
    other.evaluate(_DEAF)  # it does not hear of what the first page does
    put_cursor(page, "Two")
    page.keyboard.type(" good")
    until(page, state("not saved"))
    put_cursor(other, "Two")
    other.keyboard.type(" bad")
    until(other, "document.getElementById('conflict').open")
    assert ["Two good" in text for text in other.locator("#conflict pre").all_inner_texts()] == [
        True,
        False,
    ]
    other.click(f"#conflict button[value={choice}]")
    until(other, "!document.getElementById('conflict').open")
    until(page, has_text("Two good fills" if choice == "theirs" else "Two bad fills"))
    assert other.evaluate(TEXT) == page.evaluate(TEXT)


def add(page: Page, words: str, name: str) -> None:
    """Add a node by keys: search it, and take the first that is found."""
    page.focus("#add")
    page.keyboard.press("/")
    until(page, "document.activeElement?.id === 'search-words'")
    page.keyboard.type(words)
    page.keyboard.press("Enter")
    until(page, f"{CHOSEN} === {name!r}")
    until(page, f"document.querySelector('#panel h2')?.textContent === {name!r}")


def has_text(text: str) -> str:
    return f"document.querySelector('.cm-content').textContent.includes({text!r})"


def test_a_study_is_made_from_an_empty_file_by_keys(page: Page, path: Path) -> None:
    page.focus(EDITOR)
    page.keyboard.press("Control+a")
    page.keyboard.press("Delete")
    until(page, "/^the file is empty: /.test(document.getElementById('reason').textContent)")
    add(page, "read recording", "read")
    until(page, "document.activeElement.matches('[aria-describedby$=path-about]:invalid')")
    page.keyboard.type("sample:face")
    page.keyboard.press("Tab")
    until(page, "!document.querySelector('#problems li')")
    page.focus("#panel-name")
    page.keyboard.press("Control+a")
    page.keyboard.type("take")
    page.keyboard.press("Enter")
    until(page, f"{CHOSEN} === 'take'")
    add(page, "gaps.cut", "gaps")
    add(page, "fill.linear", "fill")
    assert page.get_by_label("recording", exact=True).input_value() == "gaps.gappy"
    page.get_by_label("Another method beside it").select_option("fill.muscle")
    page.get_by_text("Add a rival").press("Enter")
    until(page, has_text("muscle: {use: fill.muscle}"))
    until(page, "document.activeElement.id.includes('alternatives-muscle-with')")
    add(page, "score.gaps", "score")
    ports = ("estimate", "truth", "hidden")
    fed = [page.get_by_label(port, exact=True).input_value() for port in ports]
    assert fed == ["fill", "gaps.truth", "gaps.hidden"]
    truth = page.get_by_label("truth", exact=True)
    refused = truth.locator("optgroup option", has_text="gaps.hidden").text_content()
    assert refused == "gaps.hidden: 'truth' takes Trajectories, not Mask"
    truth.select_option("take")
    until(page, has_text("truth: take"))
    truth.select_option("gaps.truth")
    until(page, has_text("truth: gaps.truth"))
    until(page, "!document.querySelector('#problems li')")
    page.locator("#axes-open").press("Enter")
    page.get_by_label("New axis").fill("length")
    page.locator("#axes").get_by_label("Labels").last.fill("[5, 15]")
    page.locator("#axes-rows button").last.press("Enter")
    until(page, has_text("axes: {length: [5, 15]}"))
    page.locator("#axes-close").press("Enter")
    page.evaluate("location.hash = '#gaps'")
    until(page, "document.querySelector('#panel h2')?.textContent === 'gaps'")
    page.get_by_label("length", exact=True).fill("$length")
    page.keyboard.press("Tab")
    until(page, "document.querySelector('#picture').textContent.includes('length: 5, 15')")
    until(page, "!document.querySelector('#problems li')")
    page.keyboard.press("Control+s")
    until(page, state("saved"))
    graph = ng.load(path)
    assert list(graph.nodes) == ["take", "gaps", "fill", "score"]
    assert {name: axis.labels for name, axis in graph.axes.items()} == {
        "length": (5, 15),
        "fill": ("linear", "muscle"),
    }


def test_a_node_is_removed_and_comes_back_by_mouse(page: Page, complaints: list[str]) -> None:
    page.click("#picture [data-box=gaps] .frame")
    page.click("text=Remove the node")
    until(page, "document.getElementById('notice').textContent.includes('feeds fill, error')")
    assert [each for each in complaints if "422" not in each] == []
    complaints.clear()
    page.click("#picture [data-box=error] .frame")
    until(page, "document.querySelector('#panel h2')?.textContent === 'error'")
    page.click("text=Remove the node")
    until(page, f"!{has_box('error')}")
    page.click("#undo")
    until(page, has_box("error"))
    assert page.evaluate(TEXT) == GRAPH
    page.click("#picture [data-box=fill] .frame")
    page.get_by_label("An alternative").select_option("linear")
    page.click("text=Remove it")
    until(page, has_text("alternatives: [fill.muscle]"))
    ends = page.get_by_role("group", name="all alternatives").get_by_label("ends", exact=True)
    ends.select_option("met")
    until(page, has_text("with: {ends: met}"))
    ends.select_option("")
    until(page, f"!({has_text('ends: met')})")


def test_nodes_move_into_a_graph_of_their_own(page: Page, path: Path) -> None:
    page.click("#move-open")
    page.get_by_label("Nodes", exact=True).last.select_option(["gaps", "fill"])
    page.get_by_label("Name of the node").fill("cut")
    assert page.get_by_label("New file").input_value() == "cut.yaml"
    page.click("#move-done")
    until(page, has_box("cut\\\\.fill"))
    assert "cut:" in page.evaluate(TEXT)
    assert page.evaluate("location.hash") == "#cut"
    assert (path.parent / "cut.yaml").is_file()
    page.click("#picture [data-box='cut.gaps'] .frame")
    assert page.evaluate("location.hash") == "#cut"


def test_a_text_that_is_refused_is_sent_once(
    page: Page, complaints: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(file, "MOST_BYTES", len(GRAPH))
    put_cursor(page, "Two")
    page.keyboard.type("!")
    until(page, "document.getElementById('notice').textContent.includes('too large')")
    for name in ("gaps", "fill", "error"):
        page.click(f"#picture [data-box={name}] .frame")
        until(page, f"document.querySelector('#panel h2')?.textContent === {name!r}")
    assert len(complaints) == 1
    assert "422" in complaints[0]
    complaints.clear()
    put_cursor(page, "Two")
    page.keyboard.press("Delete")
    until(page, state("saved"))
    assert page.evaluate(TEXT) == GRAPH


def test_text_of_a_graph_is_never_markup(page: Page, path: Path) -> None:
    bad = "<img src=x onerror=alert(1)>"
    label = "{'<b>odd</b>': {use: fill.muscle}, \"</style><u>\": {use: fill.linear}}"
    hostile = GRAPH.replace("Two fills", f'"{bad}"').replace("[fill.linear, fill.muscle]", label)
    path.write_text(hostile.replace("[5, 15]", "['<i>a</i>', 5]") + f'"{bad}": 1\n')
    until(page, "document.querySelector('#problems li.error')")
    page.click("#picture [data-box=fill] .frame")
    until(page, "document.querySelector('#panel h2')?.textContent === 'fill'")
    page.click("#axes-open")
    until(page, "document.getElementById('axes').open")
    assert bad in page.inner_text("#problems")
    assert page.query_selector_all("main img, main b, main u, main i, dialog i") == []
    page.click("#axes-close")


def test_on_a_phone_what_a_setting_means_has_the_width_of_the_panel(page: Page) -> None:
    page.click("#picture [data-box=fill] .frame")
    until(page, "document.querySelector('#panel h2')?.textContent === 'fill'")
    resize(page, 390)
    texts = "[...document.querySelectorAll('#panel fieldset small')]"
    long = f"{texts}.filter(({{ textContent }}) => textContent.length > 100)"
    widths = page.evaluate(f"{long}.map(({{ offsetWidth }}) => offsetWidth)")
    assert min(widths) > 390 - 80  # within its margins
    panel = "document.getElementById('panel').getBoundingClientRect()"
    assert page.evaluate(f"document.documentElement.scrollHeight - scrollY - {panel}.bottom") < 1
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_a_graph_with_mistakes_is_mended_in_the_picture(page: Page) -> None:
    put_cursor(page, "in: capture")
    page.keyboard.type("d")
    page.keyboard.press("Escape")
    until(page, "document.querySelector('#picture [data-box=gaps][data-wrong]')")
    page.get_by_label("recording", exact=True).select_option("capture")
    until(page, "!document.querySelector('#problems li')")
    assert page.evaluate(TEXT) == GRAPH
    assert page.query_selector("[data-wrong]") is None


@needs_axe
def test_readers_with_disabilities_can_use_it(page: Page) -> None:
    def assert_nothing_is_found() -> None:
        page.emulate_media(color_scheme="dark")
        assert violations(page, rules=("color-contrast",)) == []
        page.emulate_media(color_scheme="light")
        assert violations(page) == []

    assert_nothing_is_found()
    put_cursor(page, "fill.muscle")
    page.keyboard.type("s")
    page.keyboard.press("Escape")
    until(page, "document.querySelector('#problems li.error')")
    until(page, "document.querySelector('#panel h2')?.textContent === 'fill'")
    assert_nothing_is_found()
    for opens, dialog in (("#add", "search"), ("#axes-open", "axes"), ("#move-open", "move")):
        page.click(opens)
        until(page, f"document.getElementById({dialog!r}).open")
        assert_nothing_is_found()
        page.keyboard.press("Escape")
