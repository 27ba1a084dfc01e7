"""The study of the conditions on which the best fill depends."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.records import read_record
from tests.studies import Studies, table

CONDITIONS = {
    "no noise",
    "0.03 mm noise below 8 Hz",
    "0.1 mm noise below 6 Hz",
    "0.1 mm white noise",
    "0.5 % impulses",
    "0.5 % impulses repaired",
}


@pytest.fixture(scope="module")
def built_in(studies: Studies) -> Path:
    """A run on two actors, with gaps of 15 frames."""
    return studies.few("fill_conditions")


@pytest.fixture(scope="module")
def errors(built_in: Path) -> dict[str, dict[str, float]]:
    """The mean error of each method by condition."""
    by_condition: dict[str, dict[str, float]] = {name: {} for name in CONDITIONS}
    for row in table(built_in / "table.csv"):
        if row["condition"]:
            by_condition[row["condition"]][row["fill"]] = float(row["mean"])
    return by_condition


def test_nothing_fails_or_is_refused(built_in: Path) -> None:
    counts = read_record(built_in)["counts"]
    assert counts["failed"] == 0
    assert counts["refused"] == 0


def test_white_noise_makes_the_cubic_the_last_and_a_filter_does_not(
    errors: dict[str, dict[str, float]],
) -> None:
    for condition in CONDITIONS - {"0.1 mm white noise", "0.5 % impulses"}:
        assert errors[condition]["cubic"] < 1.2 * errors[condition]["linear"]
    assert errors["0.1 mm white noise"]["cubic"] == max(errors["0.1 mm white noise"].values())
    assert errors["0.1 mm white noise"]["cubic"] > 2.0 * errors["0.1 mm white noise"]["linear"]


def test_repair_after_the_cut_takes_back_most_of_what_impulses_do(
    errors: dict[str, dict[str, float]],
) -> None:
    without, hit, repaired = (
        errors[name]
        for name in ("0.03 mm noise below 8 Hz", "0.5 % impulses", "0.5 % impulses repaired")
    )
    for fill in ("ridge", "soft_impute", "cubic", "muscle"):
        assert repaired[fill] - without[fill] < 0.5 * (hit[fill] - without[fill])


def test_one_method_does_for_who_does_not_know_the_condition(
    errors: dict[str, dict[str, float]],
) -> None:
    worst = {
        fill: max(of[fill] / min(of.values()) for of in errors.values())
        for fill in errors["no noise"]
    }
    assert min(worst, key=worst.__getitem__) == "kriging"
    assert worst["kriging"] < 1.25


def test_the_report_asks_what_it_answers(built_in: Path) -> None:
    html = (built_in / "report.html").read_text()
    assert "Do noise and impulses decide which fill is best?" in html
    assert "kriging" in html
    assert "How the faces move, beside people" in html
