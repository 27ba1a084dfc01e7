"""The shipped study of published errors: its own masks, where they were fetched, and a user's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from nodegraph_files import npz_bytes
from nodegraph_mocap import Trajectories
from tests.studies import ROOT, Studies, command, needs_fetched, table

GRAPH = ROOT / "graphs" / "fill_published.yaml"
LEARNT = ("half in training", "none in training")


def number(text: str) -> float:
    """Return the number that a label has before `mm`."""
    return float(text.split()[-2])


@needs_fetched("fill_published")
def test_least_squares_has_the_published_error_of_each_mask(studies: Studies) -> None:
    folder = studies.run("fill_published", "--only", "fill=least_squares,ridge")
    every = table(folder / "masks_table.csv")
    rows = [row for row in every if row["fill"] == "least_squares"]
    assert len(rows) == 15
    for row in rows:
        assert float(row["mean"]) == pytest.approx(number(row["mask"]), rel=0.03)
    error = {
        (row["fill"], row["learnt"], row["mask.missing"]): float(row["mean"])
        for row in table(folder / "table.csv")
    }
    every_missing = {missing for *_, missing in error}
    assert len(every_missing) == 3
    for missing in every_missing:
        published, other = (error["least_squares", learnt, missing] for learnt in LEARNT)
        # what was learnt from the tested frames themselves
        assert published < 0.75 * other
        assert error["ridge", "none in training", missing] < 0.9 * other


def body(frames: int = 1850, markers: int = 12) -> Trajectories:
    """Return a movement of which all markers together follow from few."""
    random = np.random.default_rng(5)
    time = np.arange(frames)[:, None] / 120.0
    sources = np.sin(time * random.uniform(1.0, 9.0, 7) + random.uniform(0.0, 6.0, 7))
    positions = 800.0 * random.normal(size=3 * markers) + sources @ (
        40.0 * random.normal(size=(7, 3 * markers))
    )
    positions += random.normal(scale=0.1, size=positions.shape)
    return Trajectories(
        positions=positions.reshape(frames, markers, 3),
        markers=tuple(f"m{place}" for place in range(markers)),
        rate=120.0,
    )


def test_a_users_take_and_masks_take_the_place_of_the_published(
    studies: Studies, tmp_path: Path
) -> None:
    (tmp_path / "take.npz").write_bytes(npz_bytes(body()))
    for missing, place in ((1, 2), (1, 7), (2, 4)):
        kept = np.ones((400, 12), dtype=bool)
        kept[10 : 380 - place, place : place + missing] = False
        file = tmp_path / "masks" / f"{missing}" / f"{place}.txt"
        file.parent.mkdir(parents=True, exist_ok=True)
        np.savetxt(file, np.repeat(kept, 3, axis=1), fmt="%d")
    folder = studies.run(
        "fill_published",
        *("--set", f"recording={tmp_path}/take.npz"),
        *("--axis", f'mask={{files: "{tmp_path}/masks/{{missing}}/{{number}}.txt"}}'),
        *("--only", "fill=least_squares,ridge", "--until", "table"),
    )
    rows = table(folder / "table.csv")
    assert {row["mask.missing"] for row in rows} == {"1", "2"}
    for row in rows:
        # a coordinate's noise has a mean size of 0.08 mm
        assert 0.05 < float(row["mean"]) < 0.3, row


def test_without_its_masks_it_says_how_to_get_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    ended = command("run", str(GRAPH), folder=tmp_path)
    assert ended.status == 2
    assert "135_02.c3d has not been fetched; `nodegraph fetch`" in ended.err
