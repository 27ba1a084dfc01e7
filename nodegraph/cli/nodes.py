"""``nodegraph nodes``."""

from __future__ import annotations

from argparse import Namespace

from nodegraph.cli.progress import columns
from nodegraph.errors import NodegraphError, nearest
from nodegraph.node.description import summary_of
from nodegraph.plugin.registry import Registry


def nodes(arguments: Namespace) -> int:
    """List the installed nodes."""
    registry = Registry.installed(arguments.plugin)
    family = (arguments.family or "").removesuffix(".*")
    if "." in family:
        registry.find(family)
        raise NodegraphError(f"{family!r} is a node, no family; `nodegraph show {family}` shows it")
    if family and not registry.family(family):
        raise NodegraphError(f"no family {family!r}; {nearest(family, registry.families)}")
    found = [one for one in registry if not family or one.node.family == family]
    print(columns([(one.node.name, summary_of(one.node), one.plugin) for one in found]))
    return 0
