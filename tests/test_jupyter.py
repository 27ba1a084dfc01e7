"""A run in JupyterLab, in a browser."""

from __future__ import annotations

import json
import os
import secrets
import subprocess
import sys
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest
from playwright.sync_api import Page

pytestmark = pytest.mark.skipif(find_spec("jupyterlab") is None, reason="JupyterLab is missing")

GRAPH = """
nodegraph: 1
nodes:
  face: {use: synthesize.face, with: {seconds: 2, markers: 20}}
  gaps: {use: gaps.cut, in: face, with: {length: 10, seed: 1}}
  fill: {in: gaps.gappy, alternatives: [fill.linear, fill.cubic]}
  error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
  table: {use: compare.table, in: error, with: {compare: fill}}
report: [table]
"""
CODE = "import nodegraph\nnodegraph.run(nodegraph.load('graph.yaml'))"
QUICKLY = """
import sys
sys.modules["rfc3987_syntax"] = None
"""
"""Saves two seconds: jsonschema would read a grammar of addresses, which nothing here checks."""
COMPUTE = f"""
{QUICKLY}
import nbformat
from nbclient import NotebookClient
from nbformat.sign import NotebookNotary

notebook = nbformat.read("run.ipynb", as_version=4)
NotebookClient(notebook).execute()
nbformat.write(notebook, "run.ipynb")
NotebookNotary().sign(notebook)
"""
SERVE = f"""
{QUICKLY}
from jupyterlab.labapp import main
main()
"""
MOST = 60_000
"""Milliseconds until something is there; it takes a few seconds."""


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[str]:
    """The address of a JupyterLab with a notebook, which keeps all that it writes in a folder."""
    cell = {"cell_type": "code", "id": "run", "metadata": {}, "outputs": [], "source": CODE}
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook = {
        "cells": [cell | {"execution_count": None}],
        "metadata": {"kernelspec": kernel},
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    (tmp_path / "run.ipynb").write_text(json.dumps(notebook))
    (tmp_path / "graph.yaml").write_text(GRAPH)
    token = secrets.token_hex()
    places = ("RUNTIME_DIR", "CONFIG_DIR", "DATA_DIR")
    own = {f"JUPYTER_{place}": str(tmp_path / place) for place in places}
    own |= {
        f"JUPYTERLAB_{place}_DIR": str(tmp_path / place) for place in ("SETTINGS", "WORKSPACES")
    }
    own |= {
        "IPYTHONDIR": str(tmp_path / "ipython"),
        "JUPYTER_TOKEN": token,
    }
    # computed before JupyterLab shows it, which loses what is run before its kernel listens, and
    # signed, because JupyterLab leaves out scripts of notebooks that others have computed
    subprocess.run(
        [sys.executable, "-c", COMPUTE],
        env=os.environ | own, cwd=tmp_path, check=True, capture_output=True,
    )  # fmt: skip
    command = [sys.executable, "-c", SERVE, "--no-browser", "--ip=127.0.0.1", "--port=0"]
    command += [f"--ServerApp.root_dir={tmp_path}", "--allow-root", "--LabApp.news_url="]
    command += ["--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate"]
    with (tmp_path / "log.txt").open("w") as log:
        server = subprocess.Popen(
            command, env=os.environ | own, cwd=tmp_path, stdout=log, stderr=log,
        )  # fmt: skip
    try:
        while not (found := [*tmp_path.glob("RUNTIME_DIR/jpserver-*.json")]):
            assert server.poll() is None, (tmp_path / "log.txt").read_text()
            time.sleep(0.1)
        yield f"{json.loads(found[0].read_text())['url']}lab/tree/run.ipynb?token={token}"
    finally:
        # kernels end with their server; one that is told to end waits for a kernel that has just
        # begun, at times for ever
        server.kill()
        server.wait()


def test_a_run_shows_its_charts(lab: str, tab: Page, complaints: list[str]) -> None:
    tab.goto(lab)
    tab.wait_for_selector(".nodegraph-notebook .counts", timeout=MOST)
    charts = tab.frame_locator(".nodegraph-notebook iframe.framed").first
    charts.locator(".heat tbody tr").first.wait_for(state="attached", timeout=MOST)
    assert charts.locator(".heat tbody tr").count() == 2
    mark = charts.locator("[data-chart=ranking] [role=button][data-method]").first
    mark.dispatch_event("click")
    charts.locator(".selected").first.wait_for(state="attached", timeout=MOST)
    tab.evaluate("window.onbeforeunload = null")
    tab.goto("about:blank")
    complaints.clear()  # those of JupyterLab; other tests show the same charts on pages of ours
