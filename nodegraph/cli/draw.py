"""``nodegraph draw``: draw a graph."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path

from nodegraph.cli.arguments import add_graph
from nodegraph.cli.output import write_and_print
from nodegraph.errors import NodegraphError, nearest

HELP = "Draw a graph."

_FORMATS = {
    ".svg": "svg",
    ".pdf": "pdf",
    ".mmd": "mermaid",
    ".mermaid": "mermaid",
    ".dot": "dot",
    ".gv": "dot",
}


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_graph(parser)
    parser.add_argument(
        "--format",
        choices=tuple(dict.fromkeys(_FORMATS.values())),
        help="Format of the drawing (default: by the suffix of --out, else svg).",
    )
    parser.add_argument(
        "-o", "--out", type=Path, metavar="FILE", help="File to write (default: standard output)."
    )
    parser.add_argument(
        "--all",
        action="store_true",
        help="Draw tables, figures and written files each in a box, not in one list.",
    )


def draw(arguments: Namespace) -> int:
    """Print or write a drawing of a graph."""
    from nodegraph import draw as drawing
    from nodegraph.cli.graphs import graph_of
    from nodegraph.draw.from_graph import picture_of
    from nodegraph.draw.picture import folded

    suffix = arguments.out.suffix if arguments.out else ".svg"
    name = arguments.format or _FORMATS.get(suffix)
    if name is None:
        raise NodegraphError(
            f"--out {arguments.out}: {nearest(suffix, _FORMATS)}; or choose with --format"
        )
    if not arguments.out and (name == "pdf" or (name == "svg" and sys.stdout.isatty())):
        file = Path(arguments.graph).with_suffix(f".{name}").name
        raise NodegraphError(f"the drawing needs a file: --out {file}")
    picture = picture_of(graph_of(arguments))
    drawn: str | bytes = getattr(drawing, name)(picture if arguments.all else folded(picture))
    if arguments.out:
        write_and_print(arguments.out, drawn.encode() if isinstance(drawn, str) else drawn)
    else:
        print(drawn)
    return 0
