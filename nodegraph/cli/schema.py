"""``nodegraph schema``."""

from __future__ import annotations

import json
from argparse import Namespace

from nodegraph.cli.common import written_and_told
from nodegraph.plugin.registry import Registry


def schema(arguments: Namespace) -> int:
    """Print or write a JSON Schema of graph files."""
    from nodegraph.graphfile.schema import graph_schema

    made = graph_schema(Registry.installed(arguments.plugin))
    text = json.dumps(made, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    if arguments.out:
        written_and_told(arguments.out, f"{text}\n".encode())
    else:
        print(text)
    return 0
