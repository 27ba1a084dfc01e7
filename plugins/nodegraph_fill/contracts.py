"""What every fill promises, third-party ones included."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import Origin, Trajectories, promises

_HOW_TO_MARK = "return recording.with_samples(positions, changed=written, origin=Origin.FILLED)"


def present_samples_stay(tried: Tried) -> Iterator[str]:
    """Leave present samples bit for bit as they are, and write only missing ones."""
    for before, after in promises.before_and_after(tried):
        changed = before.present & np.any(before.positions != after.positions, axis=2)
        if changed.any():
            spots = promises.spots(before, changed)
            yield f"{spots} changed: write where ~recording.present only"


def written_samples_are_marked(tried: Tried) -> Iterator[str]:
    """Mark each sample that is written as filled, and leave the others' origin as it is."""
    for before, after in promises.before_and_after(tried):
        written = ~before.present & after.present
        unmarked = written & (after.origin != Origin.FILLED)
        if unmarked.any():
            yield f"{promises.spots(before, unmarked)} written but not marked: {_HOW_TO_MARK}"
        renamed = before.present & (after.origin != before.origin)
        if renamed.any():
            yield f"{promises.spots(before, renamed)} not written but marked anew: {_HOW_TO_MARK}"


def does_not_depend_on_the_order_of_markers(tried: Tried) -> Iterator[str]:
    """Fill markers in another order alike, where no tie and no choice depends on it."""
    if not any(_order_matters(before) for before, _ in promises.before_and_after(tried)):
        yield from promises.does_not_depend_on_the_order_of_markers(tried)


CONTRACTS = (
    promises.takes_and_gives_a_recording,
    present_samples_stay,
    written_samples_are_marked,
    promises.gives_millimetres,
    promises.looks_ahead_as_declared,
    promises.moves_with_the_face,
    promises.turns_with_the_face,
    promises.scales_with_the_face,
    does_not_depend_on_the_order_of_markers,
)


def _order_matters(recording: Trajectories) -> bool:
    """Return whether a frame lacks several markers, or markers coincide: ties go by order."""
    if np.any(np.count_nonzero(~recording.present, axis=1) > 1):
        return True
    positions = np.nan_to_num(recording.positions, nan=np.inf)
    return any(len(np.unique(points, axis=0)) < len(points) for points in positions)
