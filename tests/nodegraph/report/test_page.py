from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from html.parser import HTMLParser
from typing import Any, get_args, get_origin, get_type_hints

import pytest

from nodegraph.draw import Box, Picture, svg
from nodegraph.formatting import duration
from nodegraph.plugin.hook_types import Rendered
from nodegraph.report.notes import note_kinds
from nodegraph.report.page import page, policy
from nodegraph.report.study import (
    AxisRow,
    Link,
    MethodRow,
    NoteSubject,
    Section,
    SettingRow,
    StepNote,
    Study,
    TimingRow,
    numbered,
)

VOID = {"meta", "link", "br", "hr", "img", "input", "rect", "line", "path"}


def study(**fields: Any) -> Study:
    table = Rendered("<figure class='table'><table><caption>Errors</caption></table></figure>")
    links = (Link("CSV", "table.csv"),)
    return Study("A title", sections=(Section("table", table, "k=3", links),), **fields)


def refusals(count: int) -> tuple[StepNote, ...]:
    reason = "needs one complete frame"
    return tuple(
        StepNote(
            "fill (fill.guenter)", f"fill=guenter, trial={number}", reason, NoteSubject.REFUSED
        )
        for number in range(count)
    )


def timings() -> tuple[TimingRow, ...]:
    return (TimingRow("gaps", 3, 0.5, 0.3), TimingRow("fill", 1, 130.0, 130.0))


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
            # what is trusted, and what a paper says where the page says more
            drawings = dict.fromkeys(("graph_svg", "graph_unfolded_svg"), "<svg></svg>")
            trusted = {**drawings, "in_print": "by name"}
            if kind is Section:  # by these the page arranges sections
                trusted |= {"node": "table", "output": "figure", "question": ""}
                trusted["labels"] = f"k={self.text()}"
            return kind(
                **{
                    field.name: trusted[field.name]
                    if field.name in trusted
                    else self.make(hints[field.name])
                    for field in fields(kind)
                }
            )
        if kind == bool | None:
            return True
        if kind is bool:
            return False
        if kind is NoteSubject:
            return NoteSubject.FAILED
        if get_origin(kind) is tuple:
            return tuple(
                self.make(argument) for argument in get_args(kind) if argument is not Ellipsis
            )
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


def test_every_text_is_shown_and_none_is_run() -> None:
    hostile = Hostile()
    read = Page(page(hostile.make(Study)))
    shown = read.text
    links = [tag["href"] for tag in read.all("a")]
    paths = [link for link in links if link.startswith("./")]
    assert len(hostile.texts) > 40
    assert len(paths) == 3
    for number, text in enumerate(hostile.texts):
        in_path = any(f"alert%28{number}%29" in path for path in paths)
        assert in_path or text in shown, f"text {number} is not shown as it is"
    plain = Page(page(Study("A title")))
    assert len(list(read.all("script"))) == len(list(plain.all("script"))) > 0
    assert not list(read.all("img"))
    assert not [name for _, attributes in read.tags for name in attributes if name.startswith("on")]


