"""The reference of what a plugin can add: a guide, then hooks and types from their docstrings."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from dataclasses import is_dataclass, replace
from html import escape
from typing import Any

from nodegraph.node import live_form
from nodegraph.plugin import hook_types, hooks, streaming
from nodegraph.site.page import Entry, Page
from nodegraph.site.prose import docstring_html, markdown_page


def plugin_page() -> Page:
    """Return the page on plugins."""
    page = markdown_page("plugins")
    parts, entries = [page.body], list(page.entries)
    for title, anchor, things in (
        ("Every hook", "hooks", _hooks()),
        ("What hooks return", "types", _types()),
    ):
        parts.append(f'<h2 id="{anchor}">{title}</h2>')
        for name, thing in things:
            parts.append(_documented(name, thing))
            entries.append(Entry(name, _summary(thing), name))
    return replace(page, body="\n".join(parts), entries=tuple(entries))


def _hooks() -> Iterator[tuple[str, Callable[..., object]]]:
    for name, function in vars(hooks).items():
        if name.startswith("nodegraph_"):
            yield name, function


def _types() -> Iterator[tuple[str, type]]:
    for module in (hook_types, streaming, live_form):
        for name, thing in vars(module).items():
            is_ours = isinstance(thing, type) and thing.__module__ == module.__name__
            if is_ours and (module is not hook_types or is_dataclass(thing)):
                yield name, thing


def _summary(thing: object) -> str:
    return (inspect.getdoc(thing) or "").partition("\n")[0]


def _documented(name: str, thing: Any) -> str:
    signature = "" if isinstance(thing, type) else str(inspect.signature(thing))
    return "\n".join(
        [
            f'<section id="{escape(name)}">',
            f"<h3><code>{escape(name)}{escape(signature)}</code></h3>",
            *docstring_html(inspect.getdoc(thing) or ""),
            "</section>",
        ]
    )
