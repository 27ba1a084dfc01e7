"""``nodegraph schema``: JSON Schema of graph files, and of what commands print as JSON."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

from nodegraph.cli.arguments import add_plugin
from nodegraph.cli.output import write_and_print

HELP = "Print a JSON Schema: of graph files, for editors; or of what a command prints as JSON."

_SUBJECTS = ("graph", "run", "check", "show", "runs", "diff", "verify", "cache", "cite")


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "of",
        nargs="?",
        default="graph",
        choices=_SUBJECTS,
        help="Graph files (default), or the command whose --json is described.",
    )
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="File to write (default: standard output)."
    )
    add_plugin(parser)


def schema(arguments: Namespace) -> int:
    """Print or write a JSON Schema."""
    import json

    from nodegraph.cli.answers import answer_schema
    from nodegraph.graphfile.schema import graph_schema
    from nodegraph.plugin.registry import Registry

    if arguments.of == "graph":
        content = graph_schema(Registry.installed(arguments.plugin))
    else:
        content = answer_schema(arguments.of)
    text = json.dumps(content, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    if arguments.out:
        write_and_print(arguments.out, f"{text}\n".encode())
    else:
        print(text)
    return 0
