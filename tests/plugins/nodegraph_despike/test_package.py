"""What the package offers, and what importing it costs."""

from __future__ import annotations

import re
import subprocess
import sys

from nodegraph.node.decorator import node_of
from nodegraph_despike import nodegraph_bibtex, nodegraph_nodes


def test_every_despiker_runs_by_its_defaults_and_cites_what_is_shipped() -> None:
    shipped = set(re.findall(r"^@\w+\{(\w+),", nodegraph_bibtex(), flags=re.MULTILINE))
    cited: set[str] = set()
    for function in nodegraph_nodes():
        definition = node_of(function)
        assert definition is not None
        assert not [setting.name for setting in definition.settings.values() if setting.required]
        assert definition.cite
        cited |= set(definition.cite)
    assert cited == shipped


def test_every_despiker_says_how_far_it_looks_ahead() -> None:
    for function in nodegraph_nodes():
        assert "Looks ahead" in (function.__doc__ or "")


def test_importing_the_nodes_loads_nothing_heavy() -> None:
    code = (
        "import sys, nodegraph_despike; list(nodegraph_despike.nodegraph_nodes());"
        "heavy = ('numba', 'scipy', 'pandas', 'pywt');"
        "print([name for name in heavy if name in sys.modules])"
    )
    path = [entry for entry in sys.path if entry]
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path[:0] = {path!r}; {code}"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == "[]"
