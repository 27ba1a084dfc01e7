"""A study as one HTML file that works offline and cannot reach the network."""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from html.parser import HTMLParser
from importlib.resources import files
from itertools import groupby
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from nodegraph.formatting import duration
from nodegraph.report.descriptions import descriptions, shared_meanings
from nodegraph.report.facts import fold_facts, head_facts
from nodegraph.report.notes import note_kinds
from nodegraph.report.paper_texts import printed
from nodegraph.report.study import NoteSubject, Section, Study

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup

    from nodegraph.plugin.hook_types import Rendered

SCRIPTS = ("modules", "helpers", "selection", "theme", "frames", "tables")
"""The page's own scripts, by the names of their files."""

_SHOWN = 3
_OPEN = 2
"""Results that are not folded; beside one that answers at a glance, that one alone."""

_MANY = 24
_LONGEST_REASON = 120
"""Characters of a warning's line; what is longer is folded."""

_CODE = re.compile(r":[a-z:]+:`~?([^`]+)`|``([^`]+)``|`([^`]+)`")


@dataclass(frozen=True, slots=True)
class Titled:
    """Sections with one title."""

    title: str
    anchor: str
    sections: tuple[Section, ...]

    @property
    def has_lead(self) -> bool:
        """Whether one of them answers at a glance."""
        return any(section.rendered.lead for section in self.sections)


@dataclass(frozen=True, slots=True)
class _Question:
    """A question: what answers it in each run, and the results."""

    title: str
    anchor: str
    leads: tuple[Section, ...]
    results: tuple[Titled, ...]

    @property
    def open(self) -> int:
        """Number of results that are not folded."""
        return 1 if any(result.has_lead for result in self.results[:1]) else _OPEN


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
    shown = [section.rendered for section in study.sections]
    scripts = [source(f"{name}.js") for name in (*SCRIPTS, "graph")]
    trusted = [each.html for each in shown]
    trusted += [study.graph_svg, study.graph_unfolded_svg]
    trusted += [each.lead for each in shown]
    described, kinds = descriptions(study.methods), note_kinds(study)
    shared = shared_meanings(described)
    return filled(
        "nodegraph.report",
        "page.html",
        scripts=[*scripts, server, *(script for each in shown for script in each.scripts)],
        styles=[style for each in shown for style in each.styles],
        trusted=trusted,
        rules={} if server == _NO_SERVER else {"connect-src": "'self'"},
        title=study.title,
        study=study,
        questions=_questions(study),
        facts=head_facts(study),
        about=fold_facts(study),
        methods=described,
        shared=shared,
        shared_texts={(setting.name, setting.meaning) for setting in shared},
        kinds=kinds,
        printed=printed(study),
        failed=any(kind.kind is NoteSubject.FAILED for kind in kinds),
        stored=sum(row.stored for row in study.timings),
        shown=_SHOWN,
        many=_MANY,
        longest=_LONGEST_REASON,
    )


def standalone_page(rendered: Rendered, title: str) -> str:
    """Return a page of its own for what is shown of a value, to be sent or kept alone.

    Like a report it works offline, follows the reader's colours, and runs no script but those of
    `rendered` and the modules of a report.
    """
    scripts = [source(f"{name}.js") for name in SCRIPTS]
    return filled(
        "nodegraph.report",
        "standalone.html",
        scripts=[*scripts, _NO_SERVER, *rendered.scripts],
        styles=rendered.styles,
        trusted=[rendered.html],
        title=title,
        rendered=rendered,
    )


def filled(
    package: str,
    template: str,
    *,
    scripts: Iterable[str],
    styles: Iterable[str] = (),
    trusted: Iterable[str] = (),
    rules: Mapping[str, str] | None = None,
    **context: Any,
) -> str:
    """Return a page from a template of a package that extends ``document.html``.

    Parameters
    ----------
    package, template
    scripts, styles
        Each stands on the page once; the styles after that of a report.
    trusted
        HTML in the context whose scripts may run.
    rules
        See `policy`.
    **context
        What the template names.
    """
    scripts = list(dict.fromkeys(scripts))
    return from_template(
        package,
        template,
        policy=policy(trusted, *scripts, rules=rules),
        scripts=scripts,
        styles=dict.fromkeys([source("page.css"), *styles]),
        **context,
    )


