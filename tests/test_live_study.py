"""The shipped study on a stream: on its recording, the stream gives what the run gives."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import nodegraph as ng
from nodegraph import get_node
from nodegraph_mocap import Trajectories
from tests.studies import ROOT, Studies

GRAPH = ROOT / "graphs" / "live.yaml"
FILLS = ("muscle", "guenter", "lin_ouhyoung", "linear")
WAIT = {"linear": 15}
"""Frames until the end of a gap."""
STREAM: dict[str, int | str] = {"trial": 0, "delay": "15_frames"}
ONLY = [text for axis, label in STREAM.items() for text in ("--only", f"{axis}={label}")]


def test_the_stream_gives_what_the_run_gives(studies: Studies, tmp_path: Path) -> None:
    ended = studies.command(
        "live",
        str(GRAPH),
        *("--source", "recording=replay:sample:face@0", "--sink", "still=file:{fill}.npz"),
        *("--sink", "error=file:{fill}.csv", "--out", "live", *ONLY),
        folder=tmp_path,
    )
    assert ended.status == 0, ended.err
    counts = json.loads((tmp_path / "live" / "live.json").read_text())
    assert (counts["received"], counts["computed"], counts["dropped"]) == (600, 600, 0)

    run = ng.run(GRAPH, only=STREAM, store=studies.store)
    for fill in FILLS:
        streamed = get_node("read.recording")(path=str(tmp_path / f"{fill}.npz"))
        whole: Trajectories = run["still"].at(fill=fill)
        # a marker that is missing in the first frames is filled from later ones in a run only
        alike = (streamed.positions == whole.positions) | ~streamed.present[..., None]
        assert np.array_equal(streamed.present[15:], whole.present[15:])
        assert alike[15:].all()

        # the score is kept current: after the last frame it is that of the run
        rows = list(csv.DictReader((tmp_path / f"{fill}.csv").read_text().splitlines()))
        errors = run["error"].at(fill=fill)
        for name, column in (("rmse", "rmse (mm)"), ("max", "max (mm)"), ("jump", "jump (mm)")):
            last = counts["running"][f"error(trial=0, delay=15_frames, fill={fill})"][name]
            assert float(rows[-1][column]) == last
            assert last == pytest.approx(errors[name].mean(), rel=1e-9)
        assert len(rows) == 600
        assert float(rows[-1]["gaps"]) == len(errors) > float(rows[300]["gaps"])


def test_on_a_stream_it_is_two_frames_behind_and_what_a_fill_waits(
    studies: Studies, tmp_path: Path
) -> None:
    ended = studies.command("check", str(GRAPH), *ONLY, "--live", "60", folder=tmp_path)
    paths = [line for line in ended.out.splitlines() if line.startswith("points > ")]
    assert len(paths) == 2 * len(FILLS)
    for line in paths:
        fill = next(name for name in FILLS if f"fill={name})" in line)
        frames = (1 if "error" in line else 2) + WAIT.get(fill, 0)
        assert f"{1000 * frames / 60:.1f}" in line, ended.out
    assert "not on the stream: table" in ended.out
