"""The whole walk of one question, as a user takes it: command line to report."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest

from nodegraph.plugin.registry import Registry

ROOT = Path(__file__).parents[1]
DATA = ROOT.parent / "shared" / "data"
GRAPH = ROOT / "graphs" / "fill.yaml"
FILLS = {"guenter", "lin_ouhyoung", "muscle", "waters", "linear"}

needs_recordings = pytest.mark.skipif(not DATA.is_dir(), reason="the recordings are not here")


def nodegraph(*words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "nodegraph.cli.main", *words]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert "Traceback" not in done.stderr
    return done


def rows_of(folder: Path) -> list[dict[str, str]]:
    with (folder / "table.csv").open() as file:
        return list(csv.DictReader(file))


def errors_of(folder: Path) -> dict[tuple[str, str], float]:
    return {(row["fill"], row["length"]): float(row["rms"]) for row in rows_of(folder)}


@pytest.fixture(scope="module")
def built_in(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run on built-in data, with two trials of two lengths."""
    folder = tmp_path_factory.mktemp("walk")
    words = ["--axis", "trial=0,1", "--only", "length=5,45", "--store", "store"]
    done = nodegraph("run", str(GRAPH), *words, folder=folder)
    assert done.returncode == 0, done.stderr
    assert done.stdout.rstrip().endswith("report.html")
    return folder / "runs" / "fill"


def test_the_table_has_every_method_at_every_length(built_in: Path) -> None:
    found = {(row["fill"], row["length"]) for row in rows_of(built_in)}
    assert {(fill, length) for fill in FILLS for length in ("5", "45")} <= found
    assert all(int(row["blocks"]) > 0 for row in rows_of(built_in))


def test_everything_that_the_walk_promises_is_there(built_in: Path) -> None:
    names = {path.name for path in built_in.iterdir()}
    files = {"report.html", "run.json", "events.jsonl", "graph.yaml", "table.csv", "table.tex"}
    names_of_figures = ("trajectories", "faces", "ranks_figure")
    figures = {f"{name}.{form}" for name in names_of_figures for form in ("svg", "pdf")}
    assert files | figures <= names
    assert (built_in / "graph.yaml").read_text() == GRAPH.read_text()


def test_the_record_agrees_with_the_events(built_in: Path) -> None:
    record = json.loads((built_in / "run.json").read_text())
    events = [json.loads(line) for line in (built_in / "events.jsonl").read_text().splitlines()]
    assert record["counts"]["failed"] == 0
    settled = [event for event in events if event["event"] == "done"]
    assert len(settled) == record["counts"]["done"] == len(record["steps"])
    cuts = [step for step in record["steps"] if step["node"] == "gaps"]
    assert {(one["settings"]["length"], one["settings"]["seed"]) for one in cuts} == {
        (length, seed) for length in (5, 45) for seed in (0, 1)
    }


def test_the_report_holds_the_table_and_fetches_nothing(built_in: Path) -> None:
    html = (built_in / "report.html").read_text()
    assert "Which method fills the gaps of a face best?" in html
    assert "lin_ouhyoung" in html
    assert "<svg" in html
    assert "Making faces" in html
    assert 'src="http' not in html


def test_a_second_run_moves_the_first_aside(built_in: Path) -> None:
    before = (built_in / "table.csv").read_bytes()
    words = ("run", str(GRAPH), "--axis", "trial=[0, 1]", "--only", "length=5,45", "--jobs", "1")
    done = nodegraph(*words, "--executor", "serial", folder=built_in.parents[1])
    assert done.returncode == 0
    moved = [path for path in built_in.parent.iterdir() if path.name.startswith("fill-")]
    assert [(one / "table.csv").read_bytes() for one in moved] == [before]
    assert (built_in / "table.csv").read_bytes() == before


