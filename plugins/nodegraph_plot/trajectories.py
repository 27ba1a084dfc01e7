"""Trajectories over time: what each method made of a gap."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from nodegraph import Across, Truth, nearest, node
from nodegraph_mocap import Figure, Trajectories
from nodegraph_mocap.frame_ranges import runs_of
from nodegraph_plot.recordings import (
    check_all_markers,
    check_frames,
    check_truth,
    comparable,
    estimated,
    named,
    named_looks,
    true_positions,
)
from nodegraph_tables.style import looks

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FEWEST_AROUND = 10
_MOST_IN_FULL = 6
_BEST = 3
"""Number of methods that are drawn in full where there are more."""

Coordinate = Literal["x", "y", "z"]


@node("plot.trajectories")
def trajectories(
    recordings: Across[Trajectories],
    truth: Truth[Trajectories] | None = None,
    *,
    markers: tuple[str, ...] = (),
    frames: tuple[int, int] | None = None,
    coordinates: tuple[Coordinate, ...] = ("x", "y", "z"),
    reference: str = "",
) -> Figure:
    """Draw coordinates over time: a row per coordinate, a column per marker, a line per recording.

    Where all recordings have the same measured samples, these are drawn once, in grey. Elsewhere
    each has its own line. Up to six are drawn in full, with a symbol on every filled or repaired
    sample and their names beside the lines, in the order in which they lie where they are farthest
    apart. Of more, these are the three of least error and the reference, and the others are thin
    and grey. The error is the root mean square distance to the truth over the filled and repaired
    samples that are drawn; a recording that lacks more of them comes after one that lacks fewer,
    and without a truth the first three are drawn in full. Frames in which any recording has no
    measured sample are shaded. A line that strays from the measured samples and the truth by more
    than one and a half times their range leaves the picture. A sample between two missing ones is
    a dot, and so is a frame alone.

    Parameters
    ----------
    recordings
        Drawn in their order.
    truth
        Drawn as a thin black line.
    markers
        Default: the marker with the most filled and repaired samples (in `frames`, if they are
        given), those with a known truth where there are any, summed over the recordings, else
        with the most missing ones; its name is the panel's title.
    frames
        First and last frame. Default: the longest gap of the drawn markers, with as many frames
        again on each side, at least 10; the whole take where there is no gap.
    coordinates
        Any of x, y, z.
    reference
        Name of a recording that is drawn in full and dashed, whatever its error.

    Raises
    ------
    ValueError
        If a recording has no frames or no markers, lacks one that is asked for, the first frame is
        after the last, or the truth has another number of frames than a recording.
    """
    from nodegraph_plot.trajectory_figure import draw

    by_name = named(recordings)
    check_truth(by_name, truth)
    if frames is not None:
        check_frames(by_name, frames)
    chosen = markers or (_most_estimated(by_name, truth, frames),)
    check_all_markers(by_name, chosen)
    window = _around_gap(by_name, chosen, truth) if frames is None else frames
    if window[0] > window[1]:
        raise ValueError(f"frames are first and last, the first not after the last; got {window}")
    look = named_looks(recordings)
    if reference and reference not in look:
        # a graph names it for all methods of a family, and a command may run a few of these
        there = nearest(reference, look)
        warnings.warn(f"the reference {reference!r} is not drawn; {there}", stacklevel=2)
    full = _in_full(by_name, truth, chosen, window, reference)
    if len(full) < len(by_name):
        look = looks(full)  # with this many, some share a colour in the figures of a graph
    if reference in full:
        look[reference] = replace(look[reference], line="--")
    return draw(by_name, truth, {name: look[name] for name in full}, chosen, window, coordinates)


def _in_full(
    recordings: dict[str, Trajectories],
    truth: Trajectories | None,
    markers: tuple[str, ...],
    window: tuple[int, int],
    reference: str,
) -> set[str]:
    """Return the names of the recordings that are drawn in full."""
    if len(recordings) <= _MOST_IN_FULL:
        return set(recordings)
    shown = slice(window[0], window[1] + 1)

    def rank(name: str) -> tuple[int, float]:
        recording = recordings[name]
        columns = [recording.markers.index(marker) for marker in markers]
        errors = np.linalg.norm(recording.positions - true_positions(truth, recording), axis=2)
        known = np.isfinite(errors) & estimated(recording)
        squares = np.where(known, errors, 0.0)[shown, columns] ** 2
        lacking = int(np.count_nonzero(~recording.present[shown, columns]))
        count = int(np.count_nonzero(known[shown, columns]))
        return lacking, float(np.sqrt(squares.sum() / count)) if count else np.inf

    best = sorted(recordings, key=rank) if truth else list(recordings)
    return {*best[:_BEST], *({reference} & recordings.keys())}


def _most_estimated(
    recordings: dict[str, Trajectories],
    truth: Trajectories | None,
    frames: tuple[int, int] | None,
) -> str:
    """Return the marker with the most estimated samples of known truth, the first of equals."""
    seen = slice(None) if frames is None else slice(frames[0], frames[1] + 1)
    first, *others = recordings.values()
    names = [
        name for name in first.markers if all(name in recording.markers for recording in others)
    ]
    if not names:
        raise ValueError("the recordings have no marker in common")
    filled, missing = (np.zeros(len(names), dtype=int) for _ in range(2))
    for recording in recordings.values():
        columns = [recording.markers.index(name) for name in names]
        filled += comparable(recording, truth)[seen, columns].sum(axis=0)
        missing += (~recording.present)[seen, columns].sum(axis=0)
    return names[int(np.lexsort((-np.arange(len(names)), missing, filled))[-1])]


def _around_gap(
    recordings: dict[str, Trajectories], markers: tuple[str, ...], truth: Trajectories | None
) -> tuple[int, int]:
    """Return first and last frame around the longest run of estimated, else missing samples."""
    length = min(recording.frames for recording in recordings.values())
    flags = [
        _gaps(recording, truth)[:length, recording.markers.index(marker)]
        for recording in recordings.values()
        for marker in markers
    ]
    _, starts, stops = runs_of(np.column_stack(flags))
    if not len(starts):
        return 0, length - 1
    longest = np.argmax(stops - starts)
    first, stop = int(starts[longest]), int(stops[longest])
    around = max(stop - first, _FEWEST_AROUND)
    return max(first - around, 0), min(stop + around, length) - 1


def _gaps(recording: Trajectories, truth: Trajectories | None) -> NDArray[np.bool_]:
    flags = comparable(recording, truth)
    return flags if flags.any() else ~recording.present
