"""Trajectories over time: what each method made of a gap."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from nodegraph import Across, Truth, node
from nodegraph_mocap import Figure, Trajectories
from nodegraph_plot.gathered import (
    check_frames,
    check_markers,
    made,
    named,
    named_looks,
    true_positions,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FEWEST_AROUND = 10

Coordinate = Literal["x", "y", "z"]


@node("plot.trajectories")
def trajectories(
    recordings: Across[Trajectories],
    truth: Truth[Trajectories] | None = None,
    *,
    markers: tuple[str, ...] = (),
    frames: tuple[int, int] | None = None,
    coordinates: tuple[Coordinate, ...] = ("x", "y", "z"),
) -> Figure:
    """Draw coordinates over time: a row per coordinate, a column per marker, a line per recording.

    Where all recordings have the same measured samples, these are drawn once, in grey. Elsewhere
    each has its own line, with a symbol on every filled or repaired sample. Frames in which any
    recording has no measured sample are shaded. A line that strays from the measured samples and
    the truth by more than one and a half times their range leaves the picture.

    Parameters
    ----------
    recordings
        Drawn in their order.
    truth
        Drawn as a thin black line.
    markers
        Default: the marker with the most filled and repaired samples, summed over the
        recordings, else with the most missing ones; its name is the panel's title.
    frames
        First and last frame. Default: the longest gap of the drawn markers, with as many frames
        again on each side, at least 10; the whole take where there is no gap.
    coordinates
        Any of x, y, z.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If a recording lacks a marker or a frame, the first frame is not before the last, or the
        truth has another number of frames than a recording.
    """
    from nodegraph_plot.trajectory_figure import draw

    by_name = named(recordings)
    chosen = markers or (_most_made(by_name),)
    check_markers(by_name, chosen)
    known = {name: true_positions(truth, one, name) for name, one in by_name.items()}
    window = _around_gap(by_name, chosen) if frames is None else frames
    check_frames(by_name, window)
    if window[0] >= window[1]:
        raise ValueError(f"frames are first and last, the first before the last; got {window}")
    return draw(by_name, known, named_looks(recordings), chosen, window, coordinates)


def _most_made(recordings: dict[str, Trajectories]) -> str:
    """Return the marker with the most filled samples; the first recording's order breaks ties."""
    names = next(iter(recordings.values())).markers
    counts = dict.fromkeys(names, (0, 0))
    for recording in recordings.values():
        filled, missing = made(recording).sum(axis=0), (~recording.present).sum(axis=0)
        for column, name in enumerate(recording.markers):
            if name in counts:
                before = counts[name]
                counts[name] = (before[0] + int(filled[column]), before[1] + int(missing[column]))
    return max(counts, key=lambda name: counts[name])


def _around_gap(
    recordings: dict[str, Trajectories], markers: tuple[str, ...]
) -> tuple[int, int]:
    """Return first and last frame around the longest run of samples that were not measured."""
    length = min(recording.frames for recording in recordings.values())
    longest = (0, 0, 0)
    for recording in recordings.values():
        for marker in markers:
            column = recording.markers.index(marker)
            first, last = _longest_run(_unmeasured(recording)[:length, column])
            longest = max(longest, (last - first + 1, first, last), key=lambda run: run[0])
    count, first, last = longest
    if not count:
        return 0, length - 1
    around = max(count, _FEWEST_AROUND)
    return max(first - around, 0), min(last + around, length - 1)


def _unmeasured(recording: Trajectories) -> NDArray[np.bool_]:
    return made(recording) | ~recording.present


def _longest_run(flags: NDArray[np.bool_]) -> tuple[int, int]:
    """Return first and last place of the longest run of True; (0, -1) where there is none."""
    edges = np.diff(np.pad(flags.astype(np.int8), 1))
    first, last = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1
    if not len(first):
        return 0, -1
    longest = int(np.argmax(last - first))
    return int(first[longest]), int(last[longest])
