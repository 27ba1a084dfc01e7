"""Whether a plugin ships what its nodes cite."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from nodegraph.bibliography import entry_keys
from nodegraph.errors import nearest
from nodegraph.node import Node
from nodegraph.plugins import package_of, reason_of
from nodegraph.registry import Registry
from nodegraph.source import Nonsense, PluginError


def citation_faults(node: Node, registry: Registry) -> Iterator[str]:
    """Yield the keys that a node cites and its plugin does not ship, or why nobody can tell.

    Parameters
    ----------
    node
        Whose `cite` is looked at.
    registry
        Whose plugins ship BibTeX, where the node's own package has none.
    """
    if not node.cite:
        return
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            there = entry_keys(_bibtex(node, registry))
        except PluginError as fails:
            yield f"{fails}: mend it, or nobody learns what the node cites"
            return
    for one in said:
        yield f"{one.message}: mend what its hook nodegraph_bibtex returns"
    for key in node.cite:
        if key not in there:
            yield (
                f"cites {key!r}, which its plugin does not ship ({nearest(key, there)}): put the "
                "entry into the BibTeX that its hook nodegraph_bibtex returns"
            )


def _bibtex(node: Node, registry: Registry) -> Iterable[str]:
    """Return the BibTeX of the node's package, else of its plugin, else of every plugin."""
    parts = node.function.__module__.split(".")
    names = (".".join(parts[:count]) for count in range(len(parts), 0, -1))
    brought = {one.plugin for one in registry if one.node.function is node.function}
    plugins = [one.module for one in registry.loaded if one.name in brought]
    for module in (*(sys.modules.get(name) for name in names), *plugins):
        if hook := getattr(module, "nodegraph_bibtex", None):
            return [_asked(hook)]
    return registry.bibtex


def _asked(hook: Callable[[], Any]) -> str:
    try:
        found = hook()
        if isinstance(found, str):
            return found
        raise Nonsense(found, "a text")
    except (Exception, SystemExit) as error:
        reason = reason_of(error, package_of(hook))
        raise PluginError(f"its plugin's hook nodegraph_bibtex failed: {reason}") from error
