"""What a reader wants to know of a file's value first: size, rate, what is missing and suspect."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Fact
from nodegraph_mocap.frame_ranges import runs_of
from nodegraph_mocap.marks import KINDS
from nodegraph_mocap.recording import Origin
from nodegraph_mocap.suspect import impulses

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap.animation import Animation
    from nodegraph_mocap.face_model import BlendshapeModel, Weights
    from nodegraph_mocap.head import Head
    from nodegraph_mocap.marker_set import MarkerSet
    from nodegraph_mocap.marks import Marks
    from nodegraph_mocap.recording import Trajectories
    from nodegraph_mocap.selection import Selection

_MOST_FRAMES = 200
"""Frames that are looked at for a size."""


def facts_of_recording(recording: Trajectories) -> Iterator[Fact]:
    """Yield length and rate, markers, and what is missing, made or suspect, by marker."""
    yield from _length(recording.frames, recording.rate)
    yield Fact("markers", recording.markers)
    step = max(1, recording.frames // _MOST_FRAMES)
    yield from _size("size of the markers", recording.positions[::step])
    samples = max(recording.origin.size, 1)
    missing = int(np.count_nonzero(~recording.present))
    yield Fact("missing samples", missing)
    yield Fact("share missing", round(100 * missing / samples, 3), "%")
    for origin in (Origin.FILLED, Origin.REPAIRED):
        count = int(np.count_nonzero(recording.origin == origin))
        if count:
            yield Fact(f"{origin.name.lower()} samples", count)
    if recording.sigma is not None:
        yield Fact("standard deviations", "of each sample")
    suspect = impulses(recording.positions) > 0
    yield Fact("likely impulses", int(np.count_nonzero(suspect)))
    faults = _faults(recording, suspect)
    if faults:
        yield Fact("markers with gaps or impulses", faults)
    if recording.marker_set is not None:
        yield from _facts_of_set(recording.marker_set)


def facts_of_weights(weights: Weights) -> Iterator[Fact]:
    """Yield length and rate, shapes, and which weights are missing, beyond 0 to 1, or constant."""
    yield from _length(weights.frames, weights.rate)
    yield Fact("shapes", weights.names)
    values = weights.values
    known = ~np.isnan(values)
    yield Fact("frames with missing weights", int(np.count_nonzero(~known.all(axis=1))))
    yield Fact("weights below 0 or above 1", int(np.count_nonzero((values < 0) | (values > 1))))
    changes = np.nan_to_num(values, nan=-np.inf).max(axis=0, initial=-np.inf) > np.nan_to_num(
        values, nan=np.inf
    ).min(axis=0, initial=np.inf)
    still = [name for name, moves in zip(weights.names, changes, strict=True) if not moves]
    yield Fact("shapes that do not change", still)


def facts_of_animation(animation: Animation) -> Iterator[Fact]:
    """Yield what there is to know of the weights and the head, and how far the head moves."""
    yield from facts_of_weights(animation.weights)
    motion = animation.head_motion
    if motion is not None:
        turned = motion.rotations @ motion.rotations[:1].transpose(0, 2, 1)
        cosines = np.clip((np.trace(turned, axis1=1, axis2=2) - 1) / 2, -1, 1)
        farthest = float(np.degrees(np.arccos(cosines.min(initial=1.0))))
        yield Fact("head turns by up to", round(farthest, 1), "degrees")
    yield from facts_of_head(animation.head)


def facts_of_head(head: Head) -> Iterator[Fact]:
    """Yield the size of the mesh, its morph targets and its markers."""
    yield Fact("vertices", len(head.vertices))
    yield Fact("triangles", len(head.faces))
    yield from _size("size", head.vertices[np.newaxis])
    yield Fact("morph targets", head.names)
    yield Fact("markers", head.markers)


def facts_of_model(model: BlendshapeModel) -> Iterator[Fact]:
    """Yield markers and shapes, and how far each shape moves the marker that it moves most."""
    yield Fact("markers", model.markers)
    yield from _size("size of the face at rest", model.neutral[np.newaxis])
    yield Fact("shapes", model.names)
    farthest = np.linalg.norm(model.shapes, axis=2).max(axis=1, initial=0.0)
    yield Fact(
        "farthest movement at weight 1",
        {
            name: {"mm": round(distance, 2)}
            for name, distance in zip(model.names, farthest.tolist(), strict=True)
        },
    )


def facts_of_marks(marks: Marks) -> Iterator[Fact]:
    """Yield how many spans and frames are marked as what, and each marker's."""
    by_marker = {mark.marker: dict.fromkeys(map(str, KINDS), 0) for mark in marks.marks}
    for mark in marks.marks:
        by_marker[mark.marker][mark.kind] += mark.frames
    yield Fact("spans", len(marks.marks))
    for kind in KINDS:
        yield Fact(f"frames {kind}", sum(count[kind] for count in by_marker.values()))
    yield Fact("frames by marker", by_marker)


