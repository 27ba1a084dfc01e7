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
    command = [sys.executable, "-m", "nodegraph.cli", "run", str(GRAPH), *words]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / "runs" / "spline_orders"


def means(folder: Path, table: str) -> dict[tuple[str, str], float]:
    """The mean of each row by marker, if the table has markers, and method."""
    with (folder / f"{table}_table.csv").open() as file:
        return {
            (row.get("marker", ""), row["smooth"]): float(row["mean"])
            for row in csv.DictReader(file)
        }


@pytest.fixture(scope="module")
def built_in(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run on built-in data, with three trials."""
    folder = tmp_path_factory.mktemp("orders")
    return run(folder, "--axis", "trial=0,1,2", "--store", "store")


def test_roughness_falls_with_the_order_whatever_the_trajectory(built_in: Path) -> None:
    found = means(built_in, "table-1")
    markers = {marker for marker, _ in found}
    assert len(markers) == 6
    for marker, (lower, higher) in itertools.product(markers, itertools.pairwise(ORDERS)):
        assert found[marker, "captured"] > found[marker, lower] > found[marker, higher]
        assert found[marker, REPAIRED] < found[marker, "order_3"]


def test_with_impulses_the_repair_brings_it_nearest_to_the_truth(built_in: Path) -> None:
    found = means(built_in, "error-to-truth")
    best = min(found, key=lambda one: found[one])
    assert best == ("", REPAIRED)
    assert found["", "order_3"] < found["", "captured"]


def test_without_noise_or_impulses_every_order_costs_more_movement(tmp_path: Path) -> None:
    words = ("--set", "share=0", "--set", "sigma=0", "--axis", "trial=0")
    found = means(run(tmp_path, *words), "error-to-truth")
    assert found["", "captured"] == 0.0
    errors = [found["", order] for order in ORDERS]
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
    found = means(run(tmp_path, *words), "table-1")
    for marker, (lower, higher) in itertools.product(
        {marker for marker, _ in found}, itertools.pairwise(ORDERS)
    ):
        assert found[marker, lower] > found[marker, higher]
        assert found[marker, REPAIRED] < found[marker, "order_3"]
