"""All files of the site, by their paths."""

from __future__ import annotations

import json
from argparse import ArgumentParser
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

from nodegraph.graphfile.schema import graph_schema
from nodegraph.plugin.registry import Registry
from nodegraph.report.page import templates_of
from nodegraph.site.commands import command_page
from nodegraph.site.gallery import gallery, read_runs, run_files
from nodegraph.site.language import SCHEMA, language_page
from nodegraph.site.nodes import node_pages
from nodegraph.site.page import Page
from nodegraph.site.plugins import plugin_page
from nodegraph.site.prose import markdown_page

INDEX = "search-index.js"
"""A file that every site has, and no other folder."""

_PICTURE = "report.png"
"""Beside a plugin's graphs: the picture of a report."""

_PARTS = {
    "gallery.html": "Gallery",
    "tutorial.html": "Tutorial",
    "statistics.html": "Statistics",
    "nodes.html": "Nodes",
    "commands.html": "Commands",
    "language.html": "Graph files",
    "plugins.html": "Plugins",
    "search.html": "Search",
}
_SEARCH = """<h1>Search</h1>
<label for="query">A node, command, key, hook or study</label>
<input id="query" type="search" autocomplete="off" autofocus>
<p id="count" role="status"></p>
<ul id="matches"></ul>
<noscript><p>The search needs JavaScript; all pages work without.</p></noscript>"""
_STYLE, _SCRIPT = "site.css", "search.js"


class Contents(NamedTuple):
    """The files of a site: those that are generated, and those that are copied."""

    generated: dict[str, bytes]
    copied: dict[str, Path]


def site_files(
    registry: Registry, parsers: Mapping[str, ArgumentParser], folders: Iterable[Path]
) -> Contents:
    """Return the files of a site.

    Its links are relative, it loads nothing from elsewhere, and its pages forbid that to
    themselves.

    Parameters
    ----------
    registry
        The nodes, graphs and hooks that it documents.
    parsers
        The arguments of the commands, by their names.
    folders
        Runs whose reports it shows.

    Raises
    ------
    NodegraphError
        If a folder holds no run that can be read.
    """
    runs = read_runs(folders)
    studies, pictures = gallery(registry, runs)
    copied = run_files(runs)
    beside = (path.with_name(_PICTURE) for path in registry.hooks.graphs.values())
    if picture := next((path for path in beside if path.is_file()), None):
        copied[_PICTURE] = picture
    pages = [
        _start(_PICTURE if picture else ""),
        studies,
        *map(markdown_page, ("tutorial", "reproduce", "live", "clusters", "statistics")),
        *node_pages(registry),
        command_page(parsers),
        language_page(),
        plugin_page(),
    ]
    generated = {page.path: _html(page) for page in pages} | pictures
    generated["search.html"] = _html(Page("search.html", "Search", _SEARCH), script=True)
    generated[INDEX] = f"const ENTRIES = {json.dumps(list(_index(pages)))};\n".encode()
    for name in (_STYLE, _SCRIPT):
        generated[name] = files("nodegraph.site").joinpath("templates", name).read_bytes()
    generated[SCHEMA] = json.dumps(graph_schema(registry), separators=(",", ":")).encode()
    return Contents(generated, copied)


def _start(picture: str) -> Page:
    """Return the first page, with a picture below its sentence."""
    page = markdown_page("index")
    image = f'<img class="start" src="{picture}" alt="The top of a report">'
    sentence, mark, rest = page.body.partition("</p>")
    return replace(page, body=f"{sentence}{mark}{image if picture else ''}{rest}")


def _html(page: Page, *, script: bool = False) -> bytes:
    up = "../" * page.path.count("/")
    template = templates_of("nodegraph.site").get_template("page.html")
    html = template.render(
        page=page, up=up, parts=_PARTS, style=_STYLE, scripts=(INDEX, _SCRIPT) if script else ()
    )
    # a docstring, or an answer that names a file, may hold what is not valid text
    return html.encode(errors="backslashreplace")


def _index(pages: Iterable[Page]) -> Iterator[tuple[str, str, str, str]]:
    """Yield the entries of the search: name, sentence, address, title of the page."""
    for page in pages:
        yield page.title, "", page.path, ""
        for entry in page.entries:
            yield entry.name, entry.text, f"{page.path}#{entry.anchor}", page.title
