"""The reference of graph files: a guide, then every key from the tables that the reader uses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from html import escape

from nodegraph.graphfile.keys import (
    FAMILY,
    FIXED_REFERENCE,
    METHOD,
    NODE,
    REPORT_ENTRY,
    TOP_LEVEL,
    Key,
)
from nodegraph.site.page import Entry, Page
from nodegraph.site.prose import inline_html, markdown_page, table

SCHEMA = "nodegraph.schema.json"
_TABLES: tuple[tuple[str, Mapping[str, Key]], ...] = (
    ("A graph file", TOP_LEVEL),
    ("A node", NODE),
    ("A method at a label of alternatives", METHOD),
    ("A family among alternatives", FAMILY),
    ("A reference with fixed axes", FIXED_REFERENCE),
    ("An entry of the report", REPORT_ENTRY),
)


def language_page() -> Page:
    """Return the page on graph files."""
    page = markdown_page("language")
    parts = [page.body, '<h2 id="keys">Every key</h2>']
    parts.append(
        f'<p>The same as JSON Schema, with every installed node: <a href="{SCHEMA}">{SCHEMA}</a>.'
        "</p>"
    )
    entries = list(page.entries)
    for title, keys in _TABLES:
        rows = [
            (f"<code>{escape(name)}</code>", inline_html(key.meaning)) for name, key in keys.items()
        ]
        parts += [f"<h3>{escape(title)}</h3>", table(("key", "meaning"), rows)]
        entries += [Entry(name, key.meaning, "keys") for name, key in keys.items()]
    unique = {entry.name: entry for entry in reversed(entries)}
    return replace(page, body="\n".join(parts), entries=tuple(unique.values()))
