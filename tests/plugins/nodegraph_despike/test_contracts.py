"""A despiker that breaks a promise is caught."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import nodegraph_despike
from nodegraph.node.decorator import node_of
from nodegraph_mocap import Origin, Trajectories
from tests.promises import Family

DESPIKE = Family("despike")


def marked(recording: Trajectories, positions: Any, bad: Any) -> Trajectories:
    sigma = None if recording.sigma is None else np.where(bad, np.nan, recording.sigma)
    return recording.with_samples(positions, changed=bad, origin=Origin.REPAIRED, sigma=sigma)


def present_in(recording: Trajectories, frame: int) -> Any:
    chosen = np.zeros(recording.origin.shape, dtype=bool)
    chosen[frame] = recording.present[frame]
    return chosen


def fills(before: Trajectories) -> Trajectories:
    positions = np.where(before.present[..., None], before.positions, 0.0)
    return marked(before, positions, ~before.present)


def cuts(before: Trajectories) -> Trajectories:
    bad = present_in(before, 0)
    return marked(before, np.where(bad[..., None], np.nan, before.positions), bad)


def does_not_mark(before: Trajectories) -> Trajectories:
    bad = present_in(before, 0)
    sigma = None if before.sigma is None else np.where(bad, np.nan, before.sigma)
    return replace(before, positions=before.positions + bad[..., None], sigma=sigma)


def marks_too_much(before: Trajectories) -> Trajectories:
    bad = present_in(before, 0) & (before.origin == Origin.MEASURED)
    return replace(before, origin=np.where(bad, np.uint8(Origin.REPAIRED), before.origin))


def keeps_sigma(before: Trajectories) -> Trajectories:
    bad = present_in(before, 0)
    moved = before.positions + bad[..., None]
    return before.with_samples(moved, changed=bad, origin=Origin.REPAIRED)


def drops_sigma(before: Trajectories) -> Trajectories:
    return replace(before, sigma=None)


def other_sigma(before: Trajectories) -> Trajectories:
    return before if before.sigma is None else replace(before, sigma=before.sigma * 2)


def by_place(before: Trajectories) -> Trajectories:
    bad = present_in(before, 0) & (before.positions[..., 0] > 0)
    return marked(before, before.positions + bad[..., None], bad)


def by_order(before: Trajectories) -> Trajectories:
    bad = present_in(before, 0)
    bad[:, 1:] = False
    return marked(before, before.positions + bad[..., None], bad)


def faster(before: Trajectories) -> Trajectories:
    return replace(before, rate=2 * before.rate)


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (fills, "filled"),
        (cuts, "removed"),
        (does_not_mark, "changed but not marked"),
        (marks_too_much, "not changed but newly marked"),
        (keeps_sigma, "with the sigma of what it was"),
        (drops_sigma, "sigma is gone"),
        (other_sigma, "not changed but with another sigma"),
        (by_place, "differ, by up to 1.73 mm"),
        (by_order, "differ, by up to 1.73 mm"),
        (faster, "rate went in as"),
    ],
)
def test_a_despiker_that_breaks_a_promise(
    spoil: Callable[[Trajectories], Trajectories], text: str
) -> None:
    def broken(recording: Trajectories) -> Trajectories:
        """Spoil the recording."""
        return spoil(recording)

    DESPIKE.refuses(broken, text)


def test_a_despiker_with_other_ports() -> None:
    def broken(take: Trajectories) -> Trajectories:
        """Leave it."""
        return take

    DESPIKE.refuses(broken, "name the recording `recording`")


@pytest.mark.parametrize("despiker", list(nodegraph_despike.nodegraph_nodes()))
def test_good_ones_pass_where_they_repair_much(despiker: Callable[..., Trajectories]) -> None:
    known = node_of(despiker)
    assert known is not None
    names = [name for name in ("factor", "threshold") if name in known.settings]
    DESPIKE.accepts(despiker, **dict.fromkeys(names, 0.05))
