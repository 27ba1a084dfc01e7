"""``nodegraph examples``: list and copy example graphs."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

from nodegraph.cli.arguments import add_plugin
from nodegraph.cli.output import columns, refuse_existing
from nodegraph.errors import NodegraphError, nearest

HELP = "List the example graphs, or copy some of them."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("names", nargs="*", metavar="NAME", help="Graphs to copy.")
    parser.add_argument(
        "--to",
        type=Path,
        default=Path(),
        metavar="DIR",
        help="Folder to copy to (default: the current one).",
    )
    add_plugin(parser)


def examples(arguments: Namespace) -> int:
    """List the example graphs, or copy some of them."""
    from nodegraph.graphfile import read_graph_file
    from nodegraph.plugin.registry import Registry

    graphs = Registry.installed(arguments.plugin).hooks.graphs
    names = [name.removesuffix(".yaml") for name in arguments.names]
    for name in names:
        if name not in graphs:
            raise NodegraphError(f"no example {name!r}; {nearest(name, graphs)}")
    if not names:
        rows = [(name, read_graph_file(path).title) for name, path in graphs.items()]
        print(f"{columns(rows)}\n\nnodegraph examples NAME copies one to the current folder")
    for name in names:
        _copy(graphs[name], arguments.to)
    return 0


def _copy(path: Path, folder: Path) -> None:
    from nodegraph.graphfile import read_graph_file

    names = (path.name, *read_graph_file(path).included)
    for name in names:
        refuse_existing(folder / name)
    for name in names:
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes((path.parent / name).read_bytes())
    first = folder / path.name
    print(f"wrote {first}; run it with: nodegraph run {first}")
