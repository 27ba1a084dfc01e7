"""Markdown pages and numpydoc docstrings as HTML, in which nothing but text is taken over."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence
from html import escape
from importlib.resources import files
from itertools import pairwise

from nodegraph.site.page import Entry, Page

_SECTION = re.compile(r"^([A-Z][\w ]*)\n-{3,}\n", re.MULTILINE)
_LITERAL = re.compile(r"``(.+?)``|`([^`]+)`", re.DOTALL)
_FORMULA = re.compile(r"[=^<|]|\bsum\b|\bsqrt\b|[\w)] [-+*/] [\w(]")
_FOOTNOTE = re.compile(r"^\.\. \[(\w+)\] ", re.MULTILINE)
_FOOTNOTE_MARK = re.compile(r"\[(\d+)\]_")
_ITEM = re.compile(r"^(?:- |\d+\. )", re.MULTILINE)
_RULES = re.compile(r"^(?:=+ +)+=+$")
_SYMBOLS = {
    "&lt;=": "&le;",
    "&gt;=": "&ge;",
    " - ": " &minus; ",
    "sum(": "&Sigma;(",
    "sum ": "&Sigma; ",
    "sqrt": "&radic;",
}
# what scrolls sideways can be reached by keyboard
_CODE, _WIDE = '<pre tabindex="0">', '<div class="wide" tabindex="0">'
_GREEK = ("pi", "sigma", "lambda", "alpha", "theta", "mu")


def markdown_page(name: str) -> Page:
    """Return a page from ``pages/NAME.md``, whose headings the search finds."""
    text = files("nodegraph.site").joinpath("pages", f"{name}.md").read_text(encoding="utf-8")
    body, headings = _markdown(text)
    title = headings[0].name
    return Page(f"{name}.html", title, body, tuple(headings))


def _markdown(text: str) -> tuple[str, list[Entry]]:
    """Return HTML with anchors at its headings, and the headings; raw HTML stays text."""
    from markdown_it import MarkdownIt

    reader = MarkdownIt("commonmark", {"html": False}).enable("table").disable("image")
    tokens = reader.parse(text)
    headings = []
    for token, content in pairwise(tokens):
        if token.type == "heading_open":
            headings.append(Entry(plain(content.content), "", anchor_of(content.content)))
            token.attrSet("id", headings[-1].anchor)
        for child in content.children or ():
            target = str(child.attrGet("href") or "")
            if child.type == "link_open" and "://" not in target:
                child.attrSet("href", re.sub(r"\.md(?=#|$)", ".html", target))
    html: str = reader.renderer.render(tokens, reader.options, {})
    for text, focusable in (
        ("<table>", f"{_WIDE}<table>"),
        ("</table>", "</table></div>"),
        ("<pre>", _CODE),
    ):
        html = html.replace(text, focusable)
    return html, headings


def plain(text: str) -> str:
    """Return a line of Markdown without its marks."""
    return re.sub(r"[`*]", "", text)


def anchor_of(text: str) -> str:
    """Return a heading as the end of a link: ``run-it-again``."""
    return re.sub(r"[^\w.]+", "-", plain(text).lower()).strip("-")


def docstring_html(doc: str) -> tuple[str, str]:
    """Return a numpydoc docstring as HTML: what it says first, then its sections.

    The section of parameters is left out.
    """
    lead, *rest = _SECTION.split(doc.strip())
    sections = [
        f'<p class="part">{escape(title)}</p>\n{_section(title, content)}'
        for title, content in zip(rest[::2], rest[1::2], strict=True)
        if title != "Parameters"
    ]
    return blocks_html(lead), "\n".join(sections)


def _section(title: str, content: str) -> str:
    if title == "Examples":
        return code_html(textwrap.dedent(content).strip())
    if title == "References":
        _, *notes = _FOOTNOTE.split(content)
        items = (f"<li>{inline_html(text)}</li>" for text in notes[1::2])
        return f"<ol>{''.join(items)}</ol>"
    return f"<dl>{''.join(_definitions(content))}</dl>"


def _definitions(content: str) -> Iterator[str]:
    """Yield the terms of a section, each with the indented text below it."""
    for term, text in re.findall(r"^(\S.*)\n((?:(?:[ \t]+.*)?\n?)*)", f"{content}\n", re.MULTILINE):
        yield f"<dt><code>{escape(term)}</code></dt>"
        if text.strip():
            yield f"<dd>{blocks_html(textwrap.dedent(text))}</dd>"


def blocks_html(text: str) -> str:
    """Return paragraphs, lists, ruled tables and indented code as HTML."""
    blocks = re.split(r"\n[ \t]*\n|(?<=:)\n(?=  )", text.strip("\n"))
    return "\n".join(_block(block) for block in blocks if block.strip())


def _block(block: str) -> str:
    lines = block.splitlines()
    if any(_RULES.match(line) for line in lines) or all(line.startswith("  ") for line in lines):
        return code_html(textwrap.dedent(block))
    if _ITEM.match(block):
        items = (inline_html(item) for item in _ITEM.split(block) if item.strip())
        return f"<ul>{''.join(f'<li>{item}</li>' for item in items)}</ul>"
    return f"<p>{inline_html(block)}</p>"


def code_html(code: str) -> str:
    """Return lines of code."""
    return f"{_CODE}<code>{escape(code)}</code></pre>"


def inline_html(text: str) -> str:
    """Return text with its literals as code, and those that are formulas as formulas."""
    html, end = "", 0
    for match in _LITERAL.finditer(text):
        html += _words(text[end : match.start()])
        end = match.end()
        literal = " ".join((match[1] or match[2]).split())
        is_formula = match[1] and " " in literal and _FORMULA.search(literal)
        html += formula_html(literal) if is_formula else f"<code>{escape(literal)}</code>"
    return html + _words(text[end:])


def _words(text: str) -> str:
    return _FOOTNOTE_MARK.sub(r"<sup>\1</sup>", escape(text))


def formula_html(formula: str) -> str:
    """Return a formula as it is written in documentation with raised and lowered characters."""
    html = escape(formula, quote=False)
    for text, symbol in _SYMBOLS.items():
        html = html.replace(text, symbol)
    for name in _GREEK:
        html = re.sub(rf"\b{name}\b(?!\()", f"&{name};", html)
    html = re.sub(r"\^(?:\{([^}]*)\}|\(([^()]*)\)|(-?\w+))", _raised, html)
    html = re.sub(r"\b([A-Za-z]'?)_(?:\{([^}]*)\}|(\w+))", _lowered, html)
    return f'<span class="formula">{html}</span>'


def _raised(match: re.Match[str]) -> str:
    return f"<sup>{match[1] or match[2] or match[3]}</sup>"


def _lowered(match: re.Match[str]) -> str:
    return f"{match[1]}<sub>{match[2] or match[3]}</sub>"


def table(head: tuple[str, ...], rows: Sequence[tuple[object, ...]]) -> str:
    """Return a table; cells are HTML."""
    if not rows:
        return ""
    top = "".join(f'<th scope="col">{escape(name)}</th>' for name in head)
    body = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows)
    return f"{_WIDE}<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>"
