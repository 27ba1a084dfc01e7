"""The study of the order of repair, fill and smoothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.records import read_record
from tests.studies import Studies, table

IMPULSES = "0.1 mm noise and 0.5 % impulses"


@pytest.fixture(scope="module")
def built_in(studies: Studies) -> Path:
    """A run on two actors."""
    return studies.few("step_order")


@pytest.fixture(scope="module")
def errors(built_in: Path) -> dict[tuple[str, str], float]:
    """The mean error by damage and order."""
    rows = table(built_in / "table.csv")
    return {(row["damage"], row["order"]): float(row["mean"]) for row in rows}


def test_nothing_fails_or_is_refused(built_in: Path) -> None:
    counts = read_record(built_in)["counts"]
    assert counts["failed"] == 0
    assert counts["refused"] == 0


def test_an_impulse_that_is_smoothed_before_it_is_repaired_stays(
    errors: dict[tuple[str, str], float],
) -> None:
    repaired_first = errors[IMPULSES, "repair → fill → smooth"]
    for order in ("smooth → repair → fill", "smooth → fill → repair", "fill → smooth → repair"):
        assert errors[IMPULSES, order] > 1.2 * repaired_first


def test_without_impulses_the_order_hardly_counts(
    errors: dict[tuple[str, str], float],
) -> None:
    of = [mean for (damage, _), mean in errors.items() if damage == "0.1 mm noise"]
    assert len(of) == 6
    assert max(of) < 1.1 * min(of)
