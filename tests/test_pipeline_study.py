"""From points without names to an animated head: command line to report."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.studies import DATA, ROOT, Studies, needs_recordings, table

GRAPH = ROOT / "graphs" / "pipeline.yaml"
AS_PRINTED = ROOT / "tests" / "language" / "pipeline.yaml"
CHAIN = ("tracks", "named", "fill", "despike", "smooth")
STEPS = ["captured", "fill", "despike", "smooth"]


def each_step(folder: Path) -> dict[str, dict[str, Any]]:
    """Return the rows of the table by step; numbers as numbers, nothing as NaN."""
    rows = table(folder / "each-step.csv")
    assert [row["step"] for row in rows] == STEPS
    words = ("step", "verdict")
    return {
        row["step"]: {
            name: text if name in words else float(text or "nan") for name, text in row.items()
        }
        for row in rows
    }


def changed(
    folder: Path, *, sources: dict[str, Any], replaced: dict[str, str], **top: object
) -> Path:
    """Write the shipped graph's chain with other sources, and return the file.

    Parameters
    ----------
    sources
        Nodes that stand for `face`.
    replaced
        What the chain reads instead of which output of `face`.
    """
    text = GRAPH.read_text()
    for output, source in replaced.items():
        text = text.replace(f"face.{output}", source)
    nodes = yaml.safe_load(text)["nodes"]
    stages = {"captured": "named", "fill": "fill", "despike": "despike", "smooth": "smooth"}
    truth = replaced.get("truth", "face.truth")
    steps = {"use": "score.steps", "in": {"stages": stages, "truth": truth}}
    graph = {
        "nodegraph": 1,
        **top,
        "nodes": sources | {name: nodes[name] for name in CHAIN} | {"each_step": steps},
        "report": ["each_step"],
    }
    path = folder / "chain.yaml"
    path.write_text(yaml.safe_dump(graph, sort_keys=False))
    return path


@pytest.fixture(scope="module")
def built_in(studies: Studies) -> Path:
    return studies.few("pipeline")


def test_every_step_brings_what_it_changes_nearer_to_the_truth(built_in: Path) -> None:
    steps = each_step(built_in)
    assert [steps[step]["verdict"] for step in STEPS] == ["begins", "adds", "better", "better"]
    for step in ("despike", "smooth"):
        assert steps[step]["after"] < steps[step]["before"]
        assert steps[step]["nearer"] > 0.5
    assert steps["smooth"]["rmse"] < 0.75 * steps["captured"]["rmse"]


def test_the_fill_adds_what_was_missing_and_changes_nothing(built_in: Path) -> None:
    steps = each_step(built_in)
    assert steps["fill"]["added"] == steps["captured"]["missing"] > 1000
    assert steps["fill"]["changed"] == steps["fill"]["missing"] == 0
    assert math.isnan(steps["fill"]["before"])
    assert steps["captured"]["rmse"] < steps["fill"]["added rmse"] < 3.0


def test_figures_playback_and_the_animated_head_are_there(built_in: Path) -> None:
    assert (built_in / "glb" / "animation.glb").read_bytes()[:4] == b"glTF"
    for name in ("fig9.svg", "trajectories.svg", "playback.html"):
        assert (built_in / name).is_file()
    html = (built_in / "report.html").read_text()
    assert "<strong>despike</strong> does most" in html
    assert "face.neutral" in html


def test_on_a_clean_recording_impulse_removal_and_smoothing_make_it_worse(
    studies: Studies, tmp_path: Path
) -> None:
    clean = {"seconds": 3, "noise": 0, "impulses": 0, "missing": 0}
    sources = {"face": {"use": "synthesize.face", "with": clean}}
    folder = studies.run(changed(tmp_path, sources=sources, replaced={}))
    steps = each_step(folder)
    assert [steps[step]["verdict"] for step in STEPS] == ["begins", "nothing", "worse", "worse"]
    assert steps["despike"]["before"] == steps["captured"]["rmse"] == 0.0
    assert "despike and smooth make it worse" in (folder / "printed.txt").read_text()


def test_the_chain_runs_as_the_language_prints_it(studies: Studies) -> None:
    folder = studies.run(AS_PRINTED)
    assert (folder / "fig9.svg").is_file()


@needs_recordings
def test_the_same_chain_on_real_optics_that_were_damaged(studies: Studies, tmp_path: Path) -> None:
    jaw, markers = (DATA / "animface" / name for name in ("jaw.c3d", "markers.yaml"))
    reading = {"path": str(jaw), "marker_set": str(markers)}
    sources = {
        "capture": {"use": "read.recording", "with": reading},
        "noise": {"use": "noise.add", "in": "capture", "with": {"sigma": 0.1}},
        "impulses": {"use": "impulses.add", "in": "noise.noisy"},
        "gaps": {"use": "gaps.cut", "in": "impulses.spiky"},
        "points": {"use": "points.scatter", "in": "gaps.gappy", "with": {"ghosts": 0.002}},
        "rest": {"use": "recording.crop", "in": "capture", "with": {"frames": [[0, 0]]}},
    }
    replaced = {"detections": "points.detections", "neutral": "rest", "truth": "noise.truth"}
    graph = changed(tmp_path, sources=sources, replaced=replaced, known=["rest"])
    steps = each_step(studies.run(graph))
    assert steps["captured"]["missing"] == steps["fill"]["added"] == 20 * 15
    assert steps["captured"]["misplaced"] == 0
    assert steps["captured"]["rmse"] < steps["fill"]["added rmse"] < 1.5
    for step in ("despike", "smooth"):
        assert steps[step]["verdict"] == "better"
    assert steps["smooth"]["rmse"] < 0.5 * steps["captured"]["rmse"]
