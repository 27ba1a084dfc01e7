"""Which markers a face is aligned by."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from nodegraph import Refusal

if TYPE_CHECKING:
    from nodegraph_mocap import Trajectories

FEWEST = 3
EVERY = ("*",)
"""What a user gives for all markers that recording and reference have."""

_LISTED = 10


def landmarks_of(
    recording: Trajectories, reference: Trajectories | None, names: Sequence[str] | None
) -> tuple[tuple[str, ...], list[str]]:
    """Return the landmarks, which recording and reference both have, and what to tell the user.

    Parameters
    ----------
    recording, reference
        Whose markers, and whose marker sets' stable ones where no names are given: those of the
        recording's marker set, or of the reference's if that says nothing.
    names
        What the user chose, or None; ``*`` alone is all markers that both have.

    Raises
    ------
    ValueError
        If a chosen name is unknown or listed twice, fewer than three are chosen, or none are and
        no marker set says which markers are stable.
    Refusal
        If recording and reference share fewer than three stable markers.
    """
    both = (recording,) if reference is None else (recording, reference)
    if names is not None and tuple(names) == EVERY:
        return tuple(name for name in recording.markers if name in set(both[-1].markers)), []
    if names is not None:
        _check(names, recording, "recording")
        _check(names, both[-1], "reference")
        return tuple(names), []
    stable = _stable(both)
    shared = [name for name in stable if all(name in one.markers for one in both)]
    if len(shared) < FEWEST:
        raise Refusal(
            f"needs {FEWEST} stable markers that the recording and the reference have: of "
            f"{listed(stable)} they have {listed(shared)}"
        )
    absent = [name for name in stable if name not in shared]
    return tuple(shared), (
        [f"{len(absent)} stable markers are no landmarks, as not all have them: {listed(absent)}"]
        if absent
        else []
    )


def listed(names: Iterable[str]) -> str:
    """Return the first ten names, and how many more there are."""
    every = list(names)
    more = f", and {len(every) - _LISTED} more" if len(every) > _LISTED else ""
    return (", ".join(every[:_LISTED]) or "none") + more


def _stable(recordings: Iterable[Trajectories]) -> tuple[str, ...]:
    for one in recordings:
        if one.marker_set and one.marker_set.stable:
            return one.marker_set.stable
    raise ValueError(
        "no marker set says which markers are stable: give `landmarks`, markers that speech and "
        "expression hardly move, such as the bridge of the nose, the temples, the forehead"
    )


def _check(names: Sequence[str], recording: Trajectories, what: str) -> None:
    repeated = sorted({name for name in names if list(names).count(name) > 1})
    if repeated:
        raise ValueError(f"landmarks: listed twice: {listed(repeated)}")
    if len(names) < FEWEST:
        raise ValueError(f"landmarks: must be {FEWEST} or more, got {listed(names)}")
    unknown = [name for name in names if name not in recording.markers]
    if unknown:
        told = "; ".join(_told(name, recording.markers) for name in unknown)
        raise ValueError(
            f"landmarks: the {what} has no marker {told}; it has {listed(recording.markers)}"
        )


def _told(name: str, markers: Sequence[str]) -> str:
    lower = {marker.lower(): marker for marker in markers}
    close = difflib.get_close_matches(name.lower(), lower, n=1, cutoff=0.6)
    return f"{name!r} (did you mean {lower[close[0]]!r}?)" if close else repr(name)
