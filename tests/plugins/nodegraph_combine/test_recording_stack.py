"""Recordings that differ in more than their samples are not combined; what is absent is told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nodegraph import Absent, Across
from nodegraph_combine.ensemble import ensemble
from nodegraph_combine.mean import mean
from nodegraph_combine.median import median
from nodegraph_mocap import Origin, Trajectories

Filled = Callable[[list[float]], Across[Trajectories]]
NODES = (mean, median, ensemble)
each = pytest.mark.parametrize("node", NODES, ids=lambda function: str(function.__name__))


@each
def test_a_sample_that_one_has_filled_is_filled(
    node: Callable[..., Trajectories], filled: Filled, truth: Trajectories
) -> None:
    combined = node(filled([1.0, 2.0, np.nan]))
    assert np.all(combined.origin[10:20, 1] == Origin.FILLED)
    assert np.count_nonzero(combined.origin != Origin.MEASURED) == 10
    np.testing.assert_array_equal(combined.positions[:10], truth.positions[:10])


@each
def test_what_none_has_stays_missing(node: Callable[..., Trajectories], filled: Filled) -> None:
    combined = node(filled([np.nan, np.nan]))
    assert np.all(combined.origin[10:20, 1] == Origin.MISSING)


@each
def test_markers_are_matched_by_name(node: Callable[..., Trajectories], filled: Filled) -> None:
    fills = filled([1.0, 2.0, 4.0])
    first, second, third = fills.values()
    turned = Across.of({"f0": first, "f1": second.keep("edcba"), "f2": third}, axis="fill")
    np.testing.assert_array_equal(node(turned).positions, node(fills).positions)


@each
def test_what_was_refused_is_reported(node: Callable[..., Trajectories], filled: Filled) -> None:
    fills = filled([1.0, 2.0])
    absent = (Absent({"fill": "pca"}, "refused", "needs one complete frame"),)
    with pytest.warns(UserWarning, match="^2 of 3 recordings are combined: fill=pca was refused$"):
        node(replace(fills, absent=absent))


@each
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"rate": 30.0}, "rate: fill=one has 60.0, fill=two has 30.0; need the same"),
        ({"markers": tuple("abcdx")}, "have not the same markers: only one has e, x"),
    ],
)
def test_other_recordings_are_refused(
    node: Callable[..., Trajectories], truth: Trajectories, change: dict[str, Any], message: str
) -> None:
    other = replace(truth, **change)
    with pytest.raises(ValueError, match=message):
        node(Across.of({"one": truth, "two": other}, axis="fill"))


@each
def test_takes_of_other_lengths_are_refused(
    node: Callable[..., Trajectories], truth: Trajectories
) -> None:
    other = replace(truth, positions=truth.positions[:9], origin=truth.origin[:9])
    with pytest.raises(ValueError, match="frames: fill=one has 40, fill=two has 9"):
        node(Across.of({"one": truth, "two": other}, axis="fill"))
