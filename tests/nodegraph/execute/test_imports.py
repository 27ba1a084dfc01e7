"""Two steps that import parts of one package at once get whole modules."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from nodegraph.execute import HowToRun, execute
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry

GRAPH = """
nodegraph: 1
nodes: {whole: {use: toy.whole}, part: {use: toy.part}}
"""
NODES = """
import threading
from nodegraph import node

has_begun, meets = threading.Event(), threading.Event()

@node("toy.whole")
def whole() -> int:
    import circular
    return circular.helper()

@node("toy.part")
def part() -> int:
    has_begun.wait()
    from circular.part import helper
    return helper()
"""
# as in scipy, the package needs a module that needs the package
PACKAGE = {
    "__init__.py": """
        from toy_imports import has_begun, meets
        has_begun.set()
        meets.wait(0.5)  # which the other thread never sets when it imports nothing meanwhile
        from circular.tools import helper
        """,
    "part.py": "from circular.tools import helper",
    "tools.py": """
        from toy_imports import meets
        meets.set()
        import circular
        def helper():
            return 1
        """,
}


def test_imports_of_several_threads_do_not_meet(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "circular").mkdir()
    for name, text in PACKAGE.items():
        (tmp_path / "circular" / name).write_text(dedent(text))
    (tmp_path / "toy_imports.py").write_text(NODES)
    registry = Registry.installed([tmp_path / "toy_imports.py"])
    graph = build(read_graph_text(GRAPH, "toy.yaml", Path()), registry)
    run = execute(plan(graph), how=HowToRun("threads", 2))
    assert {outcome.reason for outcome in run.outcomes.values()} == {""}
