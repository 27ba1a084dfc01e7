"""The number of a method: of its own blocks alone, whoever else takes part, whatever is said."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pandas import DataFrame
from scipy.stats import gmean

from nodegraph import Across, Label
from nodegraph_compare.table.node import table
from nodegraph_compare.verdict import Verdict
from nodegraph_tables import TableInfo, Take, with_info

STUDIES, METHODS = 20, 5
KINDS = {
    "one recording": (1, 1, 30),
    "one recording, draws": (1, 4, 15),
    "two recordings, draws": (2, 3, 10),
    "four recordings": (4, 1, 12),
    "eight recordings, draws": (8, 2, 6),
}
"""Recordings, draws on each, and gaps in a draw."""


pytestmark = pytest.mark.usefixtures("without_pictures")


def study(values: NDArray[np.float64], methods: list[int], frames: int = 500) -> list[Verdict]:
    """Compare methods by (studies, recordings, draws, gaps, methods) errors."""
    studies, recordings, draws, gaps, _ = values.shape
    entries: list[tuple[dict[str, Label], Any]] = []
    start = np.tile(np.linspace(0, frames - 10, gaps).astype(int), studies)
    for recording in range(recordings):
        for draw in range(draws):
            for method in methods:
                frame = DataFrame(
                    {
                        "study": np.repeat(np.arange(studies), gaps),
                        "gap": np.tile(np.arange(gaps), studies),
                        "start": start,
                        "frames": 10,
                        "error": values[:, recording, draw, :, method].ravel(),
                    }
                )
                labels: dict[str, Label] = {
                    "recording": recording,
                    "draw": draw,
                    "method": f"m{method}",
                }
                info = TableInfo(take=Take(frames, correlation=5.0))
                entries.append((labels, with_info(frame, info)))
    scores = Across(("recording", "draw", "method"), tuple(entries), sources=("recording",))
    compared = table(
        scores, metric="error", compare="method", within=("study",), blocks=("draw", "gap")
    )
    return list(compared.overview.verdicts.groups)


def drawn(kind: str) -> NDArray[np.float64]:
    random = np.random.default_rng(len(kind))
    recordings, draws, gaps = KINDS[kind]
    shape = (STUDIES, recordings, draws, gaps, METHODS)
    spread = random.uniform(0.0, 2.0, (STUDIES, 1, 1, 1, METHODS))
    return np.exp(random.normal(size=shape) + spread)


@pytest.mark.parametrize("kind", KINDS)
def test_no_other_method_changes_a_number(kind: str) -> None:
    values = drawn(kind)
    whole, few, one = (study(values, methods) for methods in (list(range(5)), [0, 3], [3]))
    expected = gmean(values.mean(axis=(2, 3)), axis=1)
    for at, (all_five, two, alone) in enumerate(zip(whole, few, one, strict=True)):
        assert all_five.mean == pytest.approx(expected[at])
        assert two.mean.tolist() == all_five.mean[[0, 3]].tolist()
        assert alone.mean.tolist() == all_five.mean[[3]].tolist()


def test_the_kind_of_unit_does_not_change_a_number() -> None:
    """A long recording has segments, a short one has not, draws of one are units themselves."""
    values = drawn("one recording, draws")
    by_draws = study(values, [0, 1])
    of_draws = values.reshape(STUDIES, 1, 1, -1, METHODS)
    short, long = (study(of_draws, [0, 1], frames) for frames in (500, 5000))
    kinds = [{group.scope.kind for group in of} for of in (by_draws, short, long)]
    assert kinds == [{"draws"}, {"nothing"}, {"segments"}]
    for groups in zip(by_draws, short, long, strict=True):
        first, *rest = (group.mean.tolist() for group in groups)
        assert all(numbers == pytest.approx(first, rel=1e-12) for numbers in rest)


@pytest.mark.filterwarnings("ignore:.*blocks left out")
def test_blocks_that_another_lacks_are_left_out_and_counted() -> None:
    values = drawn("four recordings")
    values[:, :, :, ::2, 4] = np.nan
    for group, (full, half) in zip(
        study(values, list(range(5))),
        zip(study(values, [0, 1]), study(values[..., 1::2, :], [0, 1]), strict=True),
        strict=True,
    ):
        assert group.mean[:2] == pytest.approx(half.mean)
        assert (group.mean[:2] != full.mean).all()
        assert (group.blocks == 24).all()
        assert group.of_blocks == 48


def test_equal_results_have_equal_numbers_whoever_they_stand_beside() -> None:
    """As of a fill that meets the ends of gaps anyway, which is the same in two groups."""
    values = drawn("eight recordings, draws")
    values[1::2, ..., 0] = values[::2, ..., 0]
    groups = study(values, list(range(5)))
    assert [group.mean[0] for group in groups[::2]] == [group.mean[0] for group in groups[1::2]]
