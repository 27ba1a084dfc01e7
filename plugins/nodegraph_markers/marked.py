"""Samples that a person has marked as bad."""

from __future__ import annotations

import csv
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np

from nodegraph import InputFile, node, quoted
from nodegraph_mocap import Mask, Origin, Trajectories, check_markers

_HEAD = ["marker", "start", "frames"]


class Marked(NamedTuple):
    """The outputs of `recording.drop_marked`."""

    recording: Trajectories
    marked: Mask


@node("recording.drop_marked")
def drop_marked(recording: Trajectories, *, path: InputFile) -> Marked:
    """Leave out the samples that a person has marked as bad.

    They are marked in `nodegraph view`, which saves them beside the take and leaves the take as it
    is, or written by hand. A warning counts them, so that a report does.

    Parameters
    ----------
    recording
        The take that was looked at.
    path
        A table (CSV) with columns ``marker``, ``start`` (the first frame, counted from 0) and
        ``frames``, a row per span, as `write.mask_csv` writes it.

    Returns
    -------
    recording : Trajectories
        The samples that are marked are missing.
    marked : Mask
        They, those included that had been missing.

    Raises
    ------
    ValueError
        If the file is not of that form, with the line where it is not, or names a marker or a
        frame that the recording lacks.
    """
    marked = np.zeros(recording.origin.shape, dtype=np.bool_)
    for line, marker, start, frames in _spans(Path(path)):
        place = f"{path}:{line}"
        check_markers(recording, [marker], what=f"{place}: the recording")
        if start < 0 or frames < 1 or start + frames > recording.frames:
            raise ValueError(
                f"{place}: {frames} frames from frame {start} on; the recording has frames 0 to "
                f"{recording.frames - 1}"
            )
        marked[start : start + frames, recording.markers.index(marker)] = True
    present = marked & recording.present
    warnings.warn(
        f"{np.count_nonzero(present)} samples by hand are left out, of "
        f"{np.count_nonzero(present.any(axis=0))} markers",
        stacklevel=2,
    )
    positions = np.where(marked[..., np.newaxis], np.nan, recording.positions)
    without = recording.with_samples(positions, changed=marked, origin=Origin.MISSING)
    return Marked(without, Mask(hidden=marked, markers=recording.markers))


def _spans(path: Path) -> list[tuple[int, str, int, int]]:
    """Return line, marker, first frame and number of frames of each span."""
    try:
        rows = list(csv.reader(path.read_text(encoding="utf-8-sig").splitlines()))
    except (UnicodeDecodeError, csv.Error) as error:
        raise ValueError(f"{path}: not a table of text in UTF-8: {error}") from None
    if not rows or rows[0] != _HEAD:
        there = ",".join(rows[0]) if rows else "nothing"
        raise ValueError(f"{path}:1: the columns must be {','.join(_HEAD)}, not {quoted(there)}")
    spans = []
    for line, row in enumerate(rows[1:], 2):
        if not row:
            continue
        try:
            marker, start, frames = row
            spans.append((line, marker, int(start), int(frames)))
        except ValueError:
            raise ValueError(
                f"{path}:{line}: a marker and two whole numbers, not {quoted(','.join(row))}"
            ) from None
    return spans
