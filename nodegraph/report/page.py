"""A study as one HTML file that works offline and cannot reach the network."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from html.parser import HTMLParser
from importlib.resources import files
from itertools import groupby
from typing import TYPE_CHECKING
from urllib.parse import quote

from nodegraph.report.notes import note_kinds
from nodegraph.report.study import Section, Study

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup

    from nodegraph.plugin.hook_types import Rendered

SCRIPTS = ("modules", "helpers", "selection", "frames", "tables")
"""The page's own scripts, by the names of their files."""

_SHOWN = 3
_MANY = 24


@dataclass(frozen=True, slots=True)
class Titled:
    """Sections with one title."""

    title: str
    anchor: str
    sections: tuple[Section, ...]


_NO_SERVER = 'nodegraph.define("server", [], () => null);\n'


def page(study: Study, *, server: str = _NO_SERVER) -> str:
    """Return the report of a study.

    The HTML of its sections and its drawing are taken as they are; every other text is escaped.
    The page fetches nothing, and its policy forbids it to: only scripts that were in the trusted
    parts when the page was made may run.

    Parameters
    ----------
    study
    server
        The script that defines the module ``server``, through which other scripts get what is not
        on the page; in a file there is none.
    """
    own = [source(f"{name}.js") for name in SCRIPTS]
    own.append(server)
    leads = [section for section in study.sections if section.rendered.lead]
    first = leads[0] if leads else next(iter(study.sections), None)
    scripts = _once(own, (section.rendered.scripts for section in study.sections))
    styles = _once([source("page.css")], (section.rendered.styles for section in study.sections))
    trusted = [*(section.rendered.html for section in study.sections), study.graph_svg]
    trusted += [section.rendered.lead for section in leads]
    return (
        templates_of("nodegraph.report")
        .get_template("page.html")
        .render(
            study=study,
            first=first,
            replaced=_replaced(study.sections),
            results=titled(shown_first(study.sections)),
            kinds=note_kinds(study),
            notes=_markdown(study.notes_markdown),
            policy=policy(trusted, *scripts, connect=server != _NO_SERVER),
            steps=sum(row.steps for row in study.timings),
            stored=sum(row.stored for row in study.timings),
            shown=_SHOWN,
            many=_MANY,
            scripts=scripts,
            styles=styles,
        )
    )


def standalone_page(rendered: Rendered, title: str) -> str:
    """Return a page of its own for what is shown of a value, to be sent or kept alone.

    Like a report it works offline, follows the reader's colours, and runs no script but those of
    `rendered` and the modules of a report.
    """
    own = [*(source(f"{name}.js") for name in SCRIPTS), _NO_SERVER]
    scripts = _once(own, [rendered.scripts])
    return (
        templates_of("nodegraph.report")
        .get_template("standalone.html")
        .render(
            title=title,
            rendered=rendered,
            policy=policy([rendered.html], *scripts),
            scripts=scripts,
            styles=_once([source("page.css")], [rendered.styles]),
        )
    )


def _replaced(sections: Iterable[Section]) -> set[tuple[str, str]]:
    """Return the nodes and outputs that other sections show too."""
    return {(section.node, output) for section in sections for output in section.rendered.replaces}


def shown_first(sections: Iterable[Section]) -> list[Section]:
    """Return sections with those that have a lead before others of their node."""
    listed = list(sections)
    nodes = list(dict.fromkeys(section.node for section in listed))
    return sorted(listed, key=lambda each: (nodes.index(each.node), not each.rendered.lead))


def _once(own: list[str], of_sections: Iterable[Iterable[str]]) -> list[Markup]:
    """Return the page's own texts and those of its sections, each once."""
    texts = dict.fromkeys([*own, *(text for texts in of_sections for text in texts)])
    return [_trusted(text) for text in texts]


def templates_of(package: str) -> Environment:
    """Return what fills in a package's templates; all that is not marked as trusted is escaped."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader(package, "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"trusted": _trusted, "path": _path, "duration": duration}
    return environment


def source(name: str) -> str:
    """Return a style or a script of the page."""
    return files("nodegraph.report").joinpath("templates", name).read_text(encoding="utf-8")


def _trusted(html: str) -> Markup:
    from markupsafe import Markup

    return Markup(html)


def _path(path: str) -> str:
    """Return a file's path as a link that can only lead to a place beside the report."""
    return "./" + quote(path.replace("\\", "/").lstrip("/"))


def _markdown(text: str) -> Markup:
    """Return notes as HTML; raw HTML and pictures, which could fetch something, stay text."""
    from markdown_it import MarkdownIt

    reader = MarkdownIt("commonmark", {"html": False, "typographer": False})
    return _trusted(reader.enable("table").disable("image").render(text))


def duration(seconds: float) -> str:
    """Return a time as people say it: ``0.3 s``, ``42 s``, ``3 min 20 s``, ``2 h 5 min``."""
    if seconds < 10:
        return f"{seconds:.2g} s" if seconds >= 0.095 else f"{seconds * 1000:.0f} ms"
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


def titled(sections: Iterable[Section]) -> tuple[Titled, ...]:
    """Return sections that follow each other with one title as one."""
    runs = groupby(sections, key=lambda section: section.title)
    return tuple(
        Titled(title, f"result-{number}", tuple(run)) for number, (title, run) in enumerate(runs, 1)
    )


def policy(fragments: Iterable[str], *own: str, connect: bool = False) -> str:
    """Return the content security policy of a page.

    Parameters
    ----------
    fragments : iterable of str
        Trusted HTML, whose scripts may run.
    own : str
        The page's own scripts.
    connect : bool
        Whether they may fetch from the server of the page.
    """
    scripts = dict.fromkeys([*own, *(script for html in fragments for script in _scripts(html))])
    allowed = " ".join(f"'sha256-{_digest(script)}'" for script in scripts) or "'none'"
    rules = ["default-src 'none'", f"script-src {allowed}", "style-src 'unsafe-inline'"]
    rules += ["img-src data: blob:", "media-src data: blob:", "font-src data:"]
    rules += ["base-uri 'none'", "form-action 'none'"]
    rules += ["connect-src 'self'"] * connect
    return "; ".join(rules)


def _digest(script: str) -> str:
    same_line_ends = script.replace("\r\n", "\n").replace("\r", "\n")
    return base64.b64encode(hashlib.sha256(same_line_ends.encode()).digest()).decode()


def _scripts(html: str) -> list[str]:
    if "<script" not in html.lower():
        return []
    reader = _ScriptReader()
    reader.feed(html)
    reader.close()
    return reader.scripts


class _ScriptReader(HTMLParser):
    """Collects what stands in script elements."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=False)
        self.scripts: list[str] = []
        self._inside = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside = tag == "script" and dict(attrs).get("type") != "application/json"
        if self._inside:
            self.scripts.append("")

    def handle_endtag(self, tag: str) -> None:
        self._inside = False

    def handle_data(self, data: str) -> None:
        if self._inside:
            self.scripts[-1] += data
