"""The study of occlusions of one and of several markers."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.records import read_record
from tests.studies import Studies, table

OCCLUSIONS = ("1 marker", "4 markers", "12 markers")


@pytest.fixture(scope="module")
def built_in(studies: Studies) -> Path:
    """A run on two actors, with gaps of 15 frames."""
    return studies.few("fill_occlusions")


@pytest.fixture(scope="module")
def errors(built_in: Path) -> dict[str, dict[str, float]]:
    """The mean error of each method by the number of markers that are missing at once."""
    rows = [row for row in table(built_in / "table.csv") if row["occlusion"]]
    return {
        name: {row["fill"]: float(row["mean"]) for row in rows if row["occlusion"] == name}
        for name in OCCLUSIONS
    }


def test_nothing_fails_or_is_refused(built_in: Path) -> None:
    counts = read_record(built_in)["counts"]
    assert counts["failed"] == 0
    assert counts["refused"] == 0


def test_every_method_has_a_number_for_every_occlusion(
    errors: dict[str, dict[str, float]],
) -> None:
    assert {len(of) for of in errors.values()} == {9}


def test_what_learns_from_the_take_errs_less_than_what_knows_only_the_frame(
    errors: dict[str, dict[str, float]],
) -> None:
    for of in errors.values():
        assert of["ridge"] < min(of[fill] for fill in ("muscle", "guenter", "rigid", "linear"))
