"""``nodegraph show``: list the installed nodes, or describe a node."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_plugin
from nodegraph.cli.output import columns
from nodegraph.errors import NodegraphError, nearest

if TYPE_CHECKING:
    from nodegraph.plugin.registry import Registered, Registry

HELP = "List the installed nodes, or show a node: ports, settings, units, citation."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "word",
        nargs="?",
        default="",
        metavar="WORD",
        help="Node, such as fill.muscle; or family, such as fill, or part of a name or summary, to "
        "list the nodes.",
    )
    add_plugin(parser)


def show(arguments: Namespace) -> int:
    """Print the description of a node, or the list of all those to which a word applies."""
    from nodegraph.plugin.registry import Registry

    registry = Registry.installed(arguments.plugin)
    is_node = "." in arguments.word and not arguments.word.endswith(".*")
    print(_description(arguments.word, registry) if is_node else _list(arguments.word, registry))
    return 0


def _list(word: str, registry: Registry) -> str:
    from nodegraph.node.description import summary_of

    word = word.removesuffix(".*").lower()
    rows = [(entry.node.name, summary_of(entry.node), entry.plugin) for entry in registry]
    family = [row for row in rows if row[0].startswith(f"{word}.")]
    matches = family or [row for row in rows if word in f"{row[0]} {row[1]}".lower()]
    if word and not matches:
        hint = nearest(word, registry.families)
        raise NodegraphError(f"no node has {word!r} in its name or summary; {hint}")
    return columns(matches)


def _description(name: str, registry: Registry) -> str:
    from nodegraph.node.description import (
        describe_declaration,
        describe_settings,
        has_example,
        without_parameters,
    )
    from nodegraph.plugin.bibliography import references

    entry = registry.find(name)
    node = entry.node
    parts = [f"{node.name}    plugin {entry.plugin} {entry.distribution}".rstrip()]
    if node.deprecated:
        parts.append(f"deprecated: {node.deprecated}")
    ports = [("in", str(port)) for port in node.inputs]
    parts.append(columns([*ports, *(("out", str(port)) for port in node.outputs)]))
    settings = describe_settings(node)
    if settings:
        head = ("setting", "default", "unit", "is", "meaning")
        rows = [(row.name, row.default, row.unit, row.kind, row.meaning) for row in settings]
        parts.append(columns([head, *rows]))
    if declared := describe_declaration(node):
        parts.append("\n".join(declared))
    parts.append(without_parameters(node.doc))
    if not has_example(node):
        parts.append(_example(entry, registry))
    cited = references(registry.hooks.of("bibtex"), node.cite).values()
    parts.append("cite: " + ("\n      ".join(cited) or "nothing"))
    return "\n\n".join(parts)


def _example(entry: Registered, registry: Registry) -> str:
    from nodegraph.node.description import example_of

    is_unique = sum(other.node.name == entry.node.name for other in registry) == 1
    text = example_of(entry.node, "" if is_unique else entry.full_name)
    return "\n".join(
        ["example, among the nodes of a graph:", *(f"  {line}" for line in text.splitlines())]
    )
