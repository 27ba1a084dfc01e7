"""``nodegraph show``: describe a node."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_plugin
from nodegraph.cli.output import columns

if TYPE_CHECKING:
    from nodegraph.plugin.registry import Registered, Registry

HELP = "Show a node: ports, settings, units, citation."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("node", metavar="NODE", help="Node, such as fill.muscle.")
    add_plugin(parser)


def show(arguments: Namespace) -> int:
    """Print the description of a node."""
    from nodegraph.node.description import (
        describe_declaration,
        describe_settings,
        has_example,
        without_parameters,
    )
    from nodegraph.plugin.bibliography import references
    from nodegraph.plugin.registry import Registry

    registry = Registry.installed(arguments.plugin)
    entry = registry.find(arguments.node)
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
    cited = references(registry.hooks.bibtex, node.cite).values()
    parts.append("cite: " + ("\n      ".join(cited) or "nothing"))
    print("\n\n".join(parts))
    return 0


def _example(entry: Registered, registry: Registry) -> str:
    from nodegraph.node.description import example_of

    is_unique = sum(other.node.name == entry.node.name for other in registry) == 1
    text = example_of(entry.node, "" if is_unique else entry.full_name)
    return "\n".join(
        ["example, among the nodes of a graph:", *(f"  {line}" for line in text.splitlines())]
    )
