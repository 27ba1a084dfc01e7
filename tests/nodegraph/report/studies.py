"""Studies to test the report with, and a reader for its HTML."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from html.parser import HTMLParser
from typing import Any, Literal, get_args, get_origin, get_type_hints

from nodegraph.hooks import Rendered
from nodegraph.report import Link, Section, StepNote, Study, TimingRow

TABLE = (
    '<figure class="table"><table class="sortable"><caption>Errors</caption><thead><tr>'
    '<th scope="col">method</th><th scope="col" class="number">rmse [mm]</th></tr></thead><tbody>'
    '<tr><td>muscle</td><td class="number">10</td></tr>'
    '<tr><td>refused</td><td class="number"></td></tr>'
    '<tr><td>lin</td><td class="number">9.5 \u00b1 0.2</td></tr>'
    '<tr><td>guenter</td><td class="number">\u22121e-3</td></tr>'
    "</tbody></table></figure>"
)
VOID = {"meta", "link", "br", "hr", "img", "input", "rect", "line", "path"}


def study(html: str = TABLE, **fields: Any) -> Study:
    links = (Link("CSV", "table.csv"),)
    return Study("A title", sections=(Section("table", Rendered(html), "k=3", links),), **fields)


def refusals(count: int) -> tuple[StepNote, ...]:
    reason = "needs one complete frame"
    return tuple(
        StepNote("fill (fill.guenter)", f"fill=guenter, trial={one}", reason, "refused")
        for one in range(count)
    )


def timings() -> tuple[TimingRow, ...]:
    return (TimingRow("gaps", 2, 1, 0.5, 0.3), TimingRow("fill", 1, 0, 130.0, 130.0))


class Hostile:
    """Fills every text of a dataclass with markup, each with a number of its own."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def text(self) -> str:
        number = len(self.texts)
        self.texts.append(f"<script>alert({number})</script><img src=x onerror='a'>\"&{number};")
        return self.texts[-1]

    def make(self, kind: Any) -> Any:
        if kind is Rendered:
            return Rendered("", self.text())
        if is_dataclass(kind) and isinstance(kind, type):
            hints = get_type_hints(kind)
            trusted = {"graph_svg": "<svg></svg>"}
            return kind(
                **{
                    one.name: trusted.get(one.name) or self.make(hints[one.name])
                    for one in fields(kind)
                }
            )
        if get_origin(kind) is Literal:
            return get_args(kind)[0]
        if get_origin(kind) is tuple:
            return tuple(self.make(one) for one in get_args(kind) if one is not Ellipsis)
        return self.text() if kind is str else kind(1)


class Page(HTMLParser):
    """Reads a page strictly: every tag must be closed, in order."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str]]] = []
        self.texts: list[tuple[str, str]] = []
        self.feed(html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, {name: value or "" for name, value in attrs}))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, {name: value or "" for name, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append((self.open[-1] if self.open else "", data))

    def all(self, tag: str) -> Iterator[dict[str, str]]:
        return (attributes for name, attributes in self.tags if name == tag)

    @property
    def text(self) -> str:
        return "".join(text for tag, text in self.texts if tag not in ("style", "script"))
