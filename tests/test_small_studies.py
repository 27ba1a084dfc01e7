"""What the studies of fills, of their order with other steps and of delays find, on two actors."""

from __future__ import annotations

import pytest

from tests.records import read_record
from tests.studies import Studies, table

IMPULSES = "0.1 mm noise and 0.5 % impulses"


def errors(
    studies: Studies, name: str, *columns: str, file: str = "table"
) -> dict[tuple[str, ...], float]:
    """Return the mean error by the labels in some columns, of rows that have all of them."""
    rows = table(studies.few(name) / f"{file}.csv")
    of = {tuple(row[column] for column in columns): float(row["mean"]) for row in rows}
    return {labels: mean for labels, mean in of.items() if all(labels)}


@pytest.mark.parametrize("name", ["fill_conditions", "fill_occlusions", "live_price", "step_order"])
def test_nothing_fails_or_is_refused(studies: Studies, name: str) -> None:
    counts = read_record(studies.few(name))["counts"]
    assert (counts["failed"], counts["refused"]) == (0, 0)


@pytest.mark.parametrize("occlusion", ["1 marker", "4 markers", "12 markers"])
def test_what_learns_from_the_take_errs_less_than_what_knows_only_the_frame(
    studies: Studies, occlusion: str
) -> None:
    of = errors(studies, "fill_occlusions", "occlusion", "fill")
    mean = {fill: error for (number, fill), error in of.items() if number == occlusion}
    assert len(mean) == 9
    assert mean["ridge"] < min(mean[fill] for fill in ("muscle", "guenter", "rigid", "linear"))


def test_an_impulse_that_is_smoothed_before_it_is_repaired_stays(studies: Studies) -> None:
    mean = errors(studies, "step_order", "damage", "order")
    repaired_first = mean[IMPULSES, "repair → fill → smooth"]
    for order in ("smooth → repair → fill", "smooth → fill → repair", "fill → smooth → repair"):
        assert mean[IMPULSES, order] > 1.2 * repaired_first


def test_without_impulses_the_order_hardly_counts(studies: Studies) -> None:
    of = errors(studies, "step_order", "damage", "order")
    mean = [error for (damage, _), error in of.items() if damage == "0.1 mm noise"]
    assert len(mean) == 6
    assert max(mean) < 1.1 * min(mean)


def test_who_sees_the_whole_take_errs_less_than_who_sees_nothing_ahead(studies: Studies) -> None:
    of = errors(studies, "live_price", "delay", "smooth")
    mean = {smooth: error for (delay, smooth), error in of.items() if delay == "whole take"}
    assert max(mean["gcv"], mean["kalman_smoother"]) < mean["kalman_filter"]
    assert max(mean["kalman_filter"], mean["one_euro"]) < mean["without"]


def test_no_method_waits_for_more_frames_than_its_group_does(studies: Studies) -> None:
    ahead: dict[str, set[str]] = {}
    for row in table(studies.few("live_price") / "table.csv"):
        ahead.setdefault(row["delay"], set()).add(row["looks ahead"])
    few = {"", "0 frames", "1 frame", "3 frames", "4 frames"}
    assert ahead == {
        "no frame": {"", "0 frames"},
        "up to 4 frames": few,
        "up to 8 frames": {*few, "8 frames"},
        "whole take": {*few, "8 frames", "whole take"},
    }


def test_the_samples_behind_a_gap_are_worth_waiting_for(studies: Studies) -> None:
    mean = errors(studies, "live_price", "fill", file="fills_table")
    assert mean["muscle_met",] < mean["muscle",]
    assert mean["kriging",] == min(mean.values())


@pytest.fixture(scope="module")
def conditions(studies: Studies) -> dict[str, dict[str, float]]:
    """The mean error of each fill by condition."""
    of: dict[str, dict[str, float]] = {}
    for (condition, fill), mean in errors(studies, "fill_conditions", "condition", "fill").items():
        of.setdefault(condition, {})[fill] = mean
    return of


def test_white_noise_makes_the_cubic_the_last_and_a_filter_does_not(
    conditions: dict[str, dict[str, float]],
) -> None:
    assert len(conditions) == 6
    for condition in conditions.keys() - {"0.1 mm white noise", "0.5 % impulses"}:
        assert conditions[condition]["cubic"] < 1.2 * conditions[condition]["linear"]
    white = conditions["0.1 mm white noise"]
    assert white["cubic"] == max(white.values())
    assert white["cubic"] > 2.0 * white["linear"]


def test_repair_after_the_cut_takes_back_most_of_what_impulses_do(
    conditions: dict[str, dict[str, float]],
) -> None:
    without, hit, repaired = (
        conditions[name]
        for name in ("0.03 mm noise below 8 Hz", "0.5 % impulses", "0.5 % impulses repaired")
    )
    for fill in ("ridge", "soft_impute", "cubic", "muscle"):
        assert repaired[fill] - without[fill] < 0.5 * (hit[fill] - without[fill])


def test_one_method_does_for_who_does_not_know_the_condition(
    conditions: dict[str, dict[str, float]],
) -> None:
    worst = {
        fill: max(of[fill] / min(of.values()) for of in conditions.values())
        for fill in conditions["no noise"]
    }
    assert min(worst, key=worst.__getitem__) == "kriging"
    assert worst["kriging"] < 1.25


def test_the_report_asks_what_it_answers(studies: Studies) -> None:
    html = (studies.few("fill_conditions") / "report.html").read_text()
    assert "Do noise and impulses decide which fill is best?" in html
    assert "kriging" in html
    assert "How the faces move, beside people" in html
