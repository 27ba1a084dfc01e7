"""The comparison of trackers, as a user runs it: command line to report."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.records import read_record
from tests.studies import DATA, ROOT, Studies, command, needs_recordings, table

GRAPH = str(ROOT / "graphs" / "tracking.yaml")
TRACKERS = {"assignment", "nearest", "neighbours"}
FEW = ("--only", "dropout=0.02,0.1", "--until", "table")


def wrong_of(folder: Path) -> dict[tuple[str, float, float], float]:
    """Return wrong links among 1000, by tracker, drop-out and ghosts."""
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


@needs_recordings
@pytest.mark.parametrize("name", ["jaw", "cheeks"])
def test_neighbours_find_the_hidden_markers_of_a_face_that_holds_still(
    studies: Studies, name: str
) -> None:
    take = DATA / "animface" / f"{name}.c3d"
    wrong = wrong_of(studies.run("tracking", "--axis", f"recording={take}", *FEW))
    assert len(wrong) == 12
    for dropout, ghosts in ((0.02, 0.0), (0.02, 0.05), (0.1, 0.0), (0.1, 0.05)):
        ours = wrong["neighbours", dropout, ghosts]
        assert 1.5 * ours < wrong["assignment", dropout, ghosts]
        assert ours < 10.0
    assert all(value < 30.0 for value in wrong.values())


@needs_recordings
def test_neighbours_follow_a_head_that_moves_fast(studies: Studies) -> None:
    take = DATA / "facecap" / "take001.c3d"
    trials = ("--axis", "trial={count: 3}")
    wrong = wrong_of(studies.run("tracking", "--axis", f"recording={take}", *trials, *FEW))
    for dropout, ghosts in ((0.02, 0.0), (0.02, 0.05), (0.1, 0.0), (0.1, 0.05)):
        ours = wrong["neighbours", dropout, ghosts]
        assert 4.0 * ours < wrong["assignment", dropout, ghosts]
        assert wrong["assignment", dropout, ghosts] < wrong["nearest", dropout, ghosts]
