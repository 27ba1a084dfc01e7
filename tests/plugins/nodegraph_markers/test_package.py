"""What the package offers, and what importing it costs."""

from __future__ import annotations

import re
import subprocess
import sys

from nodegraph.node.decorator import node_of
from nodegraph_markers import nodegraph_bibtex, nodegraph_nodes


def test_every_node_cites_what_is_shipped() -> None:
    shipped = set(re.findall(r"^@\w+\{(\w+),", nodegraph_bibtex(), flags=re.MULTILINE))
    nodes = [node_of(function) for function in nodegraph_nodes()]
    assert {key for one in nodes if one for key in one.cite} == shipped
    assert [one.name for one in nodes if one] == [
        "markers.keep",
        "markers.rename",
        "markers.infer",
        "markers.label",
        "recording.crop",
        "recording.resample",
        "recording.join",
    ]


def test_importing_the_nodes_loads_nothing_heavy() -> None:
    code = (
        "import sys, nodegraph_markers; list(nodegraph_markers.nodegraph_nodes());"
        "print([one for one in ('scipy', 'pandas', 'networkx') if one in sys.modules])"
    )
    path = [entry for entry in sys.path if entry]
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path[:0] = {path!r}; {code}"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == "[]"