def test_all_of_a_study_is_in_its_page() -> None:
    settings = (SettingRow("length", "5, 15", "frames", meaning="How long a gap is."),)
    whole = study(
        answer=("muscle is best.", "lin comes second."),
        notes_markdown="Which method **restores** markers?\n\n| a | b |\n|---|---|\n| 1 | 2 |",
        graph_svg=svg(Picture("drawn", (Box("capture"),))),
        axes=(
            AxisRow("trial", tuple(str(number) for number in range(100))),
            AxisRow("k", ("3", "5")),
        ),
        inputs=(SettingRow("recording", "sample:face"),),
        known=("face.neutral",),
        methods=(
            MethodRow(
                "gaps",
                "gaps.cut",
                "Hide samples.",
                "",
                settings,
                "Nobody (2001).",
                declared=("adapted from Nobody 2001: less", "look-ahead 3 frames"),
            ),
        ),
        notes=refusals(3),
        timings=timings(),
        seconds=131.0,
        versions=(("numpy", "2.1.3"),),
        seeds=(("gaps", "0, 1"),),
        command="nodegraph run fill.yaml",
        graph_file="fill.yaml",
        graph_text="nodegraph: 1\n",
        created="today",
        machine="a computer",
    )
    html = page(whole)
    read = Page(html)
    texts = [*whole.answer, "4 steps done in 2 min 11 s", "3 refused", "Errors", "drawn"]
    texts += ["sample:face", "0 \u2026 99", "3, 5", "face.neutral", "Hide samples."]
    texts += ["Adapted from Nobody 2001: less; look-ahead 3 frames."]
    texts += ["5, 15 frames", "How long a gap is.", "Nobody (2001).", "numpy", "2.1.3", "0, 1"]
    texts += [whole.command, whole.graph_text, whole.graph_file, whole.created, whole.machine]
    for text in texts:
        assert text in read.text, text
    assert "<strong>restores</strong>" in html
    order = [html.index(text) for text in ("muscle is best", "Errors", "restores", "drawn</title>")]
    order += [html.index(f'id="{part}"') for part in ("settings", "reproduce", "download")]
    assert order == sorted(order)


def test_what_happened_to_thousands_is_folded_but_whole() -> None:
    read = Page(page(study(notes=refusals(5000))))
    assert "5000 refused" in read.text
    assert read.text.count("needs one complete frame") == 1
    assert "5000 combinations" in read.text
    assert "trial=4999" in read.text
    folded = [index for index, (tag, _) in enumerate(read.tags) if tag == "details"]
    listed = [
        index for index, (_, tag) in enumerate(read.tags) if tag.get("class") == "combinations"
    ]
    assert folded[0] < listed[0]


def test_warnings_that_differ_in_numbers_are_of_one_kind() -> None:
    gaps = [
        StepNote("fill", f"k={k}", f"{k} gaps of m1 open", NoteSubject.WARNING) for k in range(60)
    ]
    slow = [StepNote("fill", f"k={k}", "slow", NoteSubject.WARNING) for k in range(60)]
    read = Page(page(study(notes=(*gaps, *slow))))
    assert "2 kinds of warnings in 60 steps" in read.text
    assert "… gaps of … open" in read.text
    assert "k=59: 59 gaps of m1 open" in read.text
    assert "1 kind of warning in 60 steps" in Page(page(study(notes=tuple(slow)))).text
    assert "2 warnings" in Page(page(study(notes=(gaps[3], slow[3])))).text
    assert "3 gaps of m1 open" in Page(page(study(notes=(gaps[3],)))).text


def warned(method: str, reason: str, matters: bool | None = None) -> StepNote:
    labels = f"fill={method}"
    return StepNote(
        "fill", labels, reason, NoteSubject.WARNING, method=f"fill.{method}", matters=matters
    )


def test_warnings_of_methods_with_one_template_are_one_kind() -> None:
    notes = (
        warned("akima", "3 samples of 2 markers left open: brow, chin", matters=True),
        warned("linear", "4 samples of 1 markers left open: nose", matters=True),
        warned("cubic", "12 samples of 9 markers left open: lip, jaw, and 7 more", matters=True),
        warned("cubic", "'beta_1' did not settle"),
    )
    kinds = note_kinds(study(notes=notes))
    first, second = kinds[0].groups
    assert first.reason == "… samples of … markers left open: …"
    assert (first.where, first.count) == ("fill (akima, linear, cubic)", 3)
    assert first.labels[1] == "fill=linear: 4 samples of 1 markers left open: nose"
    assert (second.where, second.reason) == ("fill (fill.cubic)", notes[-1].reason)
    text = Page(page(study(notes=notes))).text
    assert "2 kinds of warnings in 3 steps; 1 touches the numbers" in text
    assert text.count("touches the numbers") == 2


