"""Pages in Debian's Chromium, through Playwright: a browser with one tab, which is cleared.

Set ``NODEGRAPH_AXE`` to the folder of the package ``axe-core``, as ``npm pack axe-core`` gives it.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Literal
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import (
    BrowserContext,
    ConsoleMessage,
    Error,
    Page,
    Request,
    ViewportSize,
    sync_playwright,
)

AXE = os.environ.get("NODEGRAPH_AXE", "")
needs_axe = pytest.mark.skipif(not AXE, reason="NODEGRAPH_AXE names no folder of axe-core")

# the machines that test have no graphics card; WebGL is drawn by the processor. No page is open
# long enough for its scripts to be worth compiling for speed
_ARGUMENTS = (
    *("--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    "--js-flags=--no-opt",
)
_SIZE: ViewportSize = {"width": 1280, "height": 900}
_PLAYBACKS_ARE_READY = """
[...document.querySelectorAll("figure.playback")]
  .every((figure) => figure.playback || /cannot/.test(figure.textContent))
"""


@pytest.fixture(scope="session")
def chromium() -> Iterator[BrowserContext]:
    """A browser with one profile, which is started when a test first needs it."""
    # the first is the same without windows: it opens pages in a third of the time
    names = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
    path = next(filter(None, map(shutil.which, names)), None)
    if path is None:
        pytest.skip("no Chromium is installed")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=_ARGUMENTS)
        yield browser.new_context(viewport=_SIZE)
        browser.close()


@pytest.fixture(scope="session")
def _only_tab(chromium: BrowserContext) -> Page:
    return chromium.new_page()  # a page in a new one takes twice as long


@pytest.fixture
def complaints() -> list[str]:
    """What the console of the tab says, and where the page wants to go; a test may clear it."""
    return []


@pytest.fixture
def tab(_only_tab: Page, complaints: list[str]) -> Iterator[Page]:
    """An empty page, which must not complain nor leave this machine, and keeps nothing."""

    def watch(request: Request) -> None:
        address = urlsplit(request.url)
        if address.scheme not in ("file", "data", "blob") and address.hostname != "127.0.0.1":
            complaints.append(f"{request.method} {request.url}")

    def listen(message: ConsoleMessage) -> None:
        if "GL Driver Message" not in message.text:  # of how fast the processor draws
            complaints.append(message.text)

    def fail(error: Error) -> None:
        complaints.append(str(error))

    page = _only_tab
    page.on("request", watch)
    page.on("console", listen)
    page.on("pageerror", fail)
    yield page
    page.evaluate("try { localStorage.clear(); sessionStorage.clear(); } catch { /* has none */ }")
    page.remove_listener("request", watch)
    page.remove_listener("console", listen)
    page.remove_listener("pageerror", fail)
    for other in page.context.pages:
        if other is not page:
            other.close()
    page.goto("about:blank")  # first: a page would be drawn again for each of the following
    page.context.clear_permissions()
    page.context.clear_cookies()
    page.unroute_all()
    page.emulate_media(media="null", color_scheme="null", reduced_motion="null")
    page.mouse.move(0, 0)
    resize(page, **_SIZE)
    assert complaints == []


def load(
    tab: Page, file: Path, *, width: int = _SIZE["width"], height: int = _SIZE["height"]
) -> None:
    """Load a file in a window of that size, and wait until its playbacks are there."""
    resize(tab, width, height)
    tab.goto(file.as_uri())
    until(tab, _PLAYBACKS_ARE_READY)


def resize(tab: Page, width: int, height: int = _SIZE["height"]) -> None:
    """Give the window another size, in pixels of the page."""
    size: ViewportSize = {"width": width, "height": height}
    if tab.viewport_size != size:  # a browser draws a page again that gets the size that it has
        tab.set_viewport_size(size)


def until(tab: Page, condition: str) -> None:
    """Wait, frame by frame of the browser, until something holds."""
    # Playwright's own waiting evaluates text within the page, which forbids that
    tab.evaluate(
        f"new Promise((done) => {{ const look = () => ({condition}) ? done(true) "
        ": requestAnimationFrame(look); look(); })"
    )


def middle(tab: Page, selector: str) -> tuple[float, float]:
    """Scroll to an element; return the pixel in its middle."""
    element = tab.locator(selector).first
    element.evaluate("(element) => element.scrollIntoView({ block: 'center' })")
    box = element.bounding_box()
    assert box is not None, selector
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def drag(tab: Page, selector: str, right: float, down: float) -> None:
    """Press in the middle of an element, move by so many pixels, let go."""
    x, y = middle(tab, selector)
    tab.mouse.move(x, y)
    tab.mouse.down()
    tab.mouse.move(x + right, y + down)
    tab.mouse.up()


def assert_all_can_read_it(tab: Page, place: str = "html") -> None:
    """Check with axe-core a part of a page on a desk, and what a phone and dark colours change."""
    on_phones = ("color-contrast", "scrollable-region-focusable", "target-size")
    screens: tuple[tuple[Literal["light", "dark"], int, tuple[str, ...]], ...]
    screens = (("light", 1280, ()), ("dark", 390, on_phones))
    for colours, width, rules in screens:
        tab.emulate_media(color_scheme=colours)
        resize(tab, width)
        assert tab.evaluate("document.documentElement.scrollWidth") <= width
        assert violations(tab, place, rules) == []


def violations(tab: Page, place: str = "html", rules: Sequence[str] = ()) -> list[str]:
    """Return what axe-core finds in a part of the page, with the elements.

    Parameters
    ----------
    tab
    place
    rules
        The only ones to be checked, or all.
    """
    if not tab.evaluate("'axe' in window"):
        tab.evaluate(Path(AXE, "axe.min.js").read_text(encoding="utf-8") + ";0")
    result = tab.evaluate(
        "([place, options]) => axe.run(place, options).then(({ violations }) => violations)",
        [place, {"resultTypes": ["violations"], **({"runOnly": list(rules)} if rules else {})}],
    )
    return [f"{each['id']}: {node['html']}" for each in result for node in each["nodes"]]
