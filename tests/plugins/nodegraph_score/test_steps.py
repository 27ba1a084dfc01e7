"""What a step does to the error is told over the samples that it changed."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import Absent, Across
from nodegraph_mocap import Trajectories
from nodegraph_score.steps import COLUMNS, steps
from nodegraph_tables import info_of
from tests.plugins.recordings import quietly

FRAMES, NAMES = 30, ("a", "b", "c", "d")


def take(positions: NDArray[np.float64], names: tuple[str, ...] = NAMES) -> Trajectories:
    return Trajectories(positions=positions, markers=names, rate=60.0)


def truth() -> Trajectories:
    return take(np.random.default_rng(0).normal(0.0, 40.0, (FRAMES, 4, 3)))


def off(where: Any, by: float, start: Trajectories | None = None) -> Trajectories:
    """Return the recording with some samples off by a distance along x."""
    positions = (start or truth()).positions.copy()
    positions[where] += [by, 0.0, 0.0]
    return take(positions)


def without(where: Any, start: Trajectories) -> Trajectories:
    positions = start.positions.copy()
    positions[where] = np.nan
    return take(positions)


def chain(**stages: Trajectories) -> Across[Trajectories]:
    return Across.of(stages, axis="stages")


def rows(stages: Across[Trajectories], against: Trajectories | None = None) -> list[dict[Any, Any]]:
    return quietly(steps, stages, against or truth()).to_dict("records")


def test_a_repair_counts_over_the_samples_that_it_changed() -> None:
    """Of two impulses one is repaired to 1 mm, and a good sample is put off by 2 mm."""
    begin = off(([3, 7], [0, 0]), 8.0)
    after = off(([3, 7, 9], [0, 0, 1]), 0.0)
    positions = after.positions.copy()
    positions[3, 0] += [0.0, 1.0, 0.0]
    positions[7, 0] += [8.0, 0.0, 0.0]
    positions[9, 1] += [0.0, 0.0, 2.0]
    table = steps(chain(captured=begin, despike=take(positions)), truth())
    assert tuple(table.columns) == COLUMNS
    first, second = table.to_dict("records")
    assert (first["step"], first["verdict"], first["changed"]) == ("captured", "begins", 0)
    assert first["added"] == FRAMES * 4
    assert first["rmse"] == pytest.approx(math.sqrt(2 * 64 / 120))
    assert (second["step"], second["verdict"], second["changed"]) == ("despike", "better", 2)
    assert second["before"] == pytest.approx(math.sqrt(64 / 2))
    assert second["after"] == pytest.approx(math.sqrt((1 + 4) / 2))
    assert second["nearer"] == 0.5
    assert second["worst"] == pytest.approx(2.0)
    assert second["rmse"] == pytest.approx(math.sqrt((1 + 4 + 64) / 120))


def test_what_is_filled_had_no_error_before() -> None:
    gap = (slice(5, 9), 2)
    first, second = rows(
        chain(captured=without(gap, truth()), fill=off(([5, 6, 7, 8], [2] * 4), 3.0))
    )
    assert (first["missing"], second["missing"]) == (4, 0)
    assert (second["added"], second["changed"], second["verdict"]) == (4, 0, "adds")
    assert math.isnan(second["before"])
    assert math.isnan(second["after"])
    assert math.isnan(second["nearer"])
    assert second["added rmse"] == pytest.approx(3.0)
    assert second["worst"] == pytest.approx(3.0)
    assert second["rmse"] == pytest.approx(math.sqrt(4 * 9 / 120))


def test_a_step_that_makes_it_worse_is_reported_everywhere() -> None:
    with pytest.warns(UserWarning, match=r"smooth makes it worse: 0 mm before and 2 mm after"):
        table = steps(chain(captured=truth(), smooth=off((slice(0, 5), 1), 2.0)), truth())
    assert table["verdict"].tolist() == ["begins", "worse"]
    assert "smooth makes it worse." in info_of(table).answer.lines[0]
    assert info_of(table).notes[0].startswith("smooth makes it worse")


def test_each_step_starts_from_the_stage_before_it() -> None:
    first, second = off((slice(0, 4), 0), 4.0), off((slice(0, 4), 0), 2.0)
    actual = rows(chain(captured=first, a=second, b=second, c=truth(), d=first))
    assert [row["verdict"] for row in actual] == ["begins", "better", "nothing", "better", "worse"]
    assert [row["before"] for row in actual if row["changed"]] == pytest.approx([4.0, 2.0, 0.0])


def test_removed_samples_are_counted() -> None:
    begin = off(([3], [0]), 50.0)
    (_, row) = rows(chain(captured=begin, dropped=without(([3], [0]), begin)))
    assert (row["removed"], row["missing"], row["verdict"]) == (1, 1, "removes")
    assert row["rmse"] == 0.0


def test_wrong_names_are_misplaced() -> None:
    positions = truth().positions.copy()
    positions[4:8, [0, 3]] = positions[4:8, [3, 0]]
    first, _ = rows(chain(named=take(positions), smooth=truth()))
    assert first["misplaced"] == 8


def test_markers_are_matched_by_name_and_leftovers_do_not_count() -> None:
    leftover = np.full((FRAMES, 1, 3), 9.0)
    names = ("t000", "d", "b", "a")
    positions = np.concatenate([leftover, truth().positions[:, [3, 1, 0]]], axis=1)
    with pytest.warns(UserWarning, match="1 markers of captured, fill are not in the truth .*t000"):
        table = steps(chain(captured=take(positions, names), fill=take(positions, names)), truth())
    assert table["rmse"].tolist() == [0.0, 0.0]
    assert table["missing"].tolist() == [FRAMES, FRAMES]


def test_samples_without_a_truth_do_not_count() -> None:
    known = without((slice(0, 10), 1), truth())
    with pytest.warns(UserWarning, match="10 of 120 samples lack a truth"):
        table = steps(chain(captured=off((slice(0, 10), 1), 5.0), smooth=truth()), known)
    assert table["rmse"].tolist() == [0.0, 0.0]
    assert table["added"][0] == 110


def test_a_stage_that_is_absent_is_passed_over() -> None:
    gone = Absent({"stages": "despike"}, "failed", "k is 0")
    stages = replace(chain(captured=off(([1], [1]), 4.0), smooth=truth()), absent=(gone,))
    with pytest.warns(UserWarning, match=r"passed over; despike was failed \(k is 0\)"):
        table = steps(stages, truth())
    assert table["step"].tolist() == ["captured", "smooth"]


def test_nothing_but_missing_samples_says_nothing() -> None:
    nothing = without(slice(None), truth())
    first, second = rows(chain(captured=nothing, fill=nothing))
    assert (first["added"], first["missing"], second["verdict"]) == (0, 120, "nothing")
    assert math.isnan(first["rmse"])
    table = steps(chain(captured=nothing, fill=nothing), truth())
    assert info_of(table).answer.lines[2].startswith("captured: \N{EN DASH}")


@pytest.mark.parametrize("count", [0, 1])
def test_fewer_than_two_stages_are_no_step(count: int) -> None:
    stages = Across.of({"captured": truth()} if count else {}, axis="stages")
    with pytest.raises(
        ValueError, match="a step needs 2 stages; there is " + ("none", "captured")[count]
    ):
        steps(stages, truth())


def test_stages_lie_along_one_axis() -> None:
    entries = tuple(({"stages": value, "trial": 0}, truth()) for value in ("captured", "fill"))
    with pytest.raises(ValueError, match="not along stages, trial: say `over` which one"):
        steps(Across(("stages", "trial"), entries), truth())