def test_a_method_is_described_once_and_equal_settings_too() -> None:
    ends = SettingRow("ends", "met", default=False, meaning="Whether ``ends`` are met.")
    reach = SettingRow("reach", "3", "frames", default=True, meaning="How far it looks.")
    rows = [
        MethodRow("fill", "fill.linear", "Draw `lines`.", "linear", (ends, reach)),
        MethodRow("fill", "fill.cubic", "Draw curves.", "cubic", (ends,)),
        MethodRow("again", "fill.linear", "Draw `lines`.", "", (ends, reach)),
    ]
    html = page(study(methods=tuple(rows)))
    text = Page(html).text
    assert html.count("Draw <code>lines</code>.") == 1
    assert html.count("Whether <code>ends</code> are met.") == 1
    assert "fill=linear" in text
    assert "again" in text
    assert text.index("ends met") < text.index("1 setting at its default") < text.index("reach 3")


def test_a_failure_says_how_to_repeat_it_and_where_it_happened() -> None:
    note = StepNote(
        "fill", "k=3", "ValueError: no", NoteSubject.FAILED, repeat="run --only k=3", trace="L 1"
    )
    read = Page(page(study(notes=(note,))))
    for text in ("1 failed", "ValueError: no", "k=3", "run --only k=3", "L 1"):
        assert text in read.text


def test_a_run_without_notes_says_so() -> None:
    assert "No step failed, was refused, was left out, or gave a warning." in page(study())


def test_what_several_results_bring_stands_in_the_page_once() -> None:
    def section(html: str, *scripts: str) -> Section:
        return Section("playing", Rendered(html, scripts=scripts, styles=("p { color: red; }",)))

    sections = (section("<p>1</p>", "one(1 < 2);"), section("<p>2</p>", "one(1 < 2);", "two();"))
    html = page(Study("Many", sections=sections))
    read = Page(html)
    scripts = [text.strip() for tag, text in read.texts if tag == "script"]
    assert scripts[-2:] == ["one(1 < 2);", "two();"]
    assert len(set(scripts)) == len(scripts)
    assert html.count("p { color: red; }") == 1
    rule = next(tag["content"] for tag in read.all("meta") if "http-equiv" in tag)
    assert rule.count("'sha256-") == len(scripts)
    assert html.index("<p>2</p>") < html.index("one(1 < 2);")


@pytest.mark.parametrize("fields", [{"scripts": ("a('</SCRIPT>')",)}, {"styles": ("</style x>",)}])
def test_what_would_end_itself_in_a_page_is_refused(fields: Any) -> None:
    with pytest.raises(ValueError, match="in a page must not contain </s"):
        Rendered("<p>x</p>", **fields)


def test_a_study_without_results_says_so() -> None:
    assert "No step that the report shows has a result" in page(Study("Nothing"))


def test_one_title_is_one_result_and_many_labels_fold() -> None:
    sections = tuple(Section("curve", Rendered("<p>x</p>"), f"k={k}") for k in range(6))
    html = page(Study("Many", sections=sections))
    assert html.count('<section class="result"') == 1
    assert html.count('<details class="fold">') == 3
    assert all(f"k {k}" in html for k in range(6))


def test_tables_and_figures_have_numbers_and_captions() -> None:
    def section(title: str, kind: Any, **fields: Any) -> Section:
        replaces = fields.pop("replaces", ())
        lead = "<p>lead</p>" if replaces else ""
        rendered = Rendered("<p>x</p>", kind=kind, replaces=replaces, lead=lead, title="Own")
        return Section(title, rendered, **fields)

    sections = numbered(
        [
            section("A", "table", node="a", output="table", caption="In words."),
            section("A", "figure", node="a", output="figure", files=(Link("SVG", "a.svg"),)),
            section("A", "", node="a", output="overview", replaces=("figure",)),
            section("B", "figure", node="b"),
            section("C", "table", node="c"),
        ]
    )
    assert [each.number for each in sections] == ["", "Table 1", "", "Figure 1", "Table 2"]
    text = " ".join(Page(page(Study("Many", sections=sections))).text.split())
    assert "Table 1. In words." in text
    assert "Figure 1. Own" in text
    assert "drawn for print: SVG" in text
    assert "More results B" in text


