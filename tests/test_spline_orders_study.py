"""Orders of splines with and without impulse removal: command line to tables."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from tests.studies import DATA, Studies, needs_recordings, table

ORDERS = [f"order_{order}" for order in range(3, 8)]
REPAIRED = "order_3_after_repair"
CONTROL = "order_7_after_repair"


def means(folder: Path, name: str) -> dict[str, dict[str, float]]:
    """The mean of each method, by the share of impulses."""
    result: dict[str, dict[str, float]] = {}
    for row in table(folder / f"{name}_table.csv"):
        result.setdefault(row["impulses"], {})[row["smooth"]] = float(row["mean"])
    return result


@pytest.fixture(scope="module")
def built_in(studies: Studies) -> Path:
    """A run on two faces."""
    return studies.few("spline_orders")


def test_roughness_falls_with_the_order(built_in: Path) -> None:
    errors = means(built_in, "table-1")
    assert set(errors) == {"0.002", "0.005", "0.02"}
    for row, (lower, higher) in itertools.product(errors.values(), itertools.pairwise(ORDERS)):
        assert row["captured"] > row[lower] > row[higher]
        assert row[REPAIRED] < row["order_3"]


def test_the_share_of_impulses_decides_whether_repair_is_smoother(built_in: Path) -> None:
    errors = means(built_in, "table-1")
    assert errors["0.002"][REPAIRED] > errors["0.002"]["order_7"]
    assert errors["0.02"][REPAIRED] < 0.6 * errors["0.02"]["order_7"]


def test_with_impulses_the_repair_brings_it_nearest_to_the_truth(built_in: Path) -> None:
    for row in means(built_in, "error-to-truth").values():
        assert sorted(row, key=lambda smooth: row[smooth])[:2] == [CONTROL, REPAIRED]
        assert row["order_3"] < row["captured"]


def test_without_noise_or_impulses_every_order_costs_more_movement(studies: Studies) -> None:
    words = ("--axis", "impulses=0", "--set", "sigma=0", "--only", "recording=face_1")
    folder = studies.run("spline_orders", *words, "--until", "error_to_truth")
    (result,) = means(folder, "error-to-truth").values()
    assert result["captured"] == 0.0
    errors = [result[order] for order in ORDERS]
    assert errors == sorted(errors)
    assert errors[0] > 0.0


def test_the_figure_and_the_notes_are_in_the_report(built_in: Path) -> None:
    html = (built_in / "report.html").read_text()
    assert "must have lost a zero" in html
    assert (built_in / "figure-8.svg").is_file()


@needs_recordings
def test_on_real_optics_roughness_falls_with_the_order(studies: Studies) -> None:
    words = ("--axis", f"recording={DATA / 'animface' / 'jaw.c3d'}", "--only", "impulses=0.02")
    folder = studies.run("spline_orders", *words)
    (errors,) = means(folder, "table-1").values()
    for lower, higher in itertools.pairwise(ORDERS):
        assert errors[lower] > errors[higher]
    assert errors[REPAIRED] < errors["order_3"]
    assert "no noise-free truth" in (folder / "report.html").read_text()
