"""``nodegraph draw``."""

from __future__ import annotations

from argparse import Namespace

from nodegraph.cli.common import graph_of, written_and_told
from nodegraph.errors import NodegraphError, nearest


def draw(arguments: Namespace) -> int:
    """Write a drawing of a graph."""
    from nodegraph import draw as drawing
    from nodegraph.draw.from_graph import picture_of

    by_suffix = {
        ".svg": "svg",
        ".mmd": "mermaid",
        ".mermaid": "mermaid",
        ".dot": "dot",
        ".gv": "dot",
    }
    suffix = arguments.out.suffix if arguments.out else ".svg"
    form = arguments.format or by_suffix.get(suffix)
    if form is None:
        raise NodegraphError(
            f"--out {arguments.out}: {nearest(suffix, by_suffix)}; or give --format"
        )
    text: str = getattr(drawing, form)(picture_of(graph_of(arguments)))
    if arguments.out:
        written_and_told(arguments.out, text.encode())
    else:
        print(text)
    return 0
