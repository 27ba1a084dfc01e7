"""The places of a face's markers, seen from the front, and the region of each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.view import AUTO, frontal

if TYPE_CHECKING:
    from collections.abc import Mapping

REGIONS = (
    *("forehead", "brow", "eyelid", "eye", "temple", "nose", "cheek"),
    *("mouth", "lip", "jaw", "chin"),
)
"""Words in the names of markers, of which the first counts: an eyebrow is not an eye."""


def layout(inputs: Mapping[str, object], column: str) -> dict[str, Any] | None:
    """Return the positions of the markers that a column of a score names.

    Parameters
    ----------
    inputs
        The inputs of the score, by port. A marker lies at the median of its positions in the second
        recording, the truth, or in the estimate where there is no other.
    column
        ``marker``; others lie nowhere.

    Returns
    -------
    dict or None
        ``names``; ``points``, x to the right and y up in millimetres; ``edges``, pairs of places
        in `names`; ``regions``, places by name; and ``title``. Markers that are never present
        are left out. None without any.
    """
    recordings = [value for value in inputs.values() if isinstance(value, Trajectories)]
    if column != "marker" or not recordings:
        return None
    base = recordings[min(1, len(recordings) - 1)]
    base = base.keep(base.markers[column] for column in np.flatnonzero(base.present.any(axis=0)))
    if not base.markers:
        return None
    points = frontal(base, AUTO).project(np.nanmedian(base.positions, axis=0))
    return {
        "title": "on the face",
        "names": list(base.markers),
        "points": np.round(points, 2).tolist(),
        "edges": edges_of(base),
        "regions": regions(base.markers),
    }


def edges_of(recording: Trajectories) -> list[list[int]]:
    """Return the edges of a recording's marker set as pairs of columns."""
    place = {marker: column for column, marker in enumerate(recording.markers)}
    edges = recording.marker_set.edges if recording.marker_set else ()
    return [[place[a], place[b]] for a, b in edges if a in place and b in place]


def regions(markers: tuple[str, ...]) -> dict[str, list[int]]:
    """Return the columns of the markers of each region that names speak of, from the top."""
    named: dict[str, list[int]] = {region: [] for region in REGIONS}
    for column, marker in enumerate(markers):
        region = next((region for region in REGIONS if region in marker.lower()), None)
        if region:
            named[region].append(column)
    return {region: columns for region, columns in named.items() if columns}
