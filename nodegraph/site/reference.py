"""The pages of the reference, which mkdocs takes from the code as it is installed."""

from __future__ import annotations

import re
import textwrap
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from html import escape

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

from nodegraph.cli.main import all_parsers
from nodegraph.graphfile import keys
from nodegraph.node.description import describe_declaration, describe_settings, meanings, summary_of
from nodegraph.plugin import hooks
from nodegraph.plugin.bibliography import references
from nodegraph.plugin.hooks import GROUP, HOOKS, Shape
from nodegraph.plugin.registry import Registered, Registry

_KEYS: tuple[tuple[str, Mapping[str, keys.Key]], ...] = (
    ("A graph file", keys.TOP_LEVEL),
    ("A node", keys.NODE),
    ("A method at a label of alternatives", keys.METHOD),
    ("A family among alternatives", keys.FAMILY),
    ("A reference with fixed axes", keys.FIXED_REFERENCE),
    ("An entry of the report", keys.REPORT_ENTRY),
)
_DOCUMENTED = (
    "nodegraph.plugin.kind",
    "nodegraph.plugin.hook_types",
    "nodegraph.plugin.streaming",
    "nodegraph.node.live_form",
)
_NODE = (
    "    options: {show_root_heading: false, show_root_toc_entry: false, "
    "show_docstring_parameters: false}"
)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages of the reference; mkdocs calls it."""
    for path, text in _pages():
        files.append(File.generated(config, f"reference/{path}", content=text))
    return files


def _pages() -> Iterator[tuple[str, str]]:
    """Yield the path and the Markdown of each page."""
    registry = Registry.installed()
    families: dict[str, list[Registered]] = defaultdict(list)
    for entry in registry:
        families[entry.node.family].append(entry)
    cited = references(
        registry.hooks.of("bibtex"), sorted({key for e in registry for key in e.node.cite})
    )
    overview = [f"# Nodes\n\n{len(list(registry))} nodes in {len(families)} families."]
    for family, entries in families.items():
        rows = [
            (f"[{each.node.name}]({family}.md#{_anchor(each.node.name)})", summary_of(each.node))
            for each in entries
        ]
        overview += [f"## {family}", _table(("node", "purpose"), rows)]
        yield f"{family}.md", "\n\n".join([f"# {family}", *(_node(e, cited) for e in entries)])
    yield "nodes.md", "\n\n".join(overview)
    yield (
        "commands.md",
        "\n\n".join(
            ["# Commands"]
            + [
                f"## nodegraph {name}\n\n```\n{parser.format_help()}```"
                for name, parser in all_parsers(registry).items()
            ]
        ),
    )
    tables = [
        f"## {title}\n\n"
        + _table(("key", "meaning"), [(f"`{name}`", key.meaning) for name, key in table.items()])
        for title, table in _KEYS
    ]
    yield "keys.md", "\n\n".join(["# Keys of a graph file", *tables])
    modules = [f"::: {module}" for module in _DOCUMENTED]
    yield "hooks.md", "\n\n".join([f"# Hooks\n\n{hooks.__doc__}", *_hooks(), *modules])


def _hooks() -> Iterator[str]:
    """Yield a section for each hook: what it returns, and an example."""
    shapes = {Shape.LIST: "A list", Shape.NAMED: "A mapping by name", Shape.TEXT: "A text"}
    for name, hook in HOOKS.items():
        function = f"{GROUP}_{name}"
        code = f"@hookimpl\ndef {function}():\n{textwrap.indent(hook.example, '    ')}"
        yield f"## `{function}`\n\n{shapes[hook.shape]}. {hook.doc}\n\n```python\n{code}\n```"


def _node(entry: Registered, cited: Mapping[str, str]) -> str:
    node = entry.node
    name = f"## {node.name} {{#{_anchor(node.name)}}}"
    declared = " · ".join([f"plugin {entry.plugin}", *describe_declaration(node)])
    meaning = meanings(node)
    ports = [("in", f"`{port}`", _plain(meaning.get(port.name, ""))) for port in node.inputs]
    ports += [("out", f"`{port}`", "") for port in node.outputs]
    rows = [
        (row.name, row.default_text, row.unit, row.kind, _plain(row.meaning))
        for row in describe_settings(node)
    ]
    parts = [
        name,
        declared,
        _table(("side", "port", "meaning"), ports),
        _table(("setting", "default", "unit", "values", "meaning"), rows) if rows else "",
        f"::: {node.function.__module__}.{node.function.__qualname__}\n{_NODE}",
        *(f"- {cited[key]}" for key in node.cite),
    ]
    return "\n\n".join(filter(None, parts))


def _plain(text: str) -> str:
    """Return Markdown that shows a text as it is."""
    return re.sub(r"[*_\[\\`{]", r"\\\g<0>", escape(text, quote=False))


def _anchor(name: str) -> str:
    return name.replace(".", "-")


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join(
        "| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines
    )
