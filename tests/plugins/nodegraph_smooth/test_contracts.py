"""A smoothing that breaks a promise is caught."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Annotated

import numpy as np
import pytest

from nodegraph import Unit
from nodegraph_mocap import Origin, Trajectories
from nodegraph_smooth.bspline import bspline
from tests.promises import Family

SMOOTH = Family("smooth")


def faster(before: Trajectories, after: Trajectories) -> Trajectories:
    return replace(after, rate=2 * after.rate)


def nameless(before: Trajectories, after: Trajectories) -> Trajectories:
    return replace(after, marker_set=None)


def fills(before: Trajectories, after: Trajectories) -> Trajectories:
    return Trajectories(
        positions=np.nan_to_num(after.positions),
        markers=after.markers,
        rate=after.rate,
        marker_set=after.marker_set,
    )


def loses(before: Trajectories, after: Trajectories) -> Trajectories:
    positions = after.positions.copy()
    positions[: len(positions) // 5] = np.nan
    return after.with_samples(positions, changed=np.isnan(positions[..., 0]), origin=Origin.MISSING)


def renames(before: Trajectories, after: Trajectories) -> Trajectories:
    return replace(after, origin=np.where(after.present, np.uint8(2), np.uint8(0)))


def shrinks(before: Trajectories, after: Trajectories) -> Trajectories:
    return replace(after, positions=0.999 * after.positions)


def flattens(before: Trajectories, after: Trajectories) -> Trajectories:
    positions = after.positions.copy()
    positions[..., 2] = before.positions[..., 2]
    return replace(after, positions=positions)


def first_first(before: Trajectories, after: Trajectories) -> Trajectories:
    positions = after.positions.copy()
    positions[:, 0] = before.positions[:, 0]
    return replace(after, positions=positions)


def late(before: Trajectories, after: Trajectories) -> Trajectories:
    """Two frames late, and still looking ahead."""
    positions = after.positions.copy()
    there = after.present[2:] & after.present[:-2]
    positions[2:][there] = after.positions[:-2][there]
    return replace(after, positions=positions)


def early(before: Trajectories, after: Trajectories) -> Trajectories:
    positions = after.positions.copy()
    there = after.present[1:] & after.present[:-1]
    positions[:-1][there] = after.positions[1:][there]
    return replace(after, positions=positions)


def trusts(before: Trajectories, after: Trajectories) -> Trajectories:
    return replace(after, sigma=before.sigma)


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (faster, "rate went in as"),
        (nameless, "marker_set went in as"),
        (fills, "filled: leave that to a fill"),
        (loses, "lost: smooth each run of present samples by itself"),
        (renames, "called otherwise: return"),
        (shrinks, "Do with a recording that is shifted as a whole what is done with the one"),
        (flattens, "or say .depends on the axes."),
        (first_first, "Do the same with markers in another order"),
        (early, "a nod comes out 1.00 frames early, although frames ahead are looked at"),
        (trusts, "changed but with its old sigma"),
    ],
)
def test_a_smoothing_that_breaks_a_promise(
    spoil: Callable[[Trajectories, Trajectories], Trajectories], text: str
) -> None:
    def broken(recording: Trajectories) -> Trajectories:
        """Smooth, and spoil it."""
        return spoil(recording, bspline(recording))

    SMOOTH.refuses(broken, text)


def test_a_smoothing_that_lags_although_it_looks_ahead() -> None:
    def broken(recording: Trajectories) -> Trajectories:
        """Smooth with a long window, and hand it on late."""
        return late(recording, bspline(recording, order=9))

    SMOOTH.refuses(broken, r"a nod comes out 2\.00 frames late, although")


def test_a_smoothing_with_other_ports() -> None:
    def broken(captured: Trajectories) -> Trajectories:
        """Smooth."""
        return bspline(captured)

    SMOOTH.refuses(broken, "name the recording `recording`")


def test_one_that_sees_no_frame_ahead_may_lag() -> None:
    def lagging(recording: Trajectories) -> Trajectories:
        """Smooth causally: the mean of each sample and the one before."""
        positions = recording.positions.copy()
        there = recording.present[1:] & recording.present[:-1]
        before, after = recording.positions[:-1][there], recording.positions[1:][there]
        positions[1:][there] = 0.5 * (before + after)
        sigma = None if recording.sigma is None else np.full_like(recording.sigma, np.nan)
        return replace(recording, positions=positions, sigma=sigma)

    SMOOTH.accepts(lagging)


def test_one_that_goes_by_coordinates_may_depend_on_the_axes() -> None:
    def stepwise(
        recording: Trajectories, *, most: Annotated[float, Unit("mm")] = 0.01
    ) -> Trajectories:
        """Smooth each coordinate by itself, small deviations only: depends on the axes.

        Parameters
        ----------
        recording
            Any.
        most
            By how much a coordinate may change.
        """
        change = bspline(recording).positions - recording.positions
        small = np.sign(change) * np.minimum(np.abs(change), most)
        return replace(recording, positions=recording.positions + small, sigma=None)

    SMOOTH.accepts(stepwise)
