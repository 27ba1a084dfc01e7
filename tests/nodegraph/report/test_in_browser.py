"""The page in a browser: nothing complains, and what should happen happens."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from nodegraph.draw import Box, Picture, svg
from nodegraph.report import page
from tests.nodegraph.report.studies import TABLE, Page, refusals, study, timings

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
QUIET = (
    "--headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking"
    " --disable-component-update --disable-sync --enable-logging=stderr --virtual-time-budget=2000"
).split()
ON_LOAD = '<script>addEventListener("load", () => {{ {0} }});</script>'
CLICK = 'document.querySelectorAll("table.sortable th button")[{0}].click();'


def opened(html: str, folder: Path) -> tuple[str, list[str]]:
    """Return the page as the browser holds it once loaded, and what its console said."""
    file = folder / "report.html"
    file.write_text(html, encoding="utf-8")
    command = [str(BROWSER), *QUIET, f"--user-data-dir={folder / 'profile'}", "--dump-dom"]
    done = subprocess.run(
        [*command, file.as_uri()], capture_output=True, text=True, timeout=120, check=True
    )
    return done.stdout, [line for line in done.stderr.splitlines() if "CONSOLE" in line]


def first_column(html: str) -> list[str]:
    body = html[html.index("<tbody>") : html.index("</tbody>")]
    return [row.split("</td>")[0].split("<td>")[1] for row in body.split("<tr>")[1:]]


def test_the_console_stays_empty(tmp_path: Path) -> None:
    drawn = svg(Picture("drawn", (Box("capture"),)))
    whole = study(graph_svg=drawn, notes=refusals(3), timings=timings(), notes_markdown="*why*")
    html, said = opened(page(whole), tmp_path)
    assert said == []
    assert Page(html).text.count("refused") >= 2


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
    tmp_path: Path, clicks: list[int], order: list[str], state: str
) -> None:
    click = "".join(CLICK.format(one) for one in clicks)
    html, said = opened(page(study(TABLE + ON_LOAD.format(click))), tmp_path)
    assert said == []
    assert first_column(html) == order
    heads = [one.get("aria-sort") for one in list(Page(html).all("th"))[:2]]
    assert heads[clicks[-1]] == state
    assert heads[1 - clicks[-1]] is None


def test_a_handler_in_markup_does_not_run(tmp_path: Path) -> None:
    fragment = "<p id=bait onclick=\"document.title = 'ran'\">x</p>"
    click = ON_LOAD.format('document.getElementById("bait").click();')
    html, said = opened(page(study(fragment + click)), tmp_path)
    assert "<title>A title</title>" in html
    assert any("Content Security Policy" in line for line in said)


def test_the_network_is_out_of_reach(tmp_path: Path) -> None:
    call = 'fetch("https://example.invalid/").catch(() => { document.title = "refused"; });'
    html, said = opened(page(study(f"<script>{call}</script>")), tmp_path)
    assert "<title>refused</title>" in html
    assert any("Content Security Policy" in line for line in said)
