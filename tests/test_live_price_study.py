"""The study of what methods cost that look few frames ahead."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.records import read_record
from tests.studies import Studies, table


@pytest.fixture(scope="module")
def built_in(studies: Studies) -> Path:
    """A run on two actors."""
    return studies.few("live_price")


def test_nothing_fails_or_is_refused(built_in: Path) -> None:
    counts = read_record(built_in)["counts"]
    assert counts["failed"] == 0
    assert counts["refused"] == 0


def test_who_sees_the_whole_take_errs_less_than_who_sees_nothing_ahead(built_in: Path) -> None:
    rows = table(built_in / "table.csv")
    errors = {row["smooth"]: float(row["mean"]) for row in rows if row["delay"] == "whole take"}
    assert max(errors["gcv"], errors["kalman_smoother"]) < errors["kalman_filter"]
    assert max(errors["kalman_filter"], errors["one_euro"]) < errors["without"]


def test_no_method_waits_for_more_frames_than_its_group_does(built_in: Path) -> None:
    ahead: dict[str, set[str]] = {}
    for row in table(built_in / "table.csv"):
        ahead.setdefault(row["delay"], set()).add(row["looks ahead"])
    few = {"", "0 frames", "1 frame", "3 frames", "4 frames"}
    assert ahead == {
        "no frame": {"", "0 frames"},
        "up to 4 frames": few,
        "up to 8 frames": {*few, "8 frames"},
        "whole take": {*few, "8 frames", "whole take"},
    }


def test_the_samples_behind_a_gap_are_worth_waiting_for(built_in: Path) -> None:
    errors = {row["fill"]: float(row["mean"]) for row in table(built_in / "fills_table.csv")}
    assert errors["muscle_met"] < errors["muscle"]
    assert errors["kriging"] == min(errors.values())
