"""Steps in several threads meet in nothing that Python does wrong there."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from nodegraph.execute.executor import HowToRun
from nodegraph.execute.run import execute
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry

IMPORTS = """
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


TREES = """
import ast, gc, threading, time
from nodegraph import node

TEXT = "(" * 30 + ")" * 30
has_begun, has_ended = threading.Event(), threading.Event()

def let_others_go(phase, info):
    time.sleep(0)

@node("toy.tidied")
def tidied() -> int:
    gc.freeze()  # for good, as the tests do: what there is takes a second to look through
    before = gc.get_threshold()
    gc.callbacks.append(let_others_go)
    gc.set_threshold(1)
    has_begun.set()
    try:
        for _ in range(50):
            ast.literal_eval(TEXT)
        return 1
    finally:
        has_ended.set()
        gc.set_threshold(*before)
        gc.callbacks.remove(let_others_go)

@node("toy.other")
def other() -> int:
    has_begun.wait()
    while not has_ended.is_set():
        ast.literal_eval("1")
    return 1
"""


def reasons(plugin: Path, *names: str) -> list[str]:
    """Return why the nodes of a plugin failed that ran in threads, side by side."""
    nodes = ", ".join(f"{name}: {{use: toy.{name}}}" for name in names)
    text = f"nodegraph: 1\nnodes: {{{nodes}}}"
    graph = build(read_graph_text(text, "toy.yaml", Path()), Registry.installed([plugin]))
    run = execute(plan(graph), how=HowToRun("threads", 2))
    return [outcome.reason for outcome in run.outcomes.values() if outcome.reason]


def test_imports_of_several_threads_do_not_meet(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "circular").mkdir()
    for name, text in PACKAGE.items():
        (tmp_path / "circular" / name).write_text(dedent(text))
    (tmp_path / "toy_imports.py").write_text(IMPORTS)
    assert not reasons(tmp_path / "toy_imports.py", "whole", "part")


def test_syntax_trees_of_several_threads_do_not_meet(tmp_path: Path) -> None:
    (tmp_path / "toy_trees.py").write_text(TREES)
    assert not reasons(tmp_path / "toy_trees.py", "tidied", "other")
