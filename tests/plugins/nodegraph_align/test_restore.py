"""Head motion is put back as captured = s R x + t."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from nodegraph_align.procrustes import procrustes
from nodegraph_align.restore import restore
from nodegraph_mocap import HeadMotion, Origin, Trajectories
from tests.plugins.nodegraph_align.heads import make_head, make_recording, run_moved

Head = Callable[..., tuple[Trajectories, HeadMotion]]


def test_it_is_the_formula() -> None:
    rest, motion = make_head(frames=6)
    motion = replace(motion, scales=np.linspace(0.5, 2.0, 6))
    still = make_recording(np.repeat(rest.positions, 6, axis=0))
    aligned = restore(still, motion)
    np.testing.assert_allclose(aligned.positions, run_moved(rest, motion).positions, atol=1e-9)


def test_it_undoes_an_alignment_and_keeps_what_is_known_of_samples() -> None:
    rest, motion = make_head(frames=6)
    take = run_moved(rest, replace(motion, scales=np.linspace(0.5, 2.0, 6)))
    positions, origin = take.positions.copy(), take.origin.copy()
    positions[2, 9], origin[2, 9], origin[3, 3] = np.nan, Origin.MISSING, Origin.FILLED
    take = replace(take, positions=positions, origin=origin, sigma=np.full((6, 12), 0.25))
    aligned = procrustes(take, rest, scale="rms", restore=False)
    back = restore(aligned.aligned, aligned.head_motion)
    np.testing.assert_allclose(back.positions, positions, atol=1e-9)
    np.testing.assert_array_equal(back.origin, origin)
    assert back.sigma is not None
    np.testing.assert_allclose(back.sigma, np.where(take.present, 0.25, np.nan))
    assert back.marker_set is take.marker_set


def test_frames_that_do_not_match() -> None:
    rest, motion = make_head(frames=6)
    with pytest.raises(ValueError, match="the recording has 1 frames, the head motion 6"):
        restore(rest, motion)
