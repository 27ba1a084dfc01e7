"""Head motion or speech: what PCA finds after each alignment, command line to tables."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.studies import DATA, Studies, needs_recordings, table

ALIGNED = ("stable", "stable_to_mean", "all_points", "all_points_huber", "all_points_trimmed")
WAYS = ("not_aligned", *ALIGNED)
KINDS = ("speech at 30 Hz", "scans at 1 Hz")


def found_first(folder: Path, kind: str) -> dict[tuple[str, int], dict[str, str]]:
    """Return the rows of what PCA finds, by alignment and component."""
    (path,) = folder.glob(f"found-first_data-{kind.replace(' ', '-')}-*.csv")
    rows = table(path)
    return {(row["align"], int(row["component"])): row for row in rows}


def found_in_recording(folder: Path) -> list[dict[str, str]]:
    """Return the rows of what PCA finds in the recording that was read."""
    (path,) = folder.glob("found-in-recording*.csv")
    return table(path)


@pytest.fixture(scope="module")
def built_in(studies: Studies) -> Path:
    """A run on built-in data, with two actors."""
    return studies.few("alignment")


def test_it_says_what_was_aligned(built_in: Path) -> None:
    text = " ".join((built_in / "printed.txt").read_text().split())
    assert "2 synthetic recordings, 30 s, 60 to 150 markers, 1 to 30 Hz: " in text


@pytest.mark.parametrize("kind", KINDS)
def test_captured_most_is_head_motion_and_aligned_next_to_nothing(
    built_in: Path, kind: str
) -> None:
    result = found_first(built_in, kind)
    assert {way for way, _ in result} == set(WAYS)
    assert float(result["not_aligned", 1]["in all"]) > 0.5
    assert "head motion" in {result["not_aligned", rank]["finds"] for rank in (1, 2, 3)}
    for way in ALIGNED:
        # what a robust fit leaves works against the face, by which it was held off
        least = -0.1 if way == "all_points_huber" else -0.02
        assert least < float(result[way, 1]["in all"]) < 0.02
        assert {result[way, rank]["finds"] for rank in (1, 2, 3)} == {"face"}


@pytest.mark.parametrize("kind", KINDS)
def test_all_points_take_speech_for_head_motion(built_in: Path, kind: str) -> None:
    for quantity in ("turn", "shift"):
        error = {
            row["align"]: float(row["mean"])
            for row in table(built_in / f"{quantity}-error_table.csv")
            if row["data"] == kind
        }
        assert error["not_aligned"] > 2 * error["all_points"] > 6 * error["stable"]
        assert error["all_points"] > 1.5 * error["all_points_huber"]
        assert error["all_points_huber"] > 1.5 * error["all_points_trimmed"]
        assert error["stable"] == pytest.approx(error["stable_to_mean"], rel=0.02)
    result = found_first(built_in, kind)
    assert float(result["all_points", 1]["sd"]) < 0.9 * float(result["stable", 1]["sd"])


def test_the_answer_says_which_data_it_is_about(built_in: Path) -> None:
    html = (built_in / "report.html").read_text()
    for kind in KINDS:
        assert f"data {kind}" in html
        assert [*built_in.glob(f"found-first-drawn_data-{kind.replace(' ', '-')}-*.svg")]
    assert "D = " in (built_in / "shapes.svg").read_text()


def test_the_recording_is_judged_by_the_head_motion_found_in_it(built_in: Path) -> None:
    result = {row["own_align"]: float(row["in all"]) for row in found_in_recording(built_in)}
    assert result["not_aligned"] > 0.4
    assert result["stable"] == 0.0


@needs_recordings
def test_on_a_performance_with_known_head_motion_the_findings_hold(studies: Studies) -> None:
    take = DATA / "facecap" / "take001.c3d"
    words = ["--axis", f"recording={take}", "--until", "found_in_recording"]
    rows = found_in_recording(studies.run("alignment", *words))
    result = {(row["own_align"], int(row["component"])): row for row in rows}
    # by the true rotations and translations of that take it is 0.43
    assert float(result["not_aligned", 1]["in all"]) == pytest.approx(0.43, abs=0.05)
    assert result["not_aligned", 2]["finds"] == "head motion"
    # the head moves with the face: what goes with it is not made by it
    assert float(result["stable", 1]["R"]) > 0.8
    assert result["stable", 1]["finds"] == "face"
