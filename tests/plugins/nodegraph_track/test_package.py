"""What the package offers, and what importing it costs."""

from __future__ import annotations

import re
import subprocess
import sys

from nodegraph.node.decorator import node_of
from nodegraph_track import nodegraph_bibtex, nodegraph_nodes


def test_every_tracker_runs_by_its_defaults_and_cites_what_is_shipped() -> None:
    shipped = set(re.findall(r"^@\w+\{(\w+),", nodegraph_bibtex(), flags=re.MULTILINE))
    cited: set[str] = set()
    for function in nodegraph_nodes():
        definition = node_of(function)
        assert definition is not None
        if definition.family == "track":
            assert not [
                setting.name for setting in definition.settings.values() if setting.required
            ]
        cited |= set(definition.cite)
    assert cited == shipped


def test_importing_the_nodes_loads_nothing_heavy() -> None:
    code = (
        "import sys, nodegraph_track; list(nodegraph_track.nodegraph_nodes());"
        "print([name for name in ('numba', 'scipy', 'pandas') if name in sys.modules])"
    )
    path = [entry for entry in sys.path if entry]
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path[:0] = {path!r}; {code}"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == "[]"
