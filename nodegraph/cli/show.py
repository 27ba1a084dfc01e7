"""``nodegraph show``."""

from __future__ import annotations

from argparse import Namespace

from nodegraph.cli.progress import columns
from nodegraph.plugin.registry import Registered, Registry


def show(arguments: Namespace) -> int:
    """Show one node."""
    registry = Registry.installed(arguments.plugin)
    print(_shown(registry.find(arguments.node), registry))
    return 0


def _shown(found: Registered, registry: Registry) -> str:
    from nodegraph.node.description import describe_settings, has_example, without_parameters
    from nodegraph.plugin.bibliography import references

    node = found.node
    ports = [("in", str(port)) for port in node.inputs] + [
        ("out", str(port)) for port in node.outputs
    ]
    parts = [f"{node.name}    plugin {found.plugin} {found.distribution}".rstrip(), columns(ports)]
    if node.deprecated:
        parts.insert(1, f"deprecated: {node.deprecated}")
    settings = describe_settings(node)
    if settings:
        head = ("setting", "default", "unit", "is", "meaning")
        rows = [(one.name, one.default, one.unit, one.kind, one.meaning) for one in settings]
        parts.append(columns([head, *rows]))
    parts.append(without_parameters(node.doc))
    if not has_example(node):
        parts.append(_example(found, registry))
    cited = references(registry.hooks.bibtex, node.cite).values()
    parts.append("cite: " + ("\n      ".join(cited) or "nothing"))
    return "\n\n".join(parts)


def _example(found: Registered, registry: Registry) -> str:
    from nodegraph.node.description import example_of

    claimed = [one for one in registry if one.node.name == found.node.name]
    text = example_of(found.node, found.full_name if len(claimed) > 1 else "")
    return "\n".join(
        ["example, among the nodes of a graph:", *(f"  {line}" for line in text.splitlines())]
    )
