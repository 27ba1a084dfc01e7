"""The walk of the question about impulses, as a user takes it: command line to report."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
DATA = ROOT.parent / "shared" / "data"
GRAPH = ROOT / "graphs" / "impulses.yaml"
DESPIKERS = {"impulse", "redetect", "hampel", "median", "acceleration", "wavelet", "without"}
TABLES = ("error-left", "impulses-missed", "good-samples-repaired")
FEW = ("--axis", "trial=[0, 1, 8]")

needs_recordings = pytest.mark.skipif(not DATA.is_dir(), reason="the recordings are not here")


def nodegraph(*words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "nodegraph.cli.main", *words]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert "Traceback" not in done.stderr
    return done


def means_of(folder: Path, table: str) -> dict[tuple[str, str], float]:
    with (folder / f"{table}_table.csv").open() as file:
        return {(row["despike"], row["hit"]): float(row["mean"]) for row in csv.DictReader(file)}


@pytest.fixture(scope="module")
def built_in(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run on built-in data, with three trials."""
    folder = tmp_path_factory.mktemp("walk")
    done = nodegraph("run", str(GRAPH), *FEW, "--store", "store", folder=folder)
    assert done.returncode == 0, done.stderr
    assert done.stdout.rstrip().endswith("report.html")
    return folder / "runs" / "impulses"


@pytest.mark.parametrize("table", TABLES)
def test_the_tables_have_every_method_at_every_share(built_in: Path, table: str) -> None:
    expected = {(method, share) for method in DESPIKERS for share in ("0.5%", "2%")}
    assert set(means_of(built_in, table)) >= expected


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


def test_smaller_impulses_are_below_what_the_acceleration_finds(tmp_path: Path) -> None:
    words = ("--axis", "trial=0", "--only", "despike=impulse,acceleration", "--set", "size=2")
    done = nodegraph("run", str(GRAPH), *words, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    missed = means_of(tmp_path / "runs" / "impulses", "impulses-missed")
    assert missed["acceleration", "0.5%"] > 0.9
    assert missed["impulse", "0.5%"] < 0.05


def test_five_lines_join_the_comparison(tmp_path: Path) -> None:
    (tmp_path / "my_despiker.py").write_text(
        "from nodegraph import node\n"
        "from nodegraph_mocap import Trajectories\n"
        "@node('despike.mine')\n"
        "def mine(recording: Trajectories) -> Trajectories:\n"
        "    return recording\n"
    )
    words = ("--axis", "trial=[8]", "--plugin", "my_despiker.py")
    done = nodegraph("run", str(GRAPH), *words, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    missed = means_of(tmp_path / "runs" / "impulses", "impulses-missed")
    assert {method for method, _ in missed} == DESPIKERS | {"mine"}
    assert missed["mine", "2%"] == 1.0


@needs_recordings
@pytest.mark.parametrize("name", ["animface/jaw.c3d", "vicon/shoulder.c3d", "facecap/take001.c3d"])
def test_real_recordings_end_with_tables(name: str, tmp_path: Path) -> None:
    words = ("--set", f"recording={DATA / name}", "--axis", "trial=[8]")
    done = nodegraph("run", str(GRAPH), *words, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    missed = means_of(tmp_path / "runs" / "impulses", "impulses-missed")
    assert {method for method, _ in missed} >= DESPIKERS
