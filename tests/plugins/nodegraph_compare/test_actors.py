"""Takes of one actor are one unit: as the names of files say, or as they look."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from contextlib import chdir
from pathlib import Path

import numpy as np
import pytest
from pandas import DataFrame

from nodegraph import Across, Label
from nodegraph.cli.main import main
from nodegraph_compare.blocks import Group, groups
from nodegraph_compare.question import Asked, Question, ask
from nodegraph_files import npz_bytes
from nodegraph_mocap import Table, Trajectories
from nodegraph_synthesize.face import synthesize_face
from nodegraph_tables import TableInfo, poses_of, with_info

GRAPH = """
nodegraph: 1
axes:
  recording: [none.npz]
nodes:
  capture: {use: read.recording, with: {path: $recording}}
  gaps: {use: gaps.cut, in: capture, with: {length: 5, count: 3, seed: [0, $recording]}}
  fill: {in: gaps.gappy, alternatives: [fill.linear, fill.cubic]}
  error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
  table: {use: compare.table, in: error, with: {metric: rmse, compare: fill, blocks: [gap]}}
report: [table]
"""

Fields = Mapping[str, Mapping[Label, Label]]
Answer = Callable[[str], str]


def _take(seed: int, take: int, seconds: float = 1.5) -> Trajectories:
    made = synthesize_face(seconds=seconds, seed=seed, take=take, markers=20, missing=0.0)
    return made.truth


def test_poses_are_the_same_after_the_rounding_of_another_processor() -> None:
    take = _take(1, 0)
    here = take.positions.copy()
    there = here * (1.0 + 1e-14)
    here[:, 0], there[:, 0] = 1e-13, -1e-13
    poses = poses_of(take.markers, here, 60.0)
    assert poses == poses_of(take.markers, there, 60.0)
    assert poses != poses_of(take.markers, here + 0.01, 60.0)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with two takes of each of four actors, and quarters of a take."""
    folder = tmp_path_factory.mktemp("takes")
    (folder / "graph.yaml").write_text(GRAPH)
    whole = _take(5, 0, 8.0)
    takes = {f"p{seed}_{take}": _take(seed, take) for seed in range(4) for take in range(2)}
    for quarter, positions in enumerate(np.split(whole.positions, 4)):
        takes[f"quarter{quarter}"] = Trajectories(
            positions=positions, markers=whole.markers, rate=whole.rate
        )
    for name, take in takes.items():
        (folder / f"{name}.npz").write_bytes(npz_bytes(take))
    return folder


@pytest.fixture
def answer(folder: Path, capsys: pytest.CaptureFixture[str]) -> Answer:
    """Return what runs the study over recordings, and gives all that it prints."""

    def run(recordings: str) -> str:
        graph, out = str(folder / "graph.yaml"), str(folder / "run")
        with chdir(folder):
            words = ("--axis", f"recording={recordings}", "--out", out, "--jobs", "1", "--full")
            assert main(["run", graph, *words]) == 0
        return "".join(capsys.readouterr())

    return run


def test_takes_are_of_the_actors_whom_their_names_say(answer: Answer) -> None:
    text = answer('{files: "{actor}_{take}.npz"}')
    assert re.search(r"over 4 actors|4 actors describe", text)
    assert "look like" not in text


def test_parts_of_a_take_are_no_actors(answer: Answer) -> None:
    text = answer('{files: "quarter*.npz"}')
    assert "quarter0, quarter1, quarter2, quarter3 look like takes of one person" in text
    assert "{actor}_{take}" in text
    assert not re.search(r"over \d recordings|\d recordings describe", text)


def _scores(takes: Mapping[str, Trajectories], fields: Fields) -> Across[Table]:
    """Return two errors of two methods in each recording."""
    entries = []
    for label, take in takes.items():
        for fill in ("linear", "cubic"):
            table = DataFrame({"gap": [0, 1], "rmse": [1.0, 2.0]})
            poses = poses_of(take.markers, take.positions, take.rate)
            info = TableInfo(poses=poses)
            entries.append(({"take": label, "fill": fill}, with_info(table, info)))
    return Across(("take", "fill"), tuple(entries), sources=("take",), fields=fields)


def _asked(scores: Across[Table], clusters: tuple[str, ...] = ()) -> tuple[Question, Group]:
    asked = Asked(metric="rmse", compare="fill", blocks=("gap",), clusters=clusters)
    question = ask(scores, asked)
    (group,) = groups(scores, question)
    return question, group


def test_who_is_who_by_the_graph_and_by_the_looks() -> None:
    other, one, two = (_take(seed, take) for seed, take in ((1, 0), (2, 0), (2, 1)))
    takes = {"a": other, "b": one, "copy of b": one, "c": two}
    question, group = _asked(_scores(takes, {}))
    assert question.clusters == ("take",)
    assert group.cluster.tolist() == [0, 1, 1, 1] * 2  # of each gap
    assert group.recording is not None
    assert group.recording.tolist() == [0, 1, 1, 3] * 2
    assert "behind b, copy of b: it is counted once" in question.alike.warning
    assert "counted as one" in question.alike.warning

    who: Fields = {"take.actor": {"a": "ann", "b": "ben", "copy of b": "cat", "c": "dan"}}
    question, group = _asked(_scores(takes, who))
    assert question.clusters == ("take.actor",)
    assert group.cluster.tolist() == [0, 1, 1, 3] * 2  # dan is not ben, as it is said
    assert "counted as different actors, as the graph says" in question.alike.warning

    who = {
        "take.actor": {"a": 1, "b": 2, "copy of b": 2, "c": 2},
        "take.room": {take: 1 for take in takes},
    }
    question, group = _asked(_scores(takes, who))
    assert not question.alike.warning
    assert len(set(group.cluster)) == 2
    with pytest.raises(ValueError, match="one label"):
        _asked(_scores(takes, who), ("take.room",))
