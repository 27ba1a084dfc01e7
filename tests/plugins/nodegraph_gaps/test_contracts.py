"""A node that makes gaps and breaks a promise is caught."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import Truth
from nodegraph_mocap import Mask, Origin, Trajectories
from tests.promises import Family

GAPS = Family("gaps")


class Cut(NamedTuple):
    gappy: Trajectories
    truth: Truth[Trajectories]
    hidden: Mask


def cut(recording: Trajectories) -> Cut:
    """Hide every third frame."""
    hidden = recording.present.copy()
    hidden[np.arange(recording.frames) % 3 > 0] = False
    return Cut(
        without(recording, hidden), recording, Mask(hidden=hidden, markers=recording.markers)
    )


def without(recording: Trajectories, hidden: NDArray[np.bool_]) -> Trajectories:
    positions = np.where(hidden[..., None], np.nan, recording.positions)
    return recording.with_samples(positions, changed=hidden, origin=Origin.MISSING)


def other_truth(output: Cut) -> Cut:
    return output._replace(truth=replace(output.truth, positions=output.truth.positions + 1e-9))


def other_origin(output: Cut) -> Cut:
    origin = np.where(output.truth.present, np.uint8(Origin.FILLED), np.uint8(Origin.MISSING))
    return output._replace(truth=replace(output.truth, origin=origin))


def other_samples(output: Cut) -> Cut:
    return output._replace(gappy=replace(output.gappy, positions=output.gappy.positions + 1e-9))


def still_there(output: Cut) -> Cut:
    return output._replace(gappy=output.truth)


def missing_before(output: Cut) -> Cut:
    everything = np.ones_like(output.hidden.hidden)
    return output._replace(
        gappy=without(output.truth, everything), hidden=replace(output.hidden, hidden=everything)
    )


def test_a_good_cut_passes() -> None:
    GAPS.accepts(cut)


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (other_truth, "return it as it came"),
        (other_origin, "return it as it came"),
        (other_samples, "samples that are not hidden differ"),
        (still_there, "hidden samples are still there"),
        (missing_before, "hidden samples were missing before"),
    ],
)
def test_a_cut_that_says_something_else_than_it_does(
    spoil: Callable[[Cut], Cut], text: str
) -> None:
    def broken(recording: Trajectories) -> Cut:
        """Hide every third frame, and spoil it."""
        return spoil(cut(recording))

    GAPS.refuses(broken, text)


def test_a_cut_with_other_ports() -> None:
    def broken(recording: Trajectories) -> Trajectories:
        """Hide nothing."""
        return recording

    text = GAPS.refuses(broken, "'hidden' is not a Mask; its ports are recording, output")
    assert "KeyError" not in text
