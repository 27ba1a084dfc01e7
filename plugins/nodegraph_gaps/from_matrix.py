"""Gaps that somebody else has cut, as a matrix of zeros and ones in a text file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import InputFile, Truth, node, quoted
from nodegraph_files.text.table import text_lines
from nodegraph_gaps.cut import Cut, without
from nodegraph_mocap import Mask, Origin, Trajectories
from nodegraph_mocap.truth import truth_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

_AXES = 3


@node("gaps.from_matrix")
def from_matrix(
    recording: Trajectories, truth: Truth[Trajectories] | None = None, *, path: InputFile
) -> Cut:
    """Hide the samples that a matrix of zeros and ones leaves out, as masks are often published.

    Only measured (or repaired) samples are hidden; what the recording lacks stays missing.

    Parameters
    ----------
    recording
        T frames of M markers, with or without gaps of their own.
    truth
        The recording that errors are measured to, the same frames and markers without noise;
        `recording` itself if left open. It has no influence on what is hidden.
    path
        A text file of T lines with 3 M numbers each, separated by spaces: 1 for a sample that
        stays and 0 for one that is hidden, three alike for the coordinates of a marker. As it
        names no markers, they are those of the recording, in its order.

    Raises
    ------
    ValueError
        If the file is not of that form or size, with the line where it is not. With `truth`: if
        its frames, rate or markers are not those of the recording, or it lacks a sample that is
        hidden.
    """
    measured = np.isin(recording.origin, (Origin.MEASURED, Origin.REPAIRED))
    hidden = measured & ~_kept(path, len(recording.markers), recording.frames)
    return Cut(
        without(recording, hidden),
        truth_of(recording, truth, hidden),
        Mask(hidden=hidden, markers=recording.markers),
    )


def _kept(path: Path, markers: int, frames: int) -> NDArray[np.bool_]:
    """Return which samples of markers stay, (T, M)."""
    lines = text_lines(path)
    if len(lines) != frames:
        raise ValueError(f"{path}: {len(lines)} lines, the recording has {frames} frames")
    kept = np.empty((frames, markers), dtype=np.bool_)
    for frame, line in enumerate(lines):
        place, cells = f"{path}:{frame + 1}", line.split()
        if len(cells) != _AXES * markers:
            raise ValueError(
                f"{place}: {len(cells)} numbers, the {markers} markers of the recording have "
                f"{_AXES * markers} coordinates"
            )
        if strange := next((cell for cell in cells if cell not in ("0", "1")), ""):
            raise ValueError(f"{place}: numbers must be 0 or 1, not {quoted(strange)}")
        coordinates = np.array(cells).reshape(markers, _AXES) == "1"
        kept[frame] = coordinates[:, 0]
        parted = (coordinates != coordinates[:, :1]).any(axis=1)
        if parted.any():
            raise ValueError(
                f"{place}: the coordinates of marker {int(parted.argmax()) + 1} are partly hidden: "
                "a marker has a sample or has none"
            )
    return kept
