"""A pattern lies over a recording as it lay over its own, wherever there is room."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

import nodegraph_gaps
import nodegraph_mocap
from nodegraph.node.decorator import node_of
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry
from nodegraph.testing import check_node
from nodegraph_gaps.cut import cut
from nodegraph_gaps.transplant import read_pattern
from nodegraph_mocap import Trajectories
from tests.plugins.recordings import make_recording, runs_in

GAPS = ((3, 10, 4), (1, 12, 20), (3, 40, 1), (0, 41, 5), (2, 44, 3))
"""Marker, first frame, length: 3 and 1 at once, then 0 and 2 at once."""


def lacking(missing: NDArray[np.bool_], rate: float = 60.0) -> Trajectories:
    random = np.random.default_rng(missing.shape[1])
    shape = random.normal(0, 50, (missing.shape[1], 3))
    positions = shape + random.normal(0, 0.1, (*missing.shape, 3))
    positions[missing] = np.nan
    return make_recording(positions, rate=rate)


def source(rate: float = 60.0) -> Trajectories:
    missing = np.zeros((60, 5), dtype=np.bool_)
    for marker, first, length in GAPS:
        missing[first : first + length, marker] = True
    return lacking(missing, rate)


def whole(frames: int = 200, markers: int = 12) -> Trajectories:
    return lacking(np.zeros((frames, markers), dtype=np.bool_))


def test_the_gaps_are_those_of_the_source_at_another_time_on_other_markers() -> None:
    result = cut(whole(), source(), seed=3)
    hidden = result.hidden.hidden
    used = np.flatnonzero(hidden.any(axis=0))
    assert len(used) == 4
    begin = int(hidden.any(axis=1).argmax())
    mine = sorted(tuple(np.flatnonzero(hidden[:, marker]) - begin) for marker in used)
    theirs = sorted(
        tuple(np.flatnonzero(column) - 10) for column in (~source().present).T if column.any()
    )
    assert mine == theirs
    assert result.truth.present.all()
    np.testing.assert_array_equal(result.gappy.present, ~hidden)


def test_markers_that_are_missing_at_once_are_neighbours() -> None:
    for seed in range(20):
        take = whole()
        hidden = cut(take, source(), seed=seed).hidden.hidden
        shape = take.positions[0]
        apart = np.linalg.norm(shape[:, None] - shape, axis=2)
        by_first = sorted(np.flatnonzero(hidden.any(axis=0)), key=lambda m: hidden[:, m].argmax())
        first, second, third, fourth = by_first
        assert apart[first].argsort()[1] == second
        left = np.setdiff1d(np.arange(12), [first, second, third])
        assert left[apart[third, left].argmin()] == fourth


def test_the_seed_decides_when_and_where() -> None:
    result = [cut(whole(), source(), seed=seed).hidden.hidden for seed in range(40)]
    np.testing.assert_array_equal(result[0], cut(whole(), source(), seed=0).hidden.hidden)
    begins = {int(hidden.any(axis=1).argmax()) for hidden in result}
    firsts = {int(hidden[hidden.any(axis=1).argmax()].argmax()) for hidden in result}
    assert len(begins) > 25
    assert len(firsts) > 8


def test_every_time_can_be_drawn() -> None:
    take = whole(frames=37 + 4)
    begins = {
        int(cut(take, source(), seed=seed).hidden.hidden.any(axis=1).argmax()) for seed in range(80)
    }
    assert begins == {1, 2, 3}


@given(
    taken=arrays.arrays(np.bool_, (20, 4)),
    missing=arrays.arrays(np.float64, (60, 6), elements=st.floats(0, 1)),
    rate=st.sampled_from([30.0, 60.0, 100.0]),
    seed=st.integers(0, 99),
)
@pytest.mark.filterwarnings("ignore:.*runs of missing samples of pattern_from reach")
def test_the_whole_pattern_fits_or_the_error_counts(
    taken: NDArray[np.bool_], missing: NDArray[np.float64], rate: float, seed: int
) -> None:
    taken[[0, -1]] = False
    taken[5, 0] = True
    take, origin = lacking(missing > 0.95), lacking(taken, rate)
    pattern = read_pattern(origin, 60.0)
    try:
        result = cut(take, origin, seed=seed)
    except ValueError as error:
        predictors, fitting = map(int, re.findall(r"(\d+) (?:gaps on|fit into)", str(error)))
        assert fitting < predictors == len(pattern.length)
        return
    actual = runs_in(result.hidden.hidden)
    assert sorted(length for *_, length in actual) == sorted(pattern.length.tolist())
    assert len({marker for marker, *_ in actual}) == pattern.markers
    for marker, first, length in actual:
        assert take.present[first : first + length, marker].all()
        assert result.gappy.present[first - 1, marker]
        assert result.gappy.present[first + length, marker]


def test_nothing_but_gaps_rate_and_reference_shape_counts() -> None:
    take, origin = whole(), source()
    moved = replace(origin, positions=3.0 - 2.0 * origin.positions)
    named = replace(origin, markers=tuple("vwxyz"))
    # the first frame is the reference shape, being complete
    still = replace(take, positions=np.broadcast_to(take.positions[0], take.positions.shape))
    hidden = cut(take, origin, seed=5).hidden.hidden
    for first, second in ((take, moved), (take, named), (still, origin)):
        np.testing.assert_array_equal(cut(first, second, seed=5).hidden.hidden, hidden)


@pytest.mark.parametrize(
    ("setting", "value"),
    [("length", 5), ("count", 3), ("simultaneous", 2), ("pattern", "contiguous")],
)
def test_settings_that_the_pattern_decides_are_refused(setting: str, value: Any) -> None:
    with pytest.raises(ValueError, match=f"^{setting}: the gaps come from pattern_from"):
        cut(whole(), source(), **{setting: value})


def test_defaults_are_no_settings() -> None:
    settings: Any = {"length": 15, "count": 20, "simultaneous": 1, "pattern": "random"}
    first, second = cut(whole(), source()), cut(whole(), source(), **settings)
    np.testing.assert_array_equal(first.hidden.hidden, second.hidden.hidden)


def test_a_recording_that_is_too_short_says_how_many_gaps_fit() -> None:
    # the pattern spans 37 frames: 39 hold it
    cut(whole(frames=39), source())
    with pytest.raises(
        ValueError, match=r"5 gaps on 4 markers within 37 frames .*, 4 fit into 38 f"
    ):
        cut(whole(frames=38), source())
    with pytest.raises(ValueError, match="0 fit into 2 frames"):
        cut(whole(frames=2), source())


def test_too_few_markers_say_how_many_gaps_fit() -> None:
    with pytest.raises(ValueError, match="4 fit into 200 frames of 3 markers"):
        cut(whole(markers=3), source())


def test_the_port_may_stay_open() -> None:
    definition = node_of(cut)
    assert definition is not None
    assert [(port.name, port.optional) for port in definition.inputs] == [
        ("recording", False),
        ("pattern_from", True),
        ("truth", True),
    ]


@pytest.mark.parametrize("pattern", ["random", "contiguous", "region", "end"])
def test_it_keeps_what_cuts_promise(pattern: str) -> None:
    registry = Registry(loaded=[Plugin("mocap", nodegraph_mocap), Plugin("gaps", nodegraph_gaps)])
    plain = {"length": 2, "count": 3, "pattern": pattern}
    check_node(cut, inputs={"pattern_from": None}, settings=plain, registry=registry)
    check_node(cut, inputs={"pattern_from": small()}, registry=registry)


def small() -> Trajectories:
    """Return a recording with two gaps that most others can take."""
    missing = np.zeros((10, 2), dtype=np.bool_)
    missing[3:5, 0] = missing[4:7, 1] = True
    return lacking(missing)
