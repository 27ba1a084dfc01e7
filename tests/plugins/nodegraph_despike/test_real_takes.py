"""What is found in recordings of real faces without impulses, and with some added."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from nodegraph_despike.acceleration import acceleration
from nodegraph_despike.hampel import hampel
from nodegraph_despike.impulse import impulse
from nodegraph_despike.median import median
from nodegraph_despike.wavelet import wavelet
from nodegraph_mocap import Origin, Trajectories
from nodegraph_synthesize.impulses import add
from tests.plugins.recordings import quietly, real_take
from tests.studies import needs_recordings

pytestmark = needs_recordings


@pytest.mark.parametrize(
    ("name", "share", "mean", "most"),
    [
        ("animface/jaw", 0.169, 0.0166, 0.112),
        ("animface/cheeks", 0.187, 0.0406, 0.422),
        ("facecap/take001", 0.115, 1.43, 10.6),
    ],
)
def test_the_impulse_filter_takes_much_of_a_clean_face_for_noise(
    name: str, share: float, mean: float, most: float
) -> None:
    clean = real_take(name)
    despiked = quietly(impulse, clean)
    bad = despiked.origin == Origin.REPAIRED
    moved = np.linalg.norm(despiked.positions - clean.positions, axis=2)[bad]
    assert bad.mean() == pytest.approx(share, abs=0.001)
    assert moved.mean() == pytest.approx(mean, rel=0.02)
    assert moved.max() == pytest.approx(most, rel=0.02)


@pytest.mark.parametrize("method", [hampel, median, acceleration, wavelet])
@pytest.mark.parametrize("name", ["jaw", "cheeks"])
def test_its_rivals_leave_a_clean_face_alone_and_find_what_is_added(
    method: Callable[..., Trajectories], name: str
) -> None:
    clean = real_take(f"animface/{name}")
    assert np.mean(quietly(method, clean).origin == Origin.REPAIRED) < 1e-4
    spiky, _, hit = add(clean, share=0.005, size=5.0, seed=1)
    actual = quietly(method, spiky).origin == Origin.REPAIRED
    assert actual[hit.hidden].mean() > 0.94
    assert hit.hidden[actual].mean() > 0.99