def _questions(study: Study) -> list[_Question]:
    """Return the questions of a study, one unless it is of several unlike runs.

    What answers a question is the first lead of each run, or else its first sentences.
    """
    titles = list(dict.fromkeys(section.question for section in study.sections)) or [""]
    questions = []
    for number, title in enumerate(titles, 1):
        sections = [section for section in study.sections if section.question == title]
        leads = []
        for run in dict.fromkeys(section.run for section in sections):
            of_run = [section for section in sections if section.run == run]
            answering = [section for section in of_run if section.rendered.lead] or [
                section for section in of_run[:1] if section.rendered.answer
            ]
            leads += answering[:1]
        results = titled(sections, f"result-{number}" if len(titles) > 1 else "result")
        questions.append(_Question(title, f"question-{number}", tuple(leads), results))
    return questions


def from_template(package: str, template: str, **context: Any) -> str:
    """Return a template of a package, filled in."""
    return _templates_of(package).get_template(template).render(**context)


@cache  # a template takes longer to compile than to fill in
def _templates_of(package: str) -> Environment:
    """Return the template engine of a package; text not marked as trusted is escaped.

    They may extend those of a report, such as ``document.html``.
    """
    from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

    packages = dict.fromkeys([package, "nodegraph.report"])
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(each, "templates") for each in packages]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "trusted": _trusted,
        "path": _path,
        "duration": duration,
        "inline": _inline,
        "markdown": _markdown,
    }
    return environment


def source(name: str, package: str = "nodegraph.report") -> str:
    """Return a style or a script of the pages of a package."""
    return files(package).joinpath("templates", name).read_text(encoding="utf-8")


def _trusted(html: str) -> Markup:
    from markupsafe import Markup

    return Markup(html)


def _path(path: str) -> str:
    """Return a file's path as a link that can only lead to a place beside the report."""
    return "./" + quote(path.replace("\\", "/").lstrip("/"))


def _inline(text: str) -> Markup:
    """Return a sentence of a documentation, in which names and values stand as code."""
    from markupsafe import escape

    def code(match: re.Match[str]) -> str:
        return f"<code>{next(filter(None, match.groups()))}</code>"

    return _trusted(_CODE.sub(code, str(escape(text))))


def _markdown(text: str) -> Markup:
    """Return notes as HTML; raw HTML and pictures, which could fetch something, stay text."""
    from markdown_it import MarkdownIt

    reader = MarkdownIt("commonmark", {"html": False, "typographer": False})
    return _trusted(reader.enable("table").disable("image").render(text))


def titled(sections: Iterable[Section], anchor: str = "result") -> tuple[Titled, ...]:
    """Return sections that follow each other with one title as one."""
    runs = groupby(sections, key=lambda section: section.title)
    return tuple(
        Titled(title, f"{anchor}-{number}", tuple(run))
        for number, (title, run) in enumerate(runs, 1)
    )


def policy(fragments: Iterable[str], *own: str, rules: Mapping[str, str] | None = None) -> str:
    """Return the content security policy of a page.

    Parameters
    ----------
    fragments : iterable of str
        Trusted HTML, whose scripts may run.
    own : str
        The page's own scripts.
    rules : mapping of str to str
        Others than those of a report, which fetches nothing: ``{"connect-src": "'self'"}``.
    """
    scripts = dict.fromkeys([*own, *(script for html in fragments for script in _scripts(html))])
    allowed = " ".join(f"'sha256-{_digest(script)}'" for script in scripts) or "'none'"
    known = {"default-src": "'none'", "script-src": allowed, "style-src": "'unsafe-inline'"}
    known |= {"img-src": "data: blob:", "media-src": "data: blob:", "font-src": "data:"}
    known |= {"base-uri": "'none'", "form-action": "'none'", **(rules or {})}
    return "; ".join(f"{name} {value}" for name, value in known.items())


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
