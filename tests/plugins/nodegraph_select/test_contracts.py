"""A selection that breaks a promise is caught, and ours keep them all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from nodegraph_mocap import Selection, Trajectories
from nodegraph_select.variance import variance
from tests.promises import Family

SELECT = Family("select")
Spoil = Callable[[Trajectories, Selection], object]


def no_selection(recording: Trajectories, selection: Selection) -> tuple[str, ...]:
    return selection.chosen


def none_chosen(recording: Trajectories, selection: Selection) -> Selection:
    return Selection(chosen=())


def strangers(recording: Trajectories, selection: Selection) -> Selection:
    return Selection(chosen=("tail",))


def backwards(recording: Trajectories, selection: Selection) -> Selection:
    return replace(selection, chosen=selection.chosen[::-1])


def half_of_a_pair(recording: Trajectories, selection: Selection) -> Selection:
    return Selection(chosen=selection.chosen[:3])


def forgets_a_pair(recording: Trajectories, selection: Selection) -> Selection:
    left = tuple(pair for pair in selection.pairs if pair[0] in selection.chosen)
    return Selection(chosen=selection.chosen, pairs=left)


def first_ones(recording: Trajectories, selection: Selection) -> Selection:
    return whole(recording, recording.markers[0])


def nearest_to_zero(recording: Trajectories, selection: Selection) -> Selection:
    return whole(recording, recording.markers[int(np.abs(recording.positions[0, :, 0]).argmin())])


def topmost(recording: Trajectories, selection: Selection) -> Selection:
    return whole(recording, recording.markers[int(recording.positions[0, :, 1].argmax())])


def by_the_millimetre(recording: Trajectories, selection: Selection) -> Selection:
    return variance(recording, k=2 if np.ptp(recording.positions[..., 0]) > 200.0 else 5)


def whole(recording: Trajectories, name: str) -> Selection:
    pairs = recording.marker_set.pairs if recording.marker_set else ()
    chosen = next((pair for pair in pairs if name in pair), (name,))
    return Selection(chosen=tuple(value for value in recording.markers if value in chosen))


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (no_selection, "its first output is not a selection; it gives"),
        (none_chosen, "chooses none"),
        (strangers, "chooses tail, which the recording lacks"),
        (backwards, "but the recording has them in another order"),
        (half_of_a_pair, "of the pair"),
        (forgets_a_pair, "pairs and markers differ in"),
        (first_ones, "only one of the recording and the reordered one has"),
        (nearest_to_zero, "only one of the recording and the shifted one has"),
        (topmost, "only one of the recording and the turned one has"),
        (by_the_millimetre, "only one of the recording and the enlarged one has"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*chosen or left each by itself")
def test_a_selection_that_breaks_a_promise(spoil: Spoil, text: str) -> None:
    kind = tuple if spoil is no_selection else Selection

    def broken(recording: Trajectories) -> object:
        """Choose five markers, and spoil it."""
        return spoil(recording, variance(recording, k=5))

    broken.__annotations__["return"] = kind
    SELECT.refuses(broken, text)


@pytest.mark.filterwarnings("ignore:.*chosen or left each by itself")
def test_who_depends_on_the_axes_may_say_so() -> None:
    def declared(recording: Trajectories) -> Selection:
        """Choose the topmost marker of a complete take. It depends on the axes."""
        return topmost(recording, variance(recording, k=1))

    SELECT.accepts(declared)


def test_another_name_of_the_port() -> None:
    def broken(take: Trajectories) -> Selection:
        """Choose the first marker."""
        return whole(take, take.markers[0])

    SELECT.refuses(broken, "its ports are take; name the recording `recording`")
