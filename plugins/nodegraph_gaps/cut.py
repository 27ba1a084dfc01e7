"""Cut gaps of one length into a recording."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field

from nodegraph import Truth, Unit, node
from nodegraph_gaps.events import Free, place_events
from nodegraph_gaps.patterns import groups_of
from nodegraph_mocap import Mask, Origin, Trajectories


class Cut(NamedTuple):
    """What a cut gives: the damaged recording, the whole one, and where they differ."""

    gappy: Trajectories
    truth: Truth[Trajectories]
    hidden: Mask


@node("gaps.cut")
def cut(
    recording: Trajectories,
    *,
    length: Annotated[int, Field(ge=1), Unit("frames")] = 15,
    count: Annotated[int, Field(ge=1), Unit("gap events")] = 20,
    simultaneous: Annotated[int, Field(ge=1), Unit("markers")] = 1,
    pattern: Literal["random", "contiguous", "region", "end"] = "random",
    seed: Annotated[int, Field(ge=0)] = 0,
) -> Cut:
    """Hide samples in gaps of one length, at places drawn at random.

    An event hides the same frames of one or more markers. Events never overlap or touch: each
    gap keeps a present sample of its marker on both sides (``end``: on the left). Only measured
    samples are hidden. The places depend on the seed and on the recording, never on a method.

    Parameters
    ----------
    recording
        The recording to damage; what it lacks already stays missing and is not counted.
    length
        Frames that each gap lasts.
    count
        Number of events.
    simultaneous
        Markers that an event hides at once.
    pattern
        Which markers an event hides. ``random``: any. ``contiguous``: one and those nearest to
        it. ``region``: those farthest out in one direction, as when the head turns away.
        ``end``: any, until the take ends.
    seed
        Draws the places.

    Returns
    -------
    gappy
        The recording without the hidden samples.
    truth
        The recording as it came.
    hidden
        The samples that were hidden.

    Raises
    ------
    ValueError
        If the events do not fit; the message says how many do.
    """
    if recording.frames == 0 or not recording.markers:
        raise ValueError("the recording has no samples to hide")
    if simultaneous > len(recording.markers):
        markers = len(recording.markers)
        raise ValueError(f"{simultaneous} markers at once asked, the recording has {markers}")
    random = np.random.default_rng(seed)
    free = Free(recording.measured, length, at_end=pattern == "end")
    groups = groups_of(pattern, recording, simultaneous)
    hidden = place_events(free, groups, count, simultaneous, random)
    positions = np.where(hidden[..., None], np.nan, recording.positions)
    gappy = recording.with_samples(positions, changed=hidden, origin=Origin.MISSING)
    return Cut(gappy, recording, Mask(hidden=hidden, markers=recording.markers))
