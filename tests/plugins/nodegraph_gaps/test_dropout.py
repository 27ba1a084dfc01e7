"""Samples hidden as they arrive: how many, where, and from what."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph import get_node
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.frame_ranges import runs_of
from tests.plugins.recordings import make_recording

dropout = get_node("gaps.dropout")


def take(frames: int = 2000, markers: int = 20) -> Trajectories:
    positions = np.random.default_rng(1).normal(size=(frames, markers, 3))
    return make_recording(positions)


@pytest.mark.parametrize(("share", "length"), [(0.05, 15), (0.3, 4)])
def test_the_share_is_hidden_in_gaps_of_the_length(share: float, length: int) -> None:
    hidden = dropout(take(6_000), share=share, length=length, seed=3).hidden.hidden
    assert abs(hidden.mean() - share) < 0.1 * share
    assert not hidden[0].any()
    runs = runs_of(hidden)
    inner = runs.stop < len(hidden)
    assert np.all((runs.stop - runs.start)[inner] == length)


def test_only_measured_samples_that_the_truth_has_are_hidden() -> None:
    recording, truth = take(400), take(400)
    origin = np.where(np.arange(400)[:, None] % 7 == 0, Origin.FILLED, recording.origin)
    recording = recording.with_samples(
        recording.positions, changed=origin == Origin.FILLED, origin=Origin.FILLED
    )
    lacking = np.zeros(truth.origin.shape, dtype=bool)
    lacking[:, 3] = True
    truth = truth.with_samples(
        np.where(lacking[..., None], np.nan, truth.positions),
        changed=lacking,
        origin=Origin.MISSING,
    )
    gappy, known, mask = dropout(recording, truth.keep(truth.markers[::-1]), share=0.4)
    assert known.markers == recording.markers[::-1]
    assert np.array_equal(gappy.origin == Origin.MISSING, mask.hidden)
    assert mask.hidden.any()
    assert not mask.hidden[:, 3].any()
    assert not mask.hidden[origin == Origin.FILLED].any()


def test_a_share_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match=r"at most 0\.667 of the samples; share is 0\.9"):
        dropout(take(10), share=0.9, length=2)
