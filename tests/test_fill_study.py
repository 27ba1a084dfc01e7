"""The whole walk of one question, as a user takes it: command line to report."""

from __future__ import annotations

import json
import re
from itertools import product
from pathlib import Path

import pytest

from tests.records import read_record
from tests.studies import DATA, ROOT, Studies, command, needs_recordings, table

GRAPH = ROOT / "graphs" / "fill.yaml"
JAW = ("--axis", f"recording={DATA / 'animface' / 'jaw.c3d'}")
FILLS = {"guenter", "lin_ouhyoung", "muscle", "linear"}


def rows_of(folder: Path) -> list[dict[str, str]]:
    return table(folder / "table.csv")


def errors_of(folder: Path) -> dict[tuple[str, str], float]:
    """Return the mean error by method and length."""
    return {(row["fill"], row["length"]): float(row["mean"]) for row in rows_of(folder)}


@pytest.fixture(scope="module")
def built_in(studies: Studies) -> Path:
    """A run on two faces, with two lengths."""
    return studies.few("fill")


def test_the_table_has_every_method_at_every_length(built_in: Path) -> None:
    assert errors_of(built_in).keys() >= set(product(FILLS, ("5", "45")))
    assert all(int(row["blocks"]) > 0 for row in rows_of(built_in))


def test_the_values_that_tuning_chose_are_shown(built_in: Path) -> None:
    rows = {(row["fill"], row["setting"]): row for row in table(built_in / "values.csv")}
    assert rows["ridge", "neighbours"]["as published"] == "12"
    assert {("pca", "singular_values"), ("muscle", "normalize")} <= rows.keys()
    assert not {fill for fill, _ in rows} & {"linear", "cubic"}
    for row in rows.values():
        assert re.fullmatch(r"\S+ \([12] of 2\)", row["length 45"])
    muscle = table(built_in / "neighbours_table.csv")
    assert {row["scores"] for row in muscle} == {"muscle", "guenter", "lin_ouhyoung"}


def test_everything_that_the_walk_promises_is_there(built_in: Path) -> None:
    names = {path.name for path in built_in.iterdir()}
    files = {"report.html", "run.json", "events.jsonl", "graph.yaml", "table.csv", "table.tex"}
    names_of_figures = ("trajectories", "faces", "ranks_figure")
    figures = {f"{name}.{form}" for name in names_of_figures for form in ("svg", "pdf")}
    assert files | figures <= names
    assert (built_in / "graph.yaml").read_text() == GRAPH.read_text()


def test_the_record_agrees_with_the_events(built_in: Path) -> None:
    record = read_record(built_in)
    events = [json.loads(line) for line in (built_in / "events.jsonl").read_text().splitlines()]
    assert record["counts"]["failed"] == 0
    for state in ("done", "stored"):
        assert sum(event["event"] == state for event in events) == record["counts"][state]
    assert record["counts"]["done"] + record["counts"]["stored"] == len(record["steps"])
    cuts = [step for step in record["steps"] if step["node"] == "gaps"]
    assert {(cut["settings"]["length"], cut["labels"]["recording"]) for cut in cuts} == set(
        product((5, 45), ("face_1", "face_2"))
    )
    assert {tuple(cut["settings"]["seed"]) for cut in cuts} == {
        (0, "sample:face_1"),
        (0, "sample:face_2"),
    }


def test_the_report_holds_the_table(built_in: Path) -> None:
    html = (built_in / "report.html").read_text()
    assert "Which method fills the gaps of a face best?" in html
    assert "lin_ouhyoung" in html
    assert "<svg" in html
    assert "Making faces" in html


@needs_recordings
def test_real_recordings_end_with_a_table(studies: Studies) -> None:
    names = ("animface/cheeks.c3d", "vicon/shoulder.c3d", "facecap/take001.c3d")
    takes = ",".join(str(DATA / name) for name in names)
    only = ("--only", "length=15", "--only", "terms=ends_met", "--only", "condition=own_noise")
    fills = ("--only", f"fill={','.join(FILLS)},ridge")
    folder = studies.run("fill", "--axis", f"recording={takes}", *only, *fills)
    assert {fill for fill, _ in errors_of(folder)} >= FILLS


@needs_recordings
def test_on_real_optics_curves_win_short_gaps_and_the_whole_take_long_ones(
    studies: Studies,
) -> None:
    only = (
        "--only",
        "length=5,45",
        "--only",
        "terms=ends_met",
        "--only",
        "condition=own_noise",
    )
    errors = errors_of(studies.run("fill", *JAW, *only, "--until", "table"))
    alone = [cell for cell in errors if cell[0] not in {"gaussian_process", "kriging"}]
    best = {
        length: min((cell for cell in alone if cell[1] == length), key=lambda cell: errors[cell])
        for length in ("5", "45")
    }
    assert best["5"][0] == "cubic"
    assert best["45"][0] in {"soft_impute", "subspace_kalman", "ridge", "bilinear"}
    assert errors["cubic", "45"] > 1.5 * errors[best["45"]]
    # kriging takes from a marker's own course as well as from others
    assert all(errors["kriging", length] < errors[best[length]] for length in best)


def test_a_file_that_cannot_be_read_is_a_failed_step(tmp_path: Path) -> None:
    (tmp_path / "bad.c3d").write_bytes(b"\x02\x50" + bytes(30))
    (tmp_path / "empty.c3d").write_bytes(b"")
    words = ("--axis", "recording=bad.c3d,empty.c3d", "--only", "length=5")
    ended = command("run", str(GRAPH), *words, folder=tmp_path)
    assert ended.status == 1
    assert "failed: capture" in ended.err
    assert "bad.c3d" in ended.err
    assert "empty" in ended.err
    assert (tmp_path / "runs" / "fill" / "report.html").is_file()


def test_a_file_that_is_not_there_is_a_wrong_command(tmp_path: Path) -> None:
    ended = command("run", str(GRAPH), "--axis", "recording=nowhere.c3d", folder=tmp_path)
    assert ended.status == 2
    assert "nowhere.c3d" in ended.err
    assert not (tmp_path / "runs").exists()
