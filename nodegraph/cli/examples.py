"""``nodegraph examples``."""

from __future__ import annotations

import shutil
from argparse import Namespace
from pathlib import Path

from nodegraph.cli.progress import columns
from nodegraph.errors import NodegraphError, nearest
from nodegraph.graphfile import read_graph_file
from nodegraph.plugin.registry import Registry


def examples(arguments: Namespace) -> int:
    """List the example graphs, or copy some of them."""
    there = Registry.installed(arguments.plugin).hooks.graphs
    unknown = [name for name in arguments.names if name.removesuffix(".yaml") not in there]
    if unknown:
        raise NodegraphError(f"no example {unknown[0]!r}; {nearest(unknown[0], there)}")
    if not arguments.names:
        rows = [(name, read_graph_file(path).title) for name, path in there.items()]
        print(f"{columns(rows)}\n\nnodegraph examples NAME copies one here")
    for name in arguments.names:
        _copy(there[name.removesuffix(".yaml")], arguments.to)
    return 0


def _copy(path: Path, folder: Path) -> None:
    used = read_graph_file(path).included
    targets = {folder / name: path.parent / name for name in (path.name, *used)}
    for target in targets:
        if target.exists():
            raise NodegraphError(f"{target} is there already; it is left as it is")
    for target, source in targets.items():
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)
    first = folder / path.name
    print(f"wrote {first}; run it with: nodegraph run {first}")
