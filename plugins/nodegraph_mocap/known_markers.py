"""Markers that a setting names and a recording must have."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from nodegraph import closest, listed

if TYPE_CHECKING:
    from nodegraph_mocap.recording import Trajectories


def check_markers(
    recording: Trajectories, names: Iterable[str], *, what: str = "the recording"
) -> None:
    """Refuse names that are no markers of a recording, or that stand twice.

    Parameters
    ----------
    recording
        Whose markers there are.
    names
        What is asked for.
    what
        What the message calls the recording.

    Raises
    ------
    ValueError
        With the names, for each the nearest marker if one is near, and all that there are.
    """
    asked = list(names)
    repeated = sorted({name for name in asked if asked.count(name) > 1})
    if repeated:
        raise ValueError(f"{what}: asked twice for {listed(repeated)}")
    known = set(recording.markers)
    unknown = [_told(name, recording.markers) for name in asked if name not in known]
    if unknown:
        raise ValueError(
            f"{what} has no marker {'; '.join(unknown)}; it has {listed(recording.markers)}"
        )


def _told(name: str, markers: Sequence[str]) -> str:
    near = closest(name, markers)
    return f"{name!r} (did you mean {near!r}?)" if near else repr(name)
