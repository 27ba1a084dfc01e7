"""The walk of the question about impulses, as a user takes it: command line to report."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.studies import DATA, Studies, needs_recordings, table

DESPIKERS = {"impulse", "redetect", "hampel", "median", "acceleration", "wavelet", "without"}
TABLES = ("error-left", "impulses-missed", "good-samples-repaired")


def means_of(folder: Path, name: str) -> dict[tuple[str, str], float]:
    rows = table(folder / f"{name}_table.csv")
    return {(row["despike"], row["hit"]): float(row["mean"]) for row in rows}


@pytest.fixture(scope="module")
def built_in(studies: Studies) -> Path:
    """A run on built-in data, with three trials."""
    return studies.few("impulses")


def test_the_tables_have_every_method_at_every_share(built_in: Path) -> None:
    expected = {(method, share) for method in DESPIKERS for share in ("0.5%", "2%")}
    for name in TABLES:
        assert set(means_of(built_in, name)) >= expected


def test_everything_that_the_walk_promises_is_there(built_in: Path) -> None:
    names = {path.name for path in built_in.iterdir()}
    files = {"report.html", "run.json", "events.jsonl", "graph.yaml"}
    tables = {f"{name}_table.{form}" for name in TABLES for form in ("csv", "tex")}
    drawn = [*(f"{name}_figure" for name in TABLES), "before-and-after", "every-method"]
    figures = {f"{name}.{form}" for name in drawn for form in ("svg", "pdf")}
    assert files | tables | figures <= names
    assert json.loads((built_in / "run.json").read_text())["counts"]["failed"] == 0


def test_the_report_answers_and_cites(built_in: Path) -> None:
    html = (built_in / "report.html").read_text()
    assert "Which method finds impulses, and what does it do to the good samples?" in html
    for cited in ("Scattered data processing", "Vector median filters", "wavelet shrinkage"):
        assert cited in html
    assert 'src="http' not in html


def test_the_rule_of_the_paper_misses_nothing_and_pays_for_it(built_in: Path) -> None:
    missed = means_of(built_in, "impulses-missed")
    wrong = means_of(built_in, "good-samples-repaired")
    error = means_of(built_in, "error-left")
    for share in ("0.5%", "2%"):
        assert missed["impulse", share] == 0.0
        assert missed["without", share] == 1.0
        assert wrong["without", share] == 0.0
        # It takes some 3 or 4 in a hundred good samples for impulses, its rivals hardly any.
        assert 0.02 < wrong["impulse", share] < 0.05
        for rival in DESPIKERS - {"impulse", "redetect", "without"}:
            assert wrong[rival, share] < 0.001
        assert error["redetect", share] < 0.6 * error["impulse", share]
        assert error["impulse", share] < 0.3 * error["without", share]
        assert error["wavelet", share] < 0.2 * error["impulse", share]


def test_smaller_impulses_are_below_what_the_acceleration_finds(studies: Studies) -> None:
    words = ("--axis", "trial=0", "--only", "despike=impulse,acceleration", "--set", "size=2")
    missed = means_of(studies.run("impulses", *words), "impulses-missed")
    assert missed["acceleration", "0.5%"] > 0.9
    assert missed["impulse", "0.5%"] < 0.05


def test_five_lines_join_the_comparison(studies: Studies, tmp_path: Path) -> None:
    (tmp_path / "my_despiker.py").write_text(
        "from nodegraph import node\n"
        "from nodegraph_mocap import Trajectories\n"
        "@node('despike.mine')\n"
        "def mine(recording: Trajectories) -> Trajectories:\n"
        "    return recording\n"
    )
    words = ("--axis", "trial=[8]", "--plugin", "my_despiker.py")
    missed = means_of(studies.run("impulses", *words, folder=tmp_path), "impulses-missed")
    assert {method for method, _ in missed} == DESPIKERS | {"mine"}
    assert missed["mine", "2%"] == 1.0


@needs_recordings
@pytest.mark.parametrize("name", ["animface/jaw.c3d", "vicon/shoulder.c3d", "facecap/take001.c3d"])
def test_real_recordings_end_with_tables(studies: Studies, name: str) -> None:
    words = ("--set", f"recording={DATA / name}", "--axis", "trial=[8]")
    missed = means_of(studies.run("impulses", *words), "impulses-missed")
    assert {method for method, _ in missed} >= DESPIKERS
