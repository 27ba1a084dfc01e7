"""``nodegraph schema``: JSON Schema of graph files."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

from nodegraph.cli.arguments import add_plugin
from nodegraph.cli.output import write_and_print

HELP = "Print a JSON Schema of graph files, for editors."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="File to write (default: standard output)."
    )
    add_plugin(parser)


def schema(arguments: Namespace) -> int:
    """Print or write a JSON Schema of graph files."""
    import json

    from nodegraph.graphfile.schema import graph_schema
    from nodegraph.plugin.registry import Registry

    content = graph_schema(Registry.installed(arguments.plugin))
    text = json.dumps(content, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    if arguments.out:
        write_and_print(arguments.out, f"{text}\n".encode())
    else:
        print(text)
    return 0
