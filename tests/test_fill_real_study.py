"""The shipped study on takes of people: its own, where they were fetched, and a user's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from nodegraph import get_node
from tests.studies import ROOT, Studies, command, needs_fetched, table

GRAPH = ROOT / "graphs" / "fill_real.yaml"
FEW = ("--only", "fill=linear,cubic,muscle", "--only", "length=5,45")


def means(folder: Path) -> dict[tuple[str, ...], float]:
    """Return the mean error by method, condition and length."""
    names = ("fill", "condition", "length")
    return {tuple(row[n] for n in names): float(row["mean"]) for row in table(folder / "table.csv")}


@needs_fetched("fill_real")
def test_it_speaks_of_the_takes_of_one_actor_only(studies: Studies) -> None:
    folder = studies.run("fill_real", *FEW)
    printed = (folder / "printed.txt").read_text()
    assert "4 recordings of one actor, 15" in printed
    assert "holds for further gaps in these 4 recordings, not for others" in printed
    error = means(folder)
    filtered, noisy = (
        {fill: error[fill, condition, "5"] for fill in ("linear", "cubic")}
        for condition in ("as published", "0.1 mm noise")
    )
    # what the author's low-pass gives to curves, a little noise takes
    assert filtered["cubic"] < 0.5 * filtered["linear"]
    assert noisy["cubic"] > noisy["linear"]


def test_takes_of_a_users_people_are_counted_by_person(studies: Studies, tmp_path: Path) -> None:
    for person in ("anna", "ben", "chris"):
        face = get_node("synthesize.face")(seconds=8, markers=20, seed=len(person)).truth
        for take, frames in (("smile", slice(240)), ("speech", slice(240, None))):
            positions = face.positions[frames].reshape(240, -1)
            names = ",".join(f"{marker}:{axis}" for marker in face.markers for axis in "XYZ")
            file = tmp_path / f"{person}_{take}.csv"
            np.savetxt(file, positions, delimiter=",", header="# rate: 60\n" + names, comments="")
    takes = f'recording={{files: "{tmp_path}/{{actor}}_{{take}}.csv"}}'
    few = ("--only", "fill=linear,ensemble", "--only", "length=5,45", "--only", "trial=0")
    folder = studies.run("fill_real", "--axis", takes, *few, "--until", "table")
    assert (
        "3 actors describe the methods and decide nothing" in (folder / "printed.txt").read_text()
    )
    error = means(folder)
    # what an average of fills from other markers is worth
    assert error["ensemble", "as published", "45"] < 0.7 * error["linear", "as published", "45"]


def test_without_its_takes_it_says_how_to_get_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    ended = command("run", str(GRAPH), folder=tmp_path)
    assert ended.status == 2
    assert "JawMoCap.ma has not been fetched; `nodegraph fetch`" in ended.err
