"""The comparison of trackers, as a user runs it: command line to report."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.records import read_record
from tests.studies import ROOT, Studies, command, table

GRAPH = str(ROOT / "graphs" / "tracking.yaml")
TRACKERS = {"assignment", "nearest", "neighbours"}


def wrong_of(folder: Path) -> dict[tuple[str, float, float], float]:
    """Return wrong links of 100,000, by tracker, drop-out and ghosts."""
    return {
        (row["tracks"], float(row["dropout"]), float(row["ghosts"])): float(row["mean"])
        for row in table(folder / "table.csv")
    }


@pytest.fixture(scope="module")
def built_in(studies: Studies) -> Path:
    """A run on two faces."""
    return studies.few("tracking")


def test_the_table_has_every_tracker_at_every_rate(built_in: Path) -> None:
    expected = {
        (tracker, dropout, ghosts)
        for tracker in TRACKERS
        for dropout in (0.02, 0.2)
        for ghosts in (0.0, 0.05)
    }
    assert expected <= wrong_of(built_in).keys()
    assert {row["blocks"] for row in table(built_in / "table.csv")} == {"2"}


def test_nearly_every_link_is_right(built_in: Path) -> None:
    assert 0.0 < max(wrong_of(built_in).values()) < 100.0


def test_prediction_helps(built_in: Path) -> None:
    wrong = wrong_of(built_in)
    mean = {tracker: sum(wrong[key] for key in wrong if key[0] == tracker) for tracker in TRACKERS}
    assert max(mean["neighbours"], mean["assignment"]) < 0.8 * mean["nearest"]


def test_the_report_tells_which_number_is_better(built_in: Path) -> None:
    html = (built_in / "report.html").read_text()
    assert "Which tracker keeps the names of a face&#39;s markers when points drop out?" in html
    assert "Lower is better." in html
    # the first row of each card
    assert html.count('<table class="lead-rows"><tbody><tr data-method="neighbours" ') == 4
    assert "<svg" in html
    assert 'src="http' not in html


def test_all_trackers_get_the_same_points(built_in: Path) -> None:
    record = read_record(built_in)
    assert record["counts"]["failed"] == 0
    counts = {name: 0 for name in ("points", "tracks", "score")}
    for step in record["steps"]:
        if step["node"] in counts:
            counts[step["node"]] += 1
    assert counts == {"points": 8, "tracks": 24, "score": 24}


def test_the_graph_checks_and_is_drawn(tmp_path: Path) -> None:
    assert command("check", GRAPH, folder=tmp_path).status == 0
    drawn = command("draw", GRAPH, folder=tmp_path)
    assert drawn.status == 0
    assert ">neighbours<" in drawn.out
