"""Checks of stored HTML and scripts, which may be another person's, before a page holds them."""

from __future__ import annotations

import re
import sys
from contextlib import suppress
from dataclasses import replace
from functools import cache
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path

from nodegraph.plugin.hook_types import Rendered
from nodegraph.plugin.hooks import GROUP

_PART = re.compile(
    r"[^<]++"
    r'|<script type="application/json" id="[^"<>]*+">[^<]*+</script>'
    r"|<!--[^<>]*?-->"
    r"|<style>(?P<style>[^<]*+)</style>"
    r"|<(?P<end>/?)(?P<name>[a-z][a-z0-9:]*+)"
    r"(?:[ \t\n\f\r]++[^ \t\n\f\r\"'<>/=]++"
    r"(?:=(?:\"[^\"]*+\"|'[^']*+'|[^ \t\n\f\r\"'<>=`]++))?+)*+[ \t\n\f\r]*+(?P<empty>/?)>",
    re.IGNORECASE | re.ASCII,
)
"""Text, data, a remark, a style sheet, or the beginning or the end of an element."""

_VOID = {"br", "col", "hr", "img", "input", "wbr"}
_HTML = {
    *("a", "abbr", "article", "aside", "b", "blockquote", "button", "canvas", "caption", "cite"),
    *("code", "colgroup", "dd", "del", "details", "dfn", "div", "dl", "dt", "em", "figcaption"),
    *("figure", "footer", "h1", "h2", "h3", "h4", "h5", "h6", "header", "i", "ins", "kbd", "label"),
    *("legend", "li", "main", "mark", "meter", "nav", "ol", "output", "p", "pre", "progress", "q"),
    *("s", "samp", "section", "small", "span", "strong", "sub", "summary", "sup", "table", "tbody"),
    *("td", "template", "tfoot", "th", "thead", "time", "tr", "u", "ul", "var", "svg", *_VOID),
}
_SVG = {
    *("circle", "clippath", "defs", "desc", "ellipse", "g", "image", "line", "lineargradient"),
    *("marker", "mask", "metadata", "path", "pattern", "polygon", "polyline", "radialgradient"),
    *("rect", "stop", "svg", "symbol", "text", "textpath", "title", "tspan", "use"),
}
"""Elements that neither act nor change how the text after them is read or looks."""


def without_foreign_code(rendered: Rendered) -> Rendered:
    """Return what is shown of a value without code that is of no installed package.

    A script or style sheet stays if it is, to the letter, a file ``.js`` or ``.css`` of an
    installed package, or a constant of a module that is imported, as those of ``--plugin`` are.
    Scripts need each other: without one of them none stays.

    Returns
    -------
    Rendered
        The same object if nothing is left out.
    """
    kept = replace(
        rendered,
        html=passive(rendered.html),
        lead=passive(rendered.lead),
        scripts=rendered.scripts if all(map(_is_own, rendered.scripts)) else (),
        styles=tuple(filter(_is_own, rendered.styles)),
    )
    return rendered if kept == rendered else kept


def passive(html: str) -> str:
    """Return HTML, or nothing unless it is a part of a page that leaves the rest as it is.

    It holds data, elements that only show something, each of them closed, and style sheets of
    installed packages. Attributes that could run, such as ``onclick``, the policy of the page
    forbids; what is moved out of its place by a style, the page cuts off.
    """
    return html if _is_closed(html) else ""


def _is_closed(html: str) -> bool:
    opened: list[str] = []
    at = 0
    while at < len(html):
        part = _PART.match(html, at)
        if part is None:
            return False
        at = part.end()
        if part["style"] is not None and not _is_own(part["style"]):
            return False
        name = (part["name"] or "").lower()
        inside = "svg" in opened
        if part["end"]:
            if not opened or opened.pop() != name:
                return False
        elif name:
            # a browser reads elements of HTML in these two, of which the ends are then lost
            if inside and opened[-1] in ("title", "desc"):
                return False
            if ":" not in name and name not in (_SVG if inside else _HTML):
                return False
            if not (part["empty"] if inside or name == "svg" else name in _VOID):
                opened.append(name)
    return not opened


def _is_own(code: str) -> bool:
    return code.strip() in _installed_code() or any(
        type(value) is str and value == code
        for module in list(sys.modules.values())
        for value in list(getattr(module, "__dict__", {}).values())
    )


@cache
def _installed_code() -> frozenset[str]:
    texts = set()
    modules = [__name__, *(entry.module for entry in entry_points(group=GROUP))]
    for package in {module.partition(".")[0] for module in modules}:
        with suppress(ImportError, ValueError):  # a plugin that cannot be imported has none
            spec = find_spec(package)
            for folder in (spec and spec.submodule_search_locations) or ():
                for pattern in ("*.js", "*.css"):
                    texts |= {
                        path.read_text(encoding="utf-8").strip()
                        for path in Path(folder).rglob(pattern)
                    }
    return frozenset(texts)