def facts_of_marker_set(marker_set: MarkerSet) -> Iterator[Fact]:
    """Yield the markers, and what the set knows of them."""
    yield Fact("markers", marker_set.markers)
    yield from _facts_of_set(marker_set)


def facts_of_selection(selection: Selection) -> Iterator[Fact]:
    """Yield the chosen markers, how often each pair was chosen, and how the search went."""
    yield Fact("chosen markers", selection.chosen)
    pairs = [" - ".join(pair) for pair in selection.pairs]
    yield Fact("pairs to choose from", pairs)
    if selection.frequencies is not None:
        shares = zip(pairs, selection.frequencies.tolist(), strict=True)
        yield Fact("how often each was chosen", {pair: {"share": share} for pair, share in shares})
    if selection.history is not None:
        rows = [
            dict(zip(selection.columns, row, strict=True)) for row in selection.history.tolist()
        ]
        yield Fact("history", {f"trial {number}": row for number, row in enumerate(rows, 1)})


def _length(frames: int, rate: float) -> Iterator[Fact]:
    yield Fact("frames", frames)
    yield Fact("rate", rate, "Hz")
    yield Fact("duration", round(frames / rate, 3), "s")


def _size(name: str, positions: NDArray[np.float64]) -> Iterator[Fact]:
    """Yield the longest side of the bounding box, the median of (T, M, 3) frames."""
    some = positions[~np.isnan(positions).all(axis=(1, 2))]
    if some.size:
        # fmax and fmin pass over NaN
        sides = np.fmax.reduce(some, axis=1) - np.fmin.reduce(some, axis=1)
        yield Fact(name, round(float(np.median(sides.max(axis=1))), 1), "mm")


def _faults(
    recording: Trajectories, suspect: NDArray[np.bool_]
) -> dict[str, dict[str, int | float]]:
    """Return the numbers of each marker that has a gap or an impulse."""
    missing = ~recording.present
    gaps = runs_of(missing)
    number = np.bincount(gaps.marker, minlength=len(recording.markers))
    longest = gaps.longest(len(recording.markers))
    count, sudden = missing.sum(axis=0), suspect.sum(axis=0)
    return {
        recording.markers[column]: {
            "missing": int(count[column]),
            "percent": round(100 * int(count[column]) / recording.frames, 2),
            "gaps": int(number[column]),
            "longest": int(longest[column]),
            "impulses": int(sudden[column]),
        }
        for column in np.flatnonzero(count + sudden)
    }


def _facts_of_set(marker_set: MarkerSet) -> Iterator[Fact]:
    for name, couples in (("pairs", marker_set.pairs), ("lines", marker_set.edges)):
        yield Fact(name, [" - ".join(couple) for couple in couples])
    yield Fact("on the midline", marker_set.midline)
    yield Fact("stable", marker_set.stable)
