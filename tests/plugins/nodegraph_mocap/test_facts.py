"""The facts of a value are counted right; every value that a file may hold has some."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph import Fact
from nodegraph.plugin.registry import default_registry
from nodegraph_mocap import MarkerSet, Origin, Trajectories, Weights
from nodegraph_mocap.specimens import heads, marker_sets, models, recordings, weights


def facts_of(value: object) -> dict[str, Fact]:
    kind = default_registry().hooks.kind(type(value), "facts")
    assert kind is not None
    assert kind.facts is not None
    return {fact.name: fact for fact in kind.facts(value)}


def take() -> Trajectories:
    rng = np.random.default_rng(1)
    positions = rng.normal(0.0, 0.01, (50, 3, 3)) + 100.0 * np.eye(3)
    positions[10, 0] = 130.0  # an impulse
    positions[20:25, 1] = positions[30, 1] = np.nan
    markers = ("nose", "jaw", "brow")
    marker_set = MarkerSet(markers=markers, pairs=(("nose", "jaw"),), edges=(("jaw", "brow"),))
    return Trajectories(positions=positions, markers=markers, rate=50.0, marker_set=marker_set)


def test_gaps_and_impulses_of_a_recording_are_counted_by_marker() -> None:
    facts = facts_of(take())
    assert facts["duration"].text == "1 s"
    assert facts["missing samples"].value == 6
    assert facts["share missing"].text == "4 %"
    assert facts["likely impulses"].value == 1
    assert facts["lines"].text == "1: jaw - brow"
    assert facts["markers with gaps or impulses"].value == {
        "nose": {"missing": 0, "percent": 0.0, "gaps": 0, "longest": 0, "impulses": 1},
        "jaw": {"missing": 6, "percent": 12.0, "gaps": 2, "longest": 5, "impulses": 0},
    }
    assert facts["size of the markers"].value == pytest.approx(100.0, abs=0.1)


def test_made_samples_and_deviations_are_told() -> None:
    face = take()
    filled = face.with_samples(
        np.nan_to_num(face.positions),
        changed=~face.present,
        origin=Origin.FILLED,
        sigma=np.ones(face.origin.shape),
    )
    facts = facts_of(filled)
    assert (facts["missing samples"].value, facts["filled samples"].value) == (0, 6)
    assert "standard deviations" in facts


def test_weights_that_are_missing_beyond_their_range_or_constant_are_counted() -> None:
    values = np.array([[0.0, 0.5, -0.1], [np.nan, 0.5, 1.2], [0.2, 0.5, 0.3]])
    facts = facts_of(Weights(values=values, names=("a", "b", "c"), rate=30.0))
    assert facts["frames with missing weights"].value == 1
    assert facts["weights below 0 or above 1"].value == 2
    assert facts["shapes that do not change"].value == ["b"]


def test_every_value_of_a_file_has_facts() -> None:
    values = [*recordings().values(), *weights().values(), *models().values()]
    values += [*heads().values(), *marker_sets().values()]
    for value in values:
        facts = facts_of(value).values()
        assert facts
        assert all(fact.text for fact in facts)


def test_a_recording_without_any_sample_has_facts_too() -> None:
    nothing = np.full((4, 2, 3), np.nan)
    lost = Trajectories(positions=nothing, markers=("nose", "jaw"), rate=1000.0)
    assert facts_of(lost)["share missing"].text == "100 %"
    one = replace(lost, positions=nothing[:1], origin=lost.origin[:1])
    assert facts_of(one)["frames"].value == 1
