"""A recording reduced to some of its markers."""

from __future__ import annotations

from nodegraph import node
from nodegraph_mocap import Selection, Trajectories, check_markers


@node("markers.keep", requires=lambda recording, names: check_markers(recording, names or ()))
def keep(
    recording: Trajectories,
    selection: Selection | None = None,
    *,
    names: list[str] | None = None,
) -> Trajectories:
    """Keep the markers of a selection, or those that are named, and leave out the others.

    Either a selection or names, not both. The markers come in the order of the names, or of the
    selection's `chosen`. The marker set keeps what names them only: a pair or an edge of which
    one end is left out goes as a whole.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps.
    selection
        Whose chosen markers are kept.
    names
        Names of the markers that are kept, unless a selection is given.

    Returns
    -------
    Trajectories
        Their samples as they were.

    Raises
    ------
    ValueError
        If there is neither a selection nor names, or both; if a name is listed twice, there is
        none, or the recording lacks it (the message says which is nearest).
    """
    if (selection is None) == (names is None):
        count = "neither" if selection is None else "both"
        raise ValueError(f"give either a selection or names of markers, got {count}")
    markers = list(selection.chosen if selection else names or ())
    if not markers:
        raise ValueError("no marker is chosen; a recording of none is of no use")
    return recording.keep(markers)
