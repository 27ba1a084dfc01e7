"""The marker set that belongs to a file: one that is named, or the one in the file's folder."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from nodegraph_mocap.files.marker_set_yaml import read_marker_set
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.paths import find_file
from nodegraph_mocap.recording import Trajectories

_MARKER_SETS = ("markers.yaml",)


def marker_set_for(path: Path, file: Path, given: Path | None) -> MarkerSet | None:
    """Return the marker set of a file, or None.

    Parameters
    ----------
    path
        What the user named.
    file
        The file that this led to. ``markers.yaml`` beside it counts only if the user named the
        folder: results are stored by the content of what is named, and by nothing else.
    given
        The marker set's own file, if the user named one.
    """
    if given is not None:
        return read_marker_set(find_file(given, _MARKER_SETS))
    beside = file.parent / _MARKER_SETS[0]
    asked_for_folder = path != file
    return read_marker_set(beside) if asked_for_folder and beside.is_file() else None


def with_marker_set(recording: Trajectories, found: MarkerSet | None, file: Path) -> Trajectories:
    """Return the recording with that marker set, or as it is if there is none.

    Raises
    ------
    ValueError
        If the set names a marker that the recording lacks.
    """
    if found is None:
        return recording
    absent = [name for name in found.markers if name not in recording.markers]
    if absent:
        raise ValueError(
            f"{file}: the marker set names {', '.join(absent)}, which the recording lacks; it has "
            f"{', '.join(recording.markers)}"
        )
    return replace(recording, marker_set=found)
