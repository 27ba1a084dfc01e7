"""The page in a browser: nothing complains, and what should happen happens."""

from __future__ import annotations

import html as html_module
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from nodegraph.draw import Box, Picture, svg
from nodegraph.plugin.hook_types import Rendered
from nodegraph.report import Section, StepNote, Study, TimingRow, page
from nodegraph.report.study import Kind

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
QUIET = [
    *("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update"),
    *("--enable-logging=stderr", "--virtual-time-budget=2000"),
]
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
ON_LOAD = '<script>addEventListener("load", () => {{ {0} }});</script>'
CLICK = 'document.querySelectorAll("table.sortable thead button")[{0}].click();'


def with_html(html: str) -> str:
    return page(Study("A title", sections=(Section("table", Rendered(html)),)))


def opened(html: str, folder: Path) -> tuple[str, list[str]]:
    """Return the page as the browser holds it once loaded, and what its console said."""
    file = folder / "report.html"
    file.write_text(html, encoding="utf-8")
    command = [str(BROWSER), *QUIET, f"--user-data-dir={folder / 'profile'}", "--dump-dom"]
    ended = subprocess.run(
        [*command, file.as_uri()], capture_output=True, text=True, timeout=120, check=True
    )
    return ended.stdout, [line for line in ended.stderr.splitlines() if "CONSOLE" in line]


def first_column(html: str) -> list[str]:
    body = html[html.index("<tbody>") : html.index("</tbody>")]
    return [row.split("</td>")[0].split("<td>")[1] for row in body.split("<tr>")[1:]]


def test_the_console_stays_empty(tmp_path: Path) -> None:
    whole = Study(
        "A title",
        notes_markdown="*why*",
        sections=(Section("table", Rendered(TABLE)),),
        graph_svg=svg(Picture("drawn", (Box("capture"),))),
        notes=(StepNote("fill", "trial=0", "needs a neutral pose", Kind.REFUSED),),
        timings=(TimingRow("fill", 1, 1.0),),
    )
    html, console = opened(page(whole), tmp_path)
    assert console == []
    assert "needs a neutral pose" in html


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
    click = "".join(CLICK.format(column) for column in clicks)
    html, console = opened(with_html(TABLE + ON_LOAD.format(click)), tmp_path)
    assert console == []
    assert first_column(html) == order
    heads = re.findall(r"<th [^>]*>", html)
    assert f'aria-sort="{state}"' in heads[clicks[-1]]
    assert "aria-sort" not in heads[1 - clicks[-1]]


@pytest.mark.parametrize(
    ("form", "text"),
    [
        (
            "CSV",
            "method,rmse [mm]\\nguenter,\u22121e-3\\nlin,9.5 \u00b1 0.2\\n"
            "muscle,10.123456\\nrefused,\\n",
        ),
        (
            "Markdown",
            "| method | rmse [mm] |\\n|---|---:|\\n| guenter | \u22121e-3 |\\n"
            "| lin | 9.5 \u00b1 0.2 |\\n| muscle | 10 |\\n| refused |  |\\n",
        ),
        (
            "LaTeX",
            r"% needs \usepackage{booktabs}\n\begin{table}\n\caption{Errors}\n"
            r"\begin{tabular}{lr}\n\toprule\nmethod & rmse {[}mm] \\\n\midrule\n"
            "guenter & \u22121e-3 \\\\\\n",
        ),
    ],
)
def test_a_table_is_copied_as_it_is_shown(tmp_path: Path, form: str, text: str) -> None:
    keep = 'document.title = t.replaceAll("\\n", "\\\\n"); return Promise.resolve();'
    board = f"{{value: {{writeText: (t) => {{{keep}}}}}}}"
    take = f'Object.defineProperty(navigator, "clipboard", {board});'
    press = f"document.querySelector('.copy [aria-label$=\"{form}\"]').click();"
    exact = TABLE.replace("</figure>", CSV)
    html, console = opened(
        with_html(exact + ON_LOAD.format(CLICK.format(1) + take + press)), tmp_path
    )
    assert console == []
    title = html_module.unescape(html[html.index("<title>") + 7 : html.index("</title>")])
    assert title.startswith(text)
    assert f"{form} copied" in html


LINKED = """
nodegraph.define("linked", ["selection"], (selection) => {
  addEventListener("load", () => {
    const pick = document.querySelectorAll(".pick");
    pick[1].click();
    selection.hover("method", "muscle");
    const rows = [...document.querySelectorAll("tbody tr")].map((row) => row.className);
    const theme = document.getElementById("theme");
    theme.click();
    document.title = JSON.stringify({
      chosen: selection.state.method, rows, pressed: pick[1].ariaPressed,
      stops: [...pick].filter((one) => one.tabIndex === 0).length,
      theme: document.documentElement.dataset.theme, shown: theme.textContent,
    });
  });
});
"""


def test_rows_follow_the_selection_and_the_theme_is_chosen(tmp_path: Path) -> None:
    linked = re.sub(r"<tr><td>(\w+)</td>", r'<tr data-method="\1"><th class="name">\1</th>', TABLE)
    rendered = Rendered(linked, scripts=(LINKED,))
    html, console = opened(page(Study("A title", sections=(Section("table", rendered),))), tmp_path)
    assert console == []
    title = html[html.index("<title>") + 7 : html.index("</title>")]
    assert json.loads(html_module.unescape(title)) == {
        "chosen": "refused",
        "rows": ["hovered", "selected", "", ""],
        "pressed": "true",
        "stops": 1,
        "theme": "dark",
        "shown": "Light",
    }


def test_a_script_that_results_bring_runs_once(tmp_path: Path) -> None:
    count = "document.title = `${document.querySelectorAll('.bait').length} ${document.title}`;"
    rendered = Rendered("<p class=bait>x</p>", scripts=(count,), styles=(".bait { color: red; }",))
    sections = tuple(Section(name, rendered) for name in ("one", "two"))
    html, console = opened(page(Study("A title", sections=sections)), tmp_path)
    assert console == []
    assert "<title>2 A title</title>" in html


def test_a_handler_in_markup_does_not_run(tmp_path: Path) -> None:
    fragment = "<p id=bait onclick=\"document.title = 'ran'\">x</p>"
    click = ON_LOAD.format('document.getElementById("bait").click();')
    html, console = opened(with_html(fragment + click), tmp_path)
    assert "<title>A title</title>" in html
    assert any("Content Security Policy" in line for line in console)


def test_the_network_is_out_of_reach(tmp_path: Path) -> None:
    call = 'fetch("https://example.invalid/").catch(() => { document.title = "refused"; });'
    html, console = opened(with_html(f"<script>{call}</script>"), tmp_path)
    assert "<title>refused</title>" in html
    assert any("Content Security Policy" in line for line in console)
