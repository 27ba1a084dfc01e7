"""Read a marker set as a value of its own."""

from __future__ import annotations

from nodegraph import InputFile, node
from nodegraph_mocap.files.marker_set_yaml import read_marker_set as read_file
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.paths import find_file


@node("read.marker_set")
def read_marker_set(*, path: InputFile) -> MarkerSet:
    """Read a marker set: which markers are pairs, on the midline, stable, joined when drawn.

    Parameters
    ----------
    path
        A YAML file, a folder that holds ``markers.yaml``, or ``sample:NAME``.

    Returns
    -------
    MarkerSet
        As written; every name in it is one of its markers.

    Raises
    ------
    ValueError
        If the file is not of that form, with the place where it is not.
    """
    return read_file(find_file(path, ("markers.yaml",)))
