"""``nodegraph schema``."""

from __future__ import annotations

import json
from argparse import Namespace

from nodegraph.display import size_text
from nodegraph.registry import Registry


def schema(arguments: Namespace) -> int:
    """Print or write a JSON Schema of graph files."""
    from nodegraph.schema import graph_schema

    made = graph_schema(Registry.installed(arguments.plugin))
    text = json.dumps(made, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    if arguments.out:
        arguments.out.parent.mkdir(parents=True, exist_ok=True)
        arguments.out.write_text(text + "\n", encoding="utf-8")
        print(f"{arguments.out} ({size_text(len(text.encode()))})")
    else:
        print(text)
    return 0
