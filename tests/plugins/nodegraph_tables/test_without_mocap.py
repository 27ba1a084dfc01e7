"""The machine shows tables and figures without any plugin for motion capture."""

from __future__ import annotations

import subprocess
import sys

PROGRAM = """
import sys
from pathlib import Path

import nodegraph_tables
from nodegraph.execute.run import execute
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_text
from nodegraph.node.decorator import node
from nodegraph.plan import plan
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry
from nodegraph.report.page import page
from nodegraph.report.from_run import compose

@node("toy.table")
def table() -> nodegraph_tables.Table:
    from pandas import DataFrame

    rows = DataFrame({"name": ["a", "b"], "size": [1.5, 2.0]})
    answer = nodegraph_tables.Answer(("a is smaller.",))
    info = nodegraph_tables.TableInfo(answer=answer, units={"size": "m"})
    return nodegraph_tables.with_info(rows, info)

@node("toy.figure")
def figure(table: nodegraph_tables.Table) -> nodegraph_tables.Figure:
    from matplotlib.figure import Figure

    drawing = Figure()
    drawing.subplots().plot(table["size"])
    return drawing

text = '''
nodegraph: 1
nodes: {rows: {use: toy.table}, plot: {use: toy.figure, in: rows}}
report: [rows, plot]
'''
registry = Registry.of([table, figure])
registry.loaded.append(Plugin("tables", nodegraph_tables))
run = execute(plan(build(read_graph_text(text, "toy.yaml", Path()), registry)))
files = {}
write = lambda name, content: files.update({name: content}) or ""
study = compose(run, write=write).study
assert study.answer == ("a is smaller.",), study.answer
assert [section.title for section in study.sections] == ["Rows", "Plot"]
assert files["rows.csv"] == b"name,size\\na,1.5\\nb,2.0\\n"
assert {"rows.tex", "plot.svg", "plot.pdf"} <= set(files)
html = page(study)
assert 'size<span class="unit"> [m]</span>' in html and "<svg" in html
assert not [name for name in sys.modules if name.startswith("nodegraph_") and "tables" not in name]
"""


def test_a_run_of_tables_and_figures_is_shown() -> None:
    ended = subprocess.run(
        [sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=False
    )
    assert ended.returncode == 0, ended.stderr
