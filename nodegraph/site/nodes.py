"""The reference of nodes, a page per family, from their descriptions."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from html import escape

from nodegraph.node.description import (
    describe_declaration,
    describe_settings,
    example_of,
    has_example,
    meanings,
    summary_of,
)
from nodegraph.plugin.bibliography import references
from nodegraph.plugin.registry import Registered, Registry
from nodegraph.site.page import Entry, Page
from nodegraph.site.prose import code_html, docstring_html, inline_html, table


def node_pages(registry: Registry) -> Iterator[Page]:
    """Yield the list of all nodes, then a page for each family."""
    families: dict[str, list[Registered]] = defaultdict(list)
    for entry in registry:
        families[entry.node.family].append(entry)
    yield _overview(families)
    keys = {key for entry in registry for key in entry.node.cite}
    cited = references(registry.hooks.bibtex, sorted(keys))
    for family, entries in families.items():
        parts = [f"<h1>{escape(family)}</h1>", _list(entries, "")]
        parts += [_node(entry, cited) for entry in entries]
        yield Page(f"nodes/{family}.html", family, "\n".join(parts), tuple(map(_entry, entries)))


def _overview(families: dict[str, list[Registered]]) -> Page:
    count = sum(map(len, families.values()))
    parts = ["<h1>Nodes</h1>", f"<p>{count} nodes are installed, in {len(families)} families.</p>"]
    for family, entries in families.items():
        link = f"nodes/{family}.html"
        parts += [f'<h2><a href="{escape(link)}">{escape(family)}</a></h2>', _list(entries, link)]
    return Page("nodes.html", "Nodes", "\n".join(parts))


def _list(entries: Iterable[Registered], page: str) -> str:
    rows = [
        (
            f'<a href="{escape(page)}#{escape(_anchor(entry))}"><code>{escape(entry.node.name)}'
            "</code></a>",
            inline_html(summary_of(entry.node)),
        )
        for entry in entries
    ]
    return table(("node", "what it does"), list(rows))


def _entry(entry: Registered) -> Entry:
    return Entry(entry.node.name, summary_of(entry.node), _anchor(entry))


def _anchor(entry: Registered) -> str:
    return f"{entry.plugin}-{entry.node.name}"


def _node(entry: Registered, cited: Mapping[str, str]) -> str:
    node = entry.node
    lead, sections = docstring_html(node.doc)
    documented = meanings(node)
    ports = [("in", port) for port in node.inputs] + [("out", port) for port in node.outputs]
    port_rows = [
        (side, f"<code>{escape(str(port))}</code>", inline_html(documented.get(port.name, "")))
        for side, port in ports
    ]
    setting_rows = [
        (
            f"<code>{escape(row.name)}</code>",
            f"<code>{escape(row.default)}</code>",
            escape(row.unit),
            escape(row.kind),
            inline_html(row.meaning),
        )
        for row in describe_settings(node)
    ]
    example = "" if has_example(node) else code_html(example_of(node))
    sources = [cited[key] for key in node.cite]
    parts = [
        f'<section class="node" id="{escape(_anchor(entry))}">',
        f"<h2><code>{escape(node.name)}</code></h2>",
        f'<p class="quiet">plugin {escape(f"{entry.plugin} {entry.distribution}".strip())}'
        f"{''.join(f' · {escape(text)}' for text in describe_declaration(node))}</p>",
        f"<p>Deprecated: {escape(node.deprecated)}.</p>" if node.deprecated else "",
        lead,
        table(("side", "port", "what it is"), port_rows),
        table(("setting", "default", "unit", "is", "meaning"), setting_rows),
        example,
        sections,
        *(f'<p class="source">{escape(source)}</p>' for source in sources),
        "</section>",
    ]
    return "\n".join(filter(None, parts))
