"""Other names for markers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from nodegraph import node
from nodegraph_mocap import MarkerSet, Trajectories, check_markers


@node("markers.rename", requires=lambda recording, names: check_markers(recording, names))
def rename(recording: Trajectories, *, names: dict[str, str]) -> Trajectories:
    """Give markers other names, in the recording and in its marker set alike.

    All names change at once, so that two markers may swap theirs.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps.
    names
        New name by old name: ``{LBRM: brow_left, RBRM: brow_right}``. Markers that are not
        mentioned keep theirs.

    Returns
    -------
    Trajectories
        The same samples in the same order.

    Raises
    ------
    ValueError
        If the recording lacks an old name (the message says which is nearest), a new name is
        empty, or two markers would have one name (the message says which two).
    """
    check_markers(recording, names)
    empty = [old for old, new in names.items() if not new.strip()]
    if empty:
        raise ValueError(f"the new name of {', '.join(empty)} is empty")
    marker_set = recording.marker_set
    return replace(
        recording,
        markers=_renamed(recording.markers, names, "recording"),
        marker_set=marker_set and renamed_set(marker_set, names),
    )


def _renamed(markers: Iterable[str], names: Mapping[str, str], where: str) -> tuple[str, ...]:
    old_by_new: dict[str, str] = {}
    for old in markers:
        new = names.get(old, old)
        if new in old_by_new:
            first = old_by_new[new]
            raise ValueError(f"{where}: {first!r} and {old!r} would both be called {new!r}")
        old_by_new[new] = old
    return tuple(old_by_new)


def renamed_set(marker_set: MarkerSet, names: Mapping[str, str]) -> MarkerSet:
    """Return the marker set with new names by old name."""

    def also(part: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(names.get(name, name) for name in part)

    return MarkerSet(
        markers=_renamed(marker_set.markers, names, "marker set"),
        pairs=tuple(
            (names.get(left, left), names.get(right, right)) for left, right in marker_set.pairs
        ),
        midline=also(marker_set.midline),
        stable=also(marker_set.stable),
        edges=tuple(
            (names.get(first, first), names.get(second, second))
            for first, second in marker_set.edges
        ),
    )
