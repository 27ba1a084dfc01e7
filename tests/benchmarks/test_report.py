"""How soon the report of a large study is there: 10 fills of 3 lengths in 20 trials of a take."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from playwright.sync_api import Page

from nodegraph import get_node
from nodegraph_files import write_npz
from tests.benchmarks.tables import Tables
from tests.browser import load

CASE = "report of 600 fills of a take of 1,590 frames"
FILLS = "guenter,lin_ouhyoung,muscle,waters,linear,pchip,akima,cubic,ridge,pca"
GRAPH = Path(__file__).parents[2] / "graphs" / "fill.yaml"
ROUNDS = 5
LARGEST = 10e6
DRAWN = """
new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(
  () => done(performance.now()))))
"""
LOADED = "performance.getEntriesByType('navigation')[0].loadEventEnd"


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("study")
    face = get_node("synthesize.face")(seconds=26.5, missing=0, impulses=0)
    assert face.captured.frames == 1590
    write_npz(face.captured, folder / "take.npz")
    command = [
        sys.executable,
        "-m",
        "nodegraph.cli.main",
        "run",
        str(GRAPH),
        "--only",
        f"fill={FILLS}",
    ]
    words = ["--axis", f"recording={folder / 'take.npz'}", "--store", str(folder / "store")]
    subprocess.run([*command, *words, "--out", str(folder / "run")], check=True)
    return folder / "run" / "report.html"


def test_the_report_opens(report: Path, tab: Page, tables: Tables) -> None:
    size = report.stat().st_size
    tables.put(CASE, "nodegraph", "MB", size / 1e6)
    loaded, drawn = [], []
    for _ in range(ROUNDS):
        load(tab, report)
        drawn.append(tab.evaluate(DRAWN))
        loaded.append(tab.evaluate(LOADED))
    tables.put(CASE, "nodegraph", "loaded s", min(loaded) / 1e3)
    tables.put(CASE, "nodegraph", "drawn s", min(drawn) / 1e3)
    assert size < LARGEST
