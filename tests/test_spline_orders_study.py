"""Orders of splines with and without impulse removal: command line to tables."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from tests.studies import DATA, Studies, needs_recordings, table

ORDERS = [f"order_{order}" for order in range(3, 8)]
REPAIRED = "order_3_after_repair"


def means(folder: Path) -> dict[str, float]:
    """The mean error to the truth of each method."""
    rows = table(folder / "error-to-truth_table.csv")
    return {row["smooth"]: float(row["mean"]) for row in rows}


def table_1(folder: Path) -> dict[str, dict[str, float]]:
    """The mean roughness by trajectory and method, a row for each and a column for each."""
    return {
        row.pop("marker"): {name: float(value) for name, value in row.items() if value}
        for row in table(folder / "table-1_table.csv")
    }


@pytest.fixture(scope="module")
def built_in(studies: Studies) -> Path:
    """A run on built-in data, with three trials."""
    return studies.few("spline_orders")


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


def test_without_noise_or_impulses_every_order_costs_more_movement(studies: Studies) -> None:
    words = ("--set", "share=0", "--set", "sigma=0", "--axis", "trial=0")
    found = means(studies.run("spline_orders", *words))
    assert found["captured"] == 0.0
    errors = [found[order] for order in ORDERS]
    assert errors == sorted(errors)
    assert errors[0] > 0.0


def test_the_figure_and_the_notes_are_in_the_report(built_in: Path) -> None:
    html = (built_in / "report.html").read_text()
    assert "must have lost a zero" in html
    assert (built_in / "figure-8.svg").is_file()


@needs_recordings
def test_on_real_optics_roughness_falls_with_the_order(studies: Studies) -> None:
    words = ["--set", f"recording={DATA / 'animface' / 'jaw.c3d'}", "--axis", "trial=0,1"]
    words += ["--set", "trajectories=[Mouth_Down, Chin, Leyebrow_M, Rcheek_Up]"]
    found = table_1(studies.run("spline_orders", *words))
    for row, (lower, higher) in itertools.product(found.values(), itertools.pairwise(ORDERS)):
        assert row[lower] > row[higher]
        assert row[REPAIRED] < row["order_3"]
