"""Settings of fills that are tuned on gaps of known content."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache, partial
from typing import Annotated

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import Across
from nodegraph.equality import same
from nodegraph.node.decorator import node_of
from nodegraph_fill import nodegraph_nodes
from nodegraph_fill.burke_lasenby import burke_lasenby
from nodegraph_fill.gaps import Gaps
from nodegraph_fill.muscle import muscle
from nodegraph_fill.ridge import ridge
from nodegraph_fill.tuning import MOST_TRIES, Tune
from nodegraph_fill.whole_take import Estimate, whole_take
from nodegraph_gaps.cut import cut
from nodegraph_mocap import Origin, Trajectories
from nodegraph_score.tuning import tuning as table_of
from nodegraph_synthesize.face import synthesize_face
from tests.plugins.recordings import make_recording

FRAMES, MARKERS = 120, 20
FILLS = {node.method: node.function for node in map(node_of, nodegraph_nodes()) if node}
Positions = NDArray[np.float64]


def gappy(markers: int = MARKERS) -> Trajectories:
    """Markers that stay, each with a gap of two or five frames."""
    positions = np.ones((FRAMES, markers, 3))
    for marker in range(markers):
        positions[4 + marker :][: 2 + 3 * (marker % 2), marker] = np.nan
    return make_recording(positions)


@cache
def a_face() -> Trajectories:
    made = synthesize_face(seconds=3.0, markers=14, missing=0.0, impulses=0.0, seed=5)
    return cut(made.captured, length=6, count=12, seed=1).gappy


def quietly(fill: Callable[..., Trajectories], recording: Trajectories) -> Trajectories:
    return fill(recording, ends="met", settings="tuned")


calls: list[tuple[int, int, float, float]] = []


@whole_take("fill.off", cite="none")
def off(
    recording: Trajectories,
    gaps: Gaps,
    *,
    by: Annotated[float, Tune(3.0, 0.5, 2.0)] = 2.0,
    times: Annotated[float, Tune(times=(2.0, 0.1))] = 1.0,
) -> Estimate:
    """Fill beside where the markers are.

    Parameters
    ----------
    by, times
        How far.
    """
    assert np.isnan(recording.positions[gaps.mask]).all()
    hidden = int(np.count_nonzero(~recording.present))
    calls.append((len(gaps.start), hidden, by, times))
    return Estimate(np.full((*gaps.shape, 3), 1.0 + by * times))


def test_setting_after_setting_takes_the_value_with_the_least_error() -> None:
    calls.clear()
    filled = off(gappy(), settings="tuned")
    assert [call[2:] for call in calls] == [
        *((2.0, 1.0), (3.0, 1.0), (0.5, 1.0), (0.5, 2.0), (0.5, 0.1)),
        (0.5, 0.1),
    ]
    assert filled.tuning is not None
    assert filled.tuning.settings == (("by", 2.0, 0.5), ("times", 1.0, 0.1))
    assert (filled.tuning.tries, filled.tuning.gaps) == (4, calls[0][0])
    np.testing.assert_allclose(filled.tuning.before, 2.0 * np.sqrt(3.0))
    np.testing.assert_allclose(filled.tuning.after, 0.05 * np.sqrt(3.0))
    np.testing.assert_allclose(filled.positions[4, 0], 1.05)


def test_what_is_missing_stays_missing_while_it_tunes() -> None:
    calls.clear()
    recording = gappy()
    off(recording, settings="tuned")
    missing, (held, hidden, *_) = int(np.count_nonzero(~recording.present)), calls[0]
    # so many gaps more, of two and five frames
    assert missing + 2 * held < hidden < missing + 5 * held
    assert calls[-1][:2] == (MARKERS, missing)


@pytest.mark.parametrize(("markers", "gaps"), [(1, 7), (2, 14)])
def test_a_take_too_short_keeps_what_is_set_and_says_so(markers: int, gaps: int) -> None:
    if gaps >= 10:
        assert getattr(off(gappy(markers), settings="tuned").tuning, "gaps", 0) == gaps
        return
    with pytest.warns(UserWarning, match=rf"stay as published: {gaps} gaps can be hidden") as told:
        filled = off(gappy(markers), settings="tuned")
    assert told[0].filename == __file__
    assert same(filled.positions, off(gappy(markers)).positions)
    assert filled.tuning is not None
    assert filled.tuning.tries == 0


def test_a_method_that_refuses_what_it_is_to_be_tuned_on_keeps_what_is_set() -> None:
    positions = np.random.default_rng(1).normal(size=(40, 16, 3)).cumsum(axis=0)
    for marker in range(16):
        positions[marker, marker] = np.nan
    recording = make_recording(positions)
    with pytest.warns(UserWarning, match="hidden to tune on, the method needs two complete"):
        filled = burke_lasenby(recording, settings="tuned")
    assert same(filled.positions, burke_lasenby(recording).positions)


def test_no_fill_has_more_to_try_than_others() -> None:
    @whole_take("fill.greedy", cite="none")
    def greedy(
        recording: Trajectories, gaps: Gaps, *, by: Annotated[int, Tune(*range(8))] = 0
    ) -> Estimate:
        """Fill with anything."""
        return Estimate(np.zeros_like(recording.positions))

    with pytest.raises(ValueError, match="7 values to try: a fill may have 6 beside its defaults"):
        greedy(gappy(), settings="tuned")


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_every_fill_is_tuned_alike_in_any_thread() -> None:
    recording = a_face()
    with ThreadPoolExecutor(2) as pool:
        filled = pool.map(partial(quietly, recording=recording), FILLS.values())
        first = dict(zip(FILLS, filled, strict=True))
    changed = set()
    for name, fill in FILLS.items():
        again = quietly(fill, recording)
        assert same(first[name], again), name
        assert np.array_equal(
            again.positions[recording.present], recording.positions[recording.present]
        )
        if again.tuning is None:
            untuned = fill(recording, ends="met")
            assert same(untuned, again), name
            continue
        assert 0 < again.tuning.tries <= MOST_TRIES
        assert again.tuning.after <= again.tuning.before
        values = {setting: value for setting, _, value in again.tuning.settings}
        set_so = fill(recording, ends="met", **values)
        assert same(set_so.positions, again.positions), name
        if any(before != after for _, before, after in again.tuning.settings):
            changed.add(name)
    assert {"linear", "cubic", "ppca"}.isdisjoint(changed)
    assert len(changed) > 5


def test_a_tuned_fill_needs_the_whole_take() -> None:
    node = node_of(muscle)
    assert node is not None
    assert node.lookahead(node.defaults) == 0
    assert node.lookahead({**node.defaults, "settings": "tuned"}) is None
    assert node.live_lookahead({**node.defaults, "settings": "tuned"}) is None


def test_burke_and_lasenby_are_as_published_with_their_own_numbers() -> None:
    node = node_of(burke_lasenby)
    assert node is not None
    assert node.adapted_from(node.defaults) == ""
    for other in ({"tolerance": 0.1}, {"noise": 0.1}, {"settings": "tuned"}):
        text = node.adapted_from({**node.defaults, **other})
        assert re.match("from Burke and Lasenby 2016: tolerance and noise are ", text)


def test_the_values_that_were_chosen_are_a_table() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        takes = {
            (method, take): fill(gappy(markers), settings="tuned")
            for method, fill in {"off": off, "ridge": ridge}.items()
            for take, markers in {"a": 20, "b": 12, "short": 1}.items()
        }
    entries = [({"fill": method, "take": take}, each) for (method, take), each in takes.items()]
    table = table_of(Across(("fill", "take"), tuple(entries)))
    row = table[(table["fill"] == "off") & (table["setting"] == "by")].iloc[0]
    assert (row["as published"], row["chosen"]) == ("2", "0.5 (2 of 2)")
    assert table_of(Across.of({"a": gappy()}, axis="take")).empty
    assert Origin.FILLED in takes["off", "a"].origin
