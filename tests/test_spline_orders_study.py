"""Orders of splines with and without impulse removal: command line to tables."""

from __future__ import annotations

import csv
import itertools
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
DATA = ROOT.parent / "shared" / "data"
GRAPH = ROOT / "graphs" / "spline_orders.yaml"
ORDERS = [f"order_{order}" for order in range(3, 8)]
REPAIRED = "order_3_after_repair"

needs_recordings = pytest.mark.skipif(not DATA.is_dir(), reason="the recordings are not here")


def run(folder: Path, *words: str) -> Path:
    command = [sys.executable, "-m", "nodegraph.cli.main", "run", str(GRAPH), *words]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / "runs" / "spline_orders"


def means(folder: Path) -> dict[str, float]:
    """The mean error to the truth of each method."""
    with (folder / "error-to-truth_table.csv").open() as file:
        return {row["smooth"]: float(row["mean"]) for row in csv.DictReader(file)}


def table_1(folder: Path) -> dict[str, dict[str, float]]:
    """The mean roughness by trajectory and method, a row for each and a column for each."""
    with (folder / "table-1_table.csv").open() as file:
        return {
            row.pop("marker"): {name: float(value) for name, value in row.items() if value}
            for row in csv.DictReader(file)
        }


@pytest.fixture(scope="module")
def built_in(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run on built-in data, with three trials."""
    folder = tmp_path_factory.mktemp("orders")
    return run(folder, "--axis", "trial=0,1,2", "--store", "store")


def test_roughness_falls_with_the_order_whatever_the_trajectory(built_in: Path) -> None:
    found = table_1(built_in)
    assert len(found) == 6
    for row, (lower, higher) in itertools.product(found.values(), itertools.pairwise(ORDERS)):
        assert row["captured"] > row[lower] > row[higher]
        assert row[REPAIRED] < row["order_3"]
        assert row["order_3 low"] < row["order_3"] < row["order_3 high"]
        assert row["blocks"] == 3


def test_with_impulses_the_repair_brings_it_nearest_to_the_truth(built_in: Path) -> None:
    found = means(built_in)
    assert min(found, key=lambda one: found[one]) == REPAIRED
    assert found["order_3"] < found["captured"]


def test_without_noise_or_impulses_every_order_costs_more_movement(tmp_path: Path) -> None:
    words = ("--set", "share=0", "--set", "sigma=0", "--axis", "trial=0")
    found = means(run(tmp_path, *words))
    assert found["captured"] == 0.0
    errors = [found[order] for order in ORDERS]
    assert errors == sorted(errors)
    assert errors[0] > 0.0


def test_the_figure_and_the_notes_are_in_the_report(built_in: Path) -> None:
    html = (built_in / "report.html").read_text()
    assert "must have lost a zero" in html
    assert (built_in / "figure-8.svg").is_file()


@needs_recordings
def test_on_real_optics_roughness_falls_with_the_order(tmp_path: Path) -> None:
    words = ["--set", f"recording={DATA / 'animface' / 'jaw.c3d'}", "--axis", "trial=0,1"]
    words += ["--set", "trajectories=[Mouth_Down, Chin, Leyebrow_M, Rcheek_Up]"]
    found = table_1(run(tmp_path, *words))
    for row, (lower, higher) in itertools.product(found.values(), itertools.pairwise(ORDERS)):
        assert row[lower] > row[higher]
        assert row[REPAIRED] < row["order_3"]
