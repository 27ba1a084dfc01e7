"""How many of 60 markers are enough: command line to curves and faces."""

from __future__ import annotations

import itertools
import json
import warnings
from pathlib import Path
from statistics import median

import pytest

import nodegraph as ng
from nodegraph.plan import plan
from nodegraph_files import sample_folder
from tests.records import read_record
from tests.studies import DATA, ROOT, Studies, needs_recordings, table

GRAPH = ROOT / "graphs" / "marker_selection.yaml"
AS_PRINTED = ROOT / "tests" / "language" / "marker_selection.yaml"
ACTORS = ("ME", "MB", "JZ")
FACES = ("face_1", "face_2", "face_3")

Row = dict[str, str]


def rows(folder: Path) -> dict[str, list[Row]]:
    """The points of each actor."""
    every = table(folder / "fig2_table.csv")
    return {
        actor: [row for row in every if row["actor"] == actor]
        for actor in dict.fromkeys(row["actor"] for row in every)
    }


def curve(points: list[Row]) -> dict[int, float]:
    """The lowest error for each number of markers."""
    result: dict[int, float] = {}
    for row in points:
        markers, error = int(row["markers"]), float(row["mse"])
        result[markers] = min(error, result.get(markers, error))
    return dict(sorted(result.items()))


def minima(points: list[Row]) -> list[int]:
    triples = zip(
        *(itertools.islice(curve(points).items(), i, None) for i in range(3)), strict=False
    )
    return [x for (_, before), (x, here), (_, after) in triples if before > here < after]


def marked(points: list[Row]) -> list[tuple[int, str]]:
    return [(int(row["markers"]), row["marked"]) for row in points if row["marked"]]


def check_marks(folder: Path) -> None:
    """What is marked and said is what a plain search of the table finds."""
    result = rows(folder)
    low = {actor: minima(points) for actor, points in result.items()}
    shared = [
        x
        for x in sorted(itertools.chain(*low.values()))
        if all(any(abs(x - other) <= 2 for other in value) for value in low.values())
    ]
    text = (folder / "printed.txt").read_text()
    kinds = {kind for points in result.values() for _, kind in marked(points)}
    found = sum(bool(marked(points)) for points in result.values())
    if shared:
        assert f"have a minimum within 2 of {shared[0]} markers" in text
        assert kinds == {"shared"}
        assert all(abs(marked(points)[0][0] - shared[0]) <= 2 for points in result.values())
    elif kinds:
        assert kinds == {"knee"}
        some = f"{found} of {len(result)} curves"
        count = some if found < len(result) else f"all {found} curves"
        knees = sorted(marked(points)[0][0] for points in result.values() if marked(points))
        if knees[0] < knees[-1]:
            count = f"median; {knees[0]} to {knees[-1]} in {count}"
        assert f"From {median(knees):g} markers on, more of them help less ({count})" in text
    else:
        assert "Neither a minimum nor a knee to mark" in text
    assert all(len(marked(points)) <= 1 for points in result.values())


@pytest.fixture(scope="module")
def built_in(studies: Studies) -> Path:
    """A run on built-in data, with three numbers of markers."""
    return studies.few("marker_selection")


def test_it_says_what_the_weights_are_of(built_in: Path) -> None:
    text = " ".join((built_in / "printed.txt").read_text().split())
    assert "3 curves of synthetic recordings (12 s, 60 markers, 60 Hz): others may differ; " in text


def test_fewer_markers_cost_more_and_every_actor_has_a_floor(built_in: Path) -> None:
    result = rows(built_in)
    assert tuple(result) == FACES
    for points in result.values():
        assert len(points) == 3
        errors = list(curve(points).values())
        assert errors[-1] == min(errors)
        (floor,) = {float(row["floor"]) for row in points}
        assert 0 < floor < errors[0] / 10
        for row in points:
            assert (row["below floor"] == "True") == (float(row["mse"]) <= floor)


def test_what_is_marked_is_what_a_plain_search_finds(built_in: Path) -> None:
    check_marks(built_in)


def test_the_faces_are_those_with_the_fewest_markers_that_are_enough(built_in: Path) -> None:
    html = (built_in / "report.html").read_text()
    points = table(built_in / "how-few_table.csv")
    marks = [row for row in points if row["marked"]]
    assert marks
    for row in marks:
        assert float(row["rmse"]) <= 0.05
        fewer = [each for each in points if each["actor"] == row["actor"]]
        fewer = [each for each in fewer if int(each["markers"]) < int(row["markers"])]
        assert all(float(each["rmse"]) > 0.05 for each in fewer)
        assert f"{row['actor']}, k {row['k']}" in html
        assert f"{row['markers']} of 60 markers" in html
    assert "weights of expressions (0 to 1) are solved that err by at most" in html


