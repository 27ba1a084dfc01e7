"""The site of what is installed is whole: links resolve, and all that is installed appears."""

from __future__ import annotations

import doctest
import re
import subprocess
from collections.abc import Iterator
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from typing import NamedTuple, get_type_hints
from urllib.parse import unquote

import pytest
from playwright.sync_api import Page

import nodegraph as ng
from nodegraph.cli.main import COMMANDS, main
from nodegraph.graphfile.keys import TOP_LEVEL
from nodegraph.plugin import hooks
from nodegraph.plugin.hook_types import expect
from nodegraph.plugin.registry import Registry
from nodegraph.report import Study
from nodegraph.report.study import study_bytes
from nodegraph.runs.folder import REPORT, STUDY
from tests import readmes
from tests.browser import AXE, load, violations

PAGES = Path(readmes.ROOT) / "nodegraph" / "site" / "pages"
HOSTILE = '</title><script>alert(1)</script><img src="https://example.org/x.png">'


class Lips(NamedTuple):
    width: float = 0.0


class Links(HTMLParser):
    """The addresses and the anchors of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.addresses: list[str] = []
        self.anchors: set[str] = set()
        self.scripts = 0
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("href", "src"):
                self.addresses.append(value or "")
            if name == "id":
                assert value not in self.anchors, value
                self.anchors.add(value or "")
        self.scripts += tag == "script"


def write_run(folder: Path, study: Study) -> None:
    folder.mkdir(parents=True)
    (folder / STUDY).write_bytes(study_bytes(study))
    (folder / REPORT).write_text("<!DOCTYPE html><title>A report</title>")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    write_run(
        folder / "runs" / "fill",
        Study("Fills", answer=("It is linear.",), graph_file="a/fill.yaml"),
    )
    write_run(folder / "more" / "fill", Study(HOSTILE, answer=(HOSTILE,), graph_file="b.yaml"))
    runs = [str(folder / name / "fill") for name in ("runs", "more")]
    assert main(["site", *runs, "--out", str(folder / "out")]) == 0
    return folder / "out"


def pages(site: Path) -> Iterator[tuple[Path, Links]]:
    for path in site.rglob("*.html"):
        if path.name != REPORT:
            yield path, Links(path.read_text())


def test_every_link_leads_to_a_page_and_its_anchor(site: Path) -> None:
    known = {path.resolve(): links.anchors for path, links in pages(site)}
    for path, links in pages(site):
        for address in links.addresses:
            if address.startswith("https://"):
                continue
            file, _, anchor = unquote(address).partition("#")
            target = (path.parent / file).resolve() if file else path.resolve()
            assert target.is_file(), f"{path}: {address}"
            assert not anchor or anchor in known[target], f"{path}: {address}"


def test_no_page_can_reach_the_network(site: Path) -> None:
    for path, links in pages(site):
        text = path.read_text()
        assert "default-src 'none'" in text.partition("<title>")[0]
        assert not re.search(r'src="(?!\./)[a-z]+:', text)
        assert links.scripts == (2 if path.name == "search.html" else 0)


def test_every_node_command_hook_and_key_appears(site: Path) -> None:
    texts = {path.relative_to(site).as_posix(): path.read_text() for path, _ in pages(site)}
    for entry in Registry.installed():
        page = unescape(texts[f"nodes/{entry.node.family}.html"])
        assert f'id="{entry.plugin}-{entry.node.name}"' in page
        assert all(f"<code>{name}</code>" in page for name in entry.node.settings)
    assert all(f'id="{name}"' in texts["commands.html"] for name in COMMANDS)
    names = [name for name in vars(hooks) if name.startswith("nodegraph_")]
    assert all(f'id="{name}"' in texts["plugins.html"] for name in names)
    assert all(f"<td><code>{name}</code></td>" in texts["language.html"] for name in TOP_LEVEL)
    index = (site / "search-index.js").read_text()
    assert all(f'"{name}"' in index for name in ("fill.muscle", "nodegraph lock", "alternatives"))


@pytest.mark.parametrize("name", [name for name in vars(hooks) if name.startswith("nodegraph_")])
def test_the_example_of_a_hook_gives_what_the_hook_returns(name: str, tmp_path: Path) -> None:
    hook = vars(hooks)[name]
    (example,) = doctest.DocTestParser().get_examples(hook.__doc__)
    names = dict.fromkeys(re.findall(r"\b[a-z]+(?:_[a-z]+)+\b", example.source), callable)
    space = {**names, **vars(ng), "hookimpl": ng.hookimpl, "Path": Path, "Lips": Lips}
    space |= {name: getattr(ng, name) for name in ng.__all__}
    space |= {"Spline": Lips, "__file__": str(tmp_path / "plugin.py")}
    exec(example.source, space)
    if name == "nodegraph_nodes":
        return  # it imports a package
    value = space[name]()
    expect(value, get_type_hints(hook)["return"])
    for item in value if isinstance(value, list) else ():
        assert type(item).__name__ in str(get_type_hints(hook)["return"]) or callable(item)


def test_the_gallery_has_every_study_with_its_report_or_its_command(site: Path) -> None:
    text = unescape((site / "gallery.html").read_text())
    assert "It is linear." in text
    assert (site / "runs" / "fill" / REPORT).is_file()
    assert (site / "runs" / "fill-2" / REPORT).is_file()
    for name in Registry.installed().hooks.graphs.keys() - {"fill"}:
        assert f"nodegraph run {name}.yaml" in text
        assert (site / "pictures" / f"{name}.svg").is_file()
    assert "nodegraph run fill.yaml" not in text


def test_a_hostile_title_is_text(site: Path) -> None:
    text = (site / "gallery.html").read_text()
    assert "alert(1)" in text
    assert "<script" not in text
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


def test_a_folder_that_is_no_site_is_not_written_to(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "thesis.txt").write_text("of the user")
    assert main(["site", "--out", str(tmp_path)]) == 2
    assert str(tmp_path) in capsys.readouterr().err
    assert len(list(tmp_path.iterdir())) == 1


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


def test_pages_fit_a_phone_and_the_search_finds(
    site: Path, tab: Page, complaints: list[str]
) -> None:
    names = ["index", "gallery", "tutorial", "nodes/fill", "commands", "plugins", "language"]
    for name in names:
        load(tab, site / f"{name}.html", width=390)
        assert tab.evaluate("document.documentElement.scrollWidth") <= 390, name
        if AXE:
            assert violations(tab) == [], name
            complaints.clear()  # it asks for the style sheet, which the page forbids
    load(tab, site / "search.html", width=390)
    tab.fill("#query", "muscle")
    assert tab.text_content("#matches a") == "fill.muscle"
