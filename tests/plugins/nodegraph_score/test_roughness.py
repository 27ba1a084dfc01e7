"""The variance of a marker's steps."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_mocap import Origin
from nodegraph_score.roughness import roughness
from nodegraph_tables import info_of
from tests.plugins.recordings import make_recording, quietly


@given(seed=st.integers(0, 2**32 - 1))
def test_equals_its_definition(seed: int) -> None:
    random = np.random.default_rng(seed)
    positions = 500.0 + np.cumsum(random.normal(0.3, 1, (random.integers(1, 25), 4, 3)), axis=0)
    positions[random.random(positions.shape[:2]) < 0.3] = np.nan
    table = quietly(roughness, make_recording(positions))
    for marker, row in enumerate(table.to_dict("records")):
        steps = [
            after - before
            for before, after in pairwise(positions[:, marker])
            if not np.isnan(before).any() and not np.isnan(after).any()
        ]
        assert row["marker"] == f"m{marker}"
        assert row["vectors"] == len(steps)
        if len(steps) < 2:
            assert np.isnan(row["roughness"])
        else:
            away = np.array(steps) - np.mean(steps, axis=0)
            assert row["roughness"] == pytest.approx(np.mean(np.sum(away**2, axis=1)), rel=1e-9)


def test_filled_samples_count() -> None:
    positions = np.random.default_rng(1).normal(0, 1, (9, 1, 3))
    plain = make_recording(positions)
    changed = np.zeros((9, 1), dtype=bool)
    changed[3:5] = True
    filled = plain.with_samples(positions, changed=changed, origin=Origin.FILLED)
    assert roughness(filled).equals(roughness(plain))


def test_under_two_steps_are_counted() -> None:
    positions = np.zeros((4, 3, 3))
    positions[2:, 0] = positions[1::2, 1] = np.nan
    message = "2 of 3 markers have fewer than two steps and no roughness"
    with pytest.warns(UserWarning, match=message):
        table = roughness(make_recording(positions))
    assert table["vectors"].tolist() == [1, 0, 3]
    assert table["roughness"].isna().tolist() == [True, True, False]
    assert list(info_of(table).notes) == [f"{message}."]


def test_a_step_beyond_all_numbers_is_refused() -> None:
    with pytest.raises(ValueError, match="too large"):
        roughness(make_recording(np.random.default_rng(0).normal(0, 1e200, (5, 2, 3))))
