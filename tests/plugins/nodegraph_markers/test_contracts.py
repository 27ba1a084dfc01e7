"""A node of the family that breaks its promises is caught."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from nodegraph_mocap import Origin, Trajectories
from tests.promises import Family

MARKERS = Family("markers")


def moved(given: Trajectories) -> Trajectories:
    return replace(given, positions=given.positions + 1e-9)


def twice(given: Trajectories) -> Trajectories:
    return replace(
        given,
        positions=np.concatenate([given.positions] * 2, axis=1),
        origin=np.concatenate([given.origin] * 2, axis=1),
        sigma=None,
        markers=(*given.markers, *(f"{name}_again" for name in given.markers)),
    )


def marked(given: Trajectories) -> Trajectories:
    return replace(given, origin=np.where(given.present, Origin.FILLED, Origin.MISSING))


def shorter(given: Trajectories) -> Trajectories:
    sigma = None if given.sigma is None else given.sigma[1:]
    return replace(given, positions=given.positions[1:], origin=given.origin[1:], sigma=sigma)


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (moved, "samples are none of their frame"),
        (twice, "samples are used more than once"),
        (marked, "or their origin changed"),
        (shorter, "frames went in as"),
    ],
)
def test_a_node_that_breaks_a_promise(
    spoil: Callable[[Trajectories], Trajectories], text: str
) -> None:
    def broken(recording: Trajectories) -> Trajectories:
        """Spoil a recording."""
        return spoil(recording)

    MARKERS.refuses(broken, text)


def test_a_node_with_other_ports() -> None:
    def broken(take: Trajectories) -> Trajectories:
        """Hand on a recording."""
        return take

    MARKERS.refuses(broken, "name the recording `recording`")
