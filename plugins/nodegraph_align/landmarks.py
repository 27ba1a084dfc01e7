"""The markers by which a face is aligned."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Annotated

from pydantic import AfterValidator
from pydantic_core import PydanticCustomError

from nodegraph import Refusal, listed
from nodegraph_mocap import check_markers

if TYPE_CHECKING:
    from nodegraph_mocap import Trajectories

FEWEST = 3
EVERY = ("*",)
"""Stands for all markers that the recording and the reference both have."""

_RULE = f"{FEWEST} or more, or {EVERY[0]} alone"


def _are_enough(names: Sequence[str]) -> bool:
    return len(names) >= FEWEST or tuple(names) == EVERY


def _as_pydantic_says_it(names: tuple[str, ...]) -> tuple[str, ...]:
    if not _are_enough(names):
        raise PydanticCustomError("landmarks", f"Input must be {_RULE}")
    return names


Landmarks = Annotated[tuple[str, ...], AfterValidator(_as_pydantic_says_it)]


def landmarks_of(
    recording: Trajectories, reference: Trajectories | None, names: Sequence[str] | None
) -> tuple[tuple[str, ...], list[str]]:
    """Return the landmarks, which recording and reference both have, and notes for the user.

    Parameters
    ----------
    recording, reference
        Whose markers, and whose marker sets' stable ones where no names are given: those of the
        recording's marker set, or of the reference's if that says nothing.
    names
        Names that the user chose, or None; ``*`` alone is all markers that both have.

    Raises
    ------
    ValueError
        If a chosen name is unknown or listed twice, fewer than three are chosen, or none are and
        no marker set says which markers are stable.
    Refusal
        If recording and reference share fewer than three stable markers.
    """
    both = (recording,) if reference is None else (recording, reference)
    if names is not None and not _are_enough(names):
        raise ValueError(f"landmarks: must be {_RULE}, got {listed(names)}")
    if names is not None and tuple(names) == EVERY:
        return tuple(name for name in recording.markers if name in set(both[-1].markers)), []
    if names is not None:
        check_markers(recording, names, what="landmarks: the recording")
        check_markers(both[-1], names, what="landmarks: the reference")
        return tuple(names), []
    stable = _stable(both)
    shared = [name for name in stable if all(name in recording.markers for recording in both)]
    if len(shared) < FEWEST:
        raise Refusal(
            f"needs {FEWEST} stable markers that the recording and the reference have: of "
            f"{listed(stable)} they have {listed(shared)}"
        )
    absent = [name for name in stable if name not in shared]
    return tuple(shared), (
        [f"{len(absent)} stable markers are not landmarks, as not all have them: {listed(absent)}"]
        if absent
        else []
    )


def _stable(recordings: Iterable[Trajectories]) -> tuple[str, ...]:
    for recording in recordings:
        if recording.marker_set and recording.marker_set.stable:
            return recording.marker_set.stable
    raise ValueError(
        "no marker set says which markers are stable: give `landmarks`, markers that speech and "
        "expression hardly move, such as the bridge of the nose, the temples, the forehead"
    )
