"""Contracts of every fill, third-party ones included."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from nodegraph import Tried
from nodegraph_fill.gaps import Gaps
from nodegraph_mocap import Origin, Trajectories, contracts

_LONG_ENOUGH = 4
"""Frames of a gap that may be crossed in steps of less than half the distance of its ends."""

_HOW_TO_MARK = "return recording.with_samples(positions, changed=written, origin=Origin.FILLED)"


def present_samples_stay(tried: Tried) -> Iterator[str]:
    """Leave present samples bit for bit as they are, and write only missing ones."""
    for before, after in contracts.before_and_after(tried):
        changed = before.present & np.any(before.positions != after.positions, axis=2)
        if changed.any():
            samples = contracts.places(before, changed)
            yield f"{samples} changed: write where ~recording.present only"


def written_samples_are_marked(tried: Tried) -> Iterator[str]:
    """Mark each sample that is written as filled, and leave the others' origin as it is."""
    for before, after in contracts.before_and_after(tried):
        written = ~before.present & after.present
        unmarked = written & (after.origin != Origin.FILLED)
        if unmarked.any():
            yield f"{contracts.places(before, unmarked)} written but not marked: {_HOW_TO_MARK}"
        renamed = before.present & (after.origin != before.origin)
        if renamed.any():
            samples = contracts.places(before, renamed)
            yield f"{samples} not written but newly marked: {_HOW_TO_MARK}"


def meets_the_ends_as_declared(tried: Tried) -> Iterator[str]:
    """Meet the samples at both ends of a gap, however far apart, if the node declares that."""
    if not tried.meets_ends:
        return
    for recording, output in contracts.before_and_after(tried):
        for marker, start, stop in _gaps_with_ends(recording, output):
            positions = recording.positions.copy()
            positions[stop:, marker] += contracts.SHIFT
            again = contracts.output_again(tried, replace(recording, positions=positions))
            if again is None:
                continue
            path = again.positions[start - 1 : stop + 1, marker]
            steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
            if max(steps[0], steps[-1]) > 0.5 * np.linalg.norm(contracts.SHIFT):
                yield (
                    f"frames {start} to {stop - 1}, marker {recording.markers[marker]!r}: jumps "
                    f"by {steps[0]:.3g} mm into the gap and by {steps[-1]:.3g} mm out of it where "
                    f"its ends are {np.linalg.norm(path[-1] - path[0]):.3g} mm apart"
                )


def does_not_depend_on_the_order_of_markers(tried: Tried) -> Iterator[str]:
    """Fill markers in another order alike, where no tie and no choice depends on it."""
    if not any(_order_matters(before) for before, _ in contracts.before_and_after(tried)):
        yield from contracts.does_not_depend_on_the_order_of_markers(tried)


CONTRACTS = (
    contracts.takes_and_gives_a_recording,
    present_samples_stay,
    written_samples_are_marked,
    meets_the_ends_as_declared,
    contracts.gives_millimetres,
    contracts.looks_ahead_as_declared,
    contracts.moves_with_the_face,
    contracts.turns_with_the_face,
    contracts.scales_with_the_face,
    does_not_depend_on_the_order_of_markers,
)


def _gaps_with_ends(
    recording: Trajectories, output: Trajectories
) -> Iterator[tuple[int, int, int]]:
    """Yield marker, start and stop of the longest gap between samples that is filled, if any."""
    gaps = Gaps.of(recording)
    gaps = gaps.subset(gaps.inner & (gaps.length >= _LONG_ENOUGH))
    for gap in np.argsort(-gaps.length, kind="stable")[:1]:
        marker, start, stop = int(gaps.marker[gap]), int(gaps.start[gap]), int(gaps.stop[gap])
        if output.present[start:stop, marker].all():
            yield marker, start, stop


def _order_matters(recording: Trajectories) -> bool:
    """Return whether a frame lacks several markers, or markers coincide: ties go by order."""
    if np.any(np.count_nonzero(~recording.present, axis=1) > 1):
        return True
    positions = np.nan_to_num(recording.positions, nan=np.inf)
    return any(len(np.unique(points, axis=0)) < len(points) for points in positions)
