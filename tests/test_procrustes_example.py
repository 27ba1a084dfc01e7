"""The worked example of Procrustes analysis: command line to figure and table."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
GRAPH = ROOT / "graphs" / "procrustes_example.yaml"
STEPS = {"original": 213.0, "translation": 30.0, "scaling": 12.0, "rotation": 0.0}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    home = tmp_path_factory.mktemp("example")
    command = [sys.executable, "-m", "nodegraph.cli.main", "run", str(GRAPH), "--store", "store"]
    done = subprocess.run(command, cwd=home, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return home / "runs" / "procrustes_example"


def test_each_step_has_the_difference_of_the_text(folder: Path) -> None:
    with (folder / "table.csv").open() as file:
        found = {row["align"]: float(row["mean"]) for row in csv.DictReader(file)}
    assert list(found) == list(STEPS)
    assert found == pytest.approx(STEPS, abs=1e-12)


def test_the_figure_has_a_panel_per_step_with_its_difference(folder: Path) -> None:
    drawn = (folder / "figure-1.svg").read_text()
    for step, difference in STEPS.items():
        assert f">{step}<" in drawn
        assert f">D = {difference:.0f}<" in drawn
    assert (folder / "figure-1.pdf").is_file()
    assert "triangles" in (folder / "report.html").read_text()