def test_rivals_and_errors_at_markers_left_out_are_in_the_report(built_in: Path) -> None:
    names = {path.name for path in built_in.glob("*.svg")}
    assert names == {
        *("fig1.svg", "fig2_figure.svg", "how-few_figure.svg", "against-chance_figure.svg"),
    }
    for name in ("against-chance_table.csv", "left-out_table.csv"):
        rows = table(built_in / name)
        means = [(row["chosen_on"], row["k"], row["chosen"]) for row in rows]
        every = (("own", "another_actor"), ("10", "20", "40"), ("random", "qr", "pfa"))
        assert set(means) >= set(itertools.product(*every))
        assert {mean[:2] for mean in means} == set(itertools.product(*every[:2]))
    assert "What the text claims" in (built_in / "report.html").read_text()


def test_rivals_choose_as_many_markers(built_in: Path) -> None:
    one = {"actor": ["face_1"], "chosen_on": ["own"]}
    run = ng.run(GRAPH, only=one, axis={"k": [10], "seed": [0]})
    sizes = {labels["chosen"]: len(selection.chosen) for labels, selection in run["chosen"]}
    assert max(sizes.values()) - min(sizes.values()) <= 1


def test_the_graph_of_the_language_plans_shared_steps_once() -> None:
    graph = ng.load(AS_PRINTED)
    planned = plan(graph)
    steps = {name: len(set(cells.values())) for name, cells in planned.cells.items()}
    per_actor = dict.fromkeys(("capture", "model", "face", "complete"), len(ACTORS))
    per_size = dict.fromkeys(("chosen", "kept", "selected", "mse"), len(ACTORS) * 12)
    assert steps == {**per_actor, **per_size, "fig2": 1}
    assert graph.nodes["fig2"].gathered == ("actor", "k")
    assert graph.axes["k"].labels == tuple(range(5, 61, 5))
    first = next(step for step in planned.steps if step.node == "chosen")
    assert first.settings["k"] == 5


def test_the_graph_of_the_language_runs_as_it_is_printed(studies: Studies) -> None:
    folder = studies.run(AS_PRINTED, "--axis", "k=10,30,50")
    result = rows(folder)
    assert tuple(result) == ACTORS
    assert "floor" not in result["ME"][0]
    check_marks(folder)


def test_an_actor_whose_take_has_long_gaps_is_refused_and_the_others_are_drawn(
    studies: Studies,
) -> None:
    other = {"model": "sample:face", "other": "sample:actor_b"}
    actors = {
        "ME": {**other, "rec": "sample:actor_a", "model": "sample:actor_a"},
        "gappy": {**other, "rec": str(sample_folder("face") / "recording.c3d")},
    }
    words = ("--axis", f"actor={json.dumps(actors)}", "--axis", "k=10,30", "--axis", "seed=0")
    folder = studies.run("marker_selection", *words, "--set", "runs=5")
    assert tuple(rows(folder)) == ("ME",)
    text = (folder / "printed.txt").read_text()
    assert "combinations refused" in text
    assert "gappy" in text


@pytest.fixture(scope="module")
def performers(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """Two recorded performances on a face with markers, as C3D, and one that is there already."""
    folder = tmp_path_factory.mktemp("performers")
    path = DATA / "facecap" / "model_60_markers.npz"
    model = ng.get_node("read.model")(path=path).model
    for name, file in (("a", "actor_a_60fps.csv"), ("b", "actor_b_30fps.csv")):
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", ".*the timecode skips|.*lack a weight")
            weights = ng.get_node("read.weights")(path=DATA / "livelink" / file)
            posed = ng.get_node("blendshapes.pose")(weights, model)
        (content,) = ng.get_node("write.c3d")(posed).content.values()
        (folder / f"{name}.c3d").write_bytes(content)
    files = (("A", "a.c3d"), ("B", "b.c3d"), ("C", DATA / "facecap" / "take001.c3d"))
    actors = {
        name: {"rec": str(file), "model": str(path), "other": str(other)}
        for (name, file), (_, other) in zip(files, (*files[1:], files[0]), strict=True)
    }
    return folder, json.dumps(actors)


@needs_recordings
def test_three_performers_have_their_curves_floors_and_marks(
    studies: Studies, performers: tuple[Path, str]
) -> None:
    folder, actors = performers
    words = ("--axis", f"actor={actors}", "--axis", "k=10,40", "--axis", "seed=0")
    until = ("--set", "runs=30", "--until", "fig2")
    result = studies.run("marker_selection", *words, *until, folder=folder)
    outcome = rows(result)
    assert tuple(outcome) == ("A", "B", "C")
    for points in outcome.values():
        assert len(points) == 2
        assert 1e-4 < float(points[0]["floor"]) < 2e-2
        assert float(points[0]["mse"]) > float(points[-1]["mse"])
    check_marks(result)
    steps = read_record(result)["steps"]
    sentences = {
        step["node"]: " ".join(step.get("warnings", ()))
        for step in steps
        if step["labels"] == {"actor": "B"}
    }
    assert "stable landmarks" in sentences["face.take.marked"]
    assert sentences["face.still"] == ""  # three frames without markers are closed before