def test_notes_stand_beside_the_answer_or_the_figure_once_and_as_safe_markdown() -> None:
    notes = "*Why* so <script>alert(1)</script>, ![x](http://evil.example/x.png)"
    lead = Rendered("<p>table</p>", lead="<p>cards</p>", kind="table")
    figure = Rendered("<p>figure</p>", kind="figure")
    sections = numbered(
        [
            Section("A", figure, node="a", output="figure", notes_markdown=notes),
            Section("A", lead, node="a", output="table", notes_markdown=notes),
            Section("B", figure, node="b", notes_markdown="Other [words](javascript:x)"),
        ]
    )
    html = page(Study("Noted", sections=sections))
    assert html.count('<aside class="prose noted"') == 2
    answer = html.partition('<section class="answer')[2].partition("</section>")[0]
    assert answer.index("cards") < answer.index("<em>Why</em> so &lt;script&gt;")
    beside = html.partition("Other ")[2].partition("</section>")[0]
    assert beside.index("</aside>") < beside.index("figure")
    assert "javascript:x" not in [tag.get("href") for tag in Page(html).all("a")]
    assert not list(Page(html).all("img"))


def test_nothing_is_fetched_and_the_policy_forbids_it() -> None:
    notes = "![a](http://evil.example/x.png) <img src=http://evil.example/y> [b](javascript:c)"
    read = Page(page(study(notes_markdown=notes)))
    rules = next(tag["content"] for tag in read.all("meta") if "http-equiv" in tag)
    assert rules.startswith("default-src 'none'; script-src 'sha256-")
    assert "http" not in rules
    for _, attributes in read.tags:
        assert not re.match(r"https?:|//|javascript:", attributes.get("src", ""))
    assert [tag["href"] for tag in read.all("link")] == ["data:,"]
    assert not [tag for tag in read.all("a") if tag["href"].startswith("javascript")]
    style = "".join(text for tag, text in read.texts if tag == "style")
    assert not re.search(r"url\(|@import", style)


def test_it_can_be_read_without_eyes() -> None:
    read = Page(page(study(notes=refusals(2), timings=timings())))
    tags = [tag for tag, _ in read.tags]
    assert [tags.count(value) for value in ("header", "nav", "main", "h1")] == [1, 1, 1, 1]
    assert next(read.all("html"))["lang"] == "en"
    assert all("scope" in tag for tag in read.all("th"))
    ids = [tag["id"] for _, tag in read.tags if "id" in tag]
    assert len(ids) == len(set(ids))
    for link in read.all("a"):
        assert not link["href"].startswith("#") or link["href"][1:] in ids
    for _, attributes in read.tags:
        assert attributes.get("aria-labelledby", ids[0]) in ids


def test_a_file_beside_the_page_stays_beside_it() -> None:
    html = page(study())
    assert '<a href="./table.csv">CSV</a>' in html


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0 ms"),
        (0.0123, "12 ms"),
        (0.3, "0.3 s"),
        (9.84, "9.8 s"),
        (42.4, "42 s"),
        (200, "3 min 20 s"),
        (59.7, "1 min 0 s"),
        (7500, "2 h 5 min"),
    ],
)
def test_durations(seconds: float, text: str) -> None:
    assert duration(seconds) == text


def digest(script: str) -> str:
    return base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()


def test_scripts_of_trusted_parts_are_allowed_once_each() -> None:
    parts = [
        "<p>no</p>",
        "<SCRIPT>a &amp; b < c</SCRIPT>",
        "<script>own()</script>",
        "<script>d\r\n</script>",
    ]
    rules = dict(value.split(" ", 1) for value in policy(parts, "own()").split("; "))
    expected = [digest(value) for value in ("own()", "a &amp; b < c", "d\n")]
    assert rules["script-src"] == " ".join(f"'sha256-{script}'" for script in expected)
    assert rules["default-src"] == "'none'"


def test_text_that_only_looks_like_a_script_is_not_allowed() -> None:
    assert policy(
        ["&lt;script>a()&lt;/script>", "<b title='<script>a()</script>'>"], "own()"
    ) == policy([], "own()")