def test_five_lines_join_the_comparison(tmp_path: Path) -> None:
    (tmp_path / "my_fill.py").write_text(
        "from nodegraph import node\n"
        "from nodegraph_mocap import Trajectories\n"
        "@node('fill.mine')\n"
        "def mine(recording: Trajectories) -> Trajectories:\n"
        "    return recording\n"
    )
    words = ("--axis", "trial=0", "--only", "length=5", "--plugin", "my_fill.py")
    done = nodegraph("run", str(GRAPH), *words, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    installed = set(Registry.installed().family("fill"))
    assert installed >= FILLS
    assert {row["fill"] for row in rows_of(tmp_path / "runs" / "fill")} == installed | {"mine"}


@needs_recordings
@pytest.mark.parametrize(
    "name", ["animface/jaw.c3d", "animface/cheeks.c3d", "vicon/shoulder.c3d", "facecap/take001.c3d"]
)
def test_real_recordings_end_with_a_table(name: str, tmp_path: Path) -> None:
    words = ("--set", f"recording={DATA / name}", "--axis", "trial=0", "--only", "length=5,15")
    done = nodegraph("run", str(GRAPH), *words, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert {fill for fill, _ in errors_of(tmp_path / "runs" / "fill")} >= FILLS


@needs_recordings
def test_three_neighbours_on_jaw_reach_the_error_that_is_expected(tmp_path: Path) -> None:
    words = ("--set", f"recording={DATA / 'animface' / 'jaw.c3d'}", "--only", "fill=muscle,linear")
    done = nodegraph("run", str(GRAPH), *words, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    errors = errors_of(tmp_path / "runs" / "fill")
    for length, expected in (("5", 0.27), ("15", 0.63), ("45", 1.03)):
        assert errors["muscle", length] == pytest.approx(expected, rel=0.25)
    # a short gap belongs to the marker's own trajectory, a long one to its neighbours
    assert errors["linear", "5"] < errors["muscle", "5"]
    assert errors["linear", "45"] > errors["muscle", "45"]


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda path: path.write_bytes(b""), "empty"),
        (lambda path: path.write_bytes(b"not a recording at all, not even nearly"), "bad.c3d"),
        (lambda path: path.write_bytes(b"\x02\x50" + bytes(30)), "bad.c3d"),
    ],
)
def test_a_file_that_cannot_be_read_is_a_failed_step(
    make: object, said: str, tmp_path: Path
) -> None:
    path = tmp_path / "bad.c3d"
    assert callable(make)
    make(path)
    words = ("--set", "recording=bad.c3d", "--axis", "trial=0")
    done = nodegraph("run", str(GRAPH), *words, folder=tmp_path)
    assert done.returncode == 1
    assert "failed: capture" in done.stderr
    assert said in done.stderr
    assert (tmp_path / "runs" / "fill" / "report.html").is_file()


def test_a_file_that_is_not_there_is_a_wrong_command(tmp_path: Path) -> None:
    done = nodegraph("run", str(GRAPH), "--set", "recording=nowhere.c3d", folder=tmp_path)
    assert done.returncode == 2
    assert "nowhere.c3d" in done.stderr
    assert not (tmp_path / "runs").exists()


@needs_recordings
def test_on_real_optics_curves_win_short_gaps_and_the_whole_take_long_ones(tmp_path: Path) -> None:
    words = ["--set", f"recording={DATA / 'animface' / 'jaw.c3d'}", "--axis", "trial=[0, 1, 2, 3]"]
    done = nodegraph("run", str(GRAPH), *words, "--only", "length=5,45", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    errors = errors_of(tmp_path / "runs" / "fill")
    best = {
        length: min((one for one in errors if one[1] == length), key=lambda one: errors[one])[0]
        for length in ("5", "45")
    }
    assert best["5"] == "cubic"
    assert best["45"] in {"soft_impute", "kalman", "ridge", "bilinear"}
    assert errors["cubic", "45"] > 1.5 * errors[best["45"], "45"]
