"""A recording in a notebook: its size, where its samples come from, and a strip per marker."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.recording import Origin
from nodegraph_mocap.runs import runs_of
from nodegraph_tables.style import BLUE, GREY, ORANGE, VERMILLION

if TYPE_CHECKING:
    from nodegraph_mocap.recording import Trajectories

_COLOURS = (
    (Origin.MEASURED, "measured", BLUE),
    (Origin.FILLED, "filled", VERMILLION),
    (Origin.REPAIRED, "repaired", ORANGE),
    (Origin.MISSING, "missing", GREY),
)
_WIDTH = 800
_HIGHEST = 480


def recording_html(recording: Trajectories) -> str:
    """Return a fragment of HTML that needs nothing else; names are escaped."""
    facts = (
        f"{recording.frames} frames, {len(recording.markers)} markers, {recording.rate:g} Hz, "
        f"{recording.frames / recording.rate:.3g} s"
    )
    counts = "; ".join(
        f'<span style="color:{colour}">\N{BLACK SQUARE}</span> {_share(recording, origin)} {name}'
        for origin, name, colour in _COLOURS
    )
    return f"<div><p><b>Trajectories</b>: {facts}</p><p>{counts}</p>{_strips(recording)}</div>"


def _share(recording: Trajectories, origin: Origin) -> str:
    count = int(np.count_nonzero(recording.origin == origin))
    share = count / max(recording.origin.size, 1)
    samples = "sample" if count == 1 else "samples"
    return f"{count} {samples} ({share:.1%})" if count else "no samples"


def _strips(recording: Trajectories) -> str:
    """Return a picture: a row per marker, time to the right, missing samples left white."""
    if not recording.origin.size:
        return ""
    markers = len(recording.markers)
    height = min(8 * markers, _HIGHEST)
    rows = "".join(
        f'<g><title>{escape(name)}</title><rect x="0" y="{row}" width="{recording.frames}" '
        f'height="1" fill="transparent"/></g>'
        for row, name in enumerate(recording.markers)
    )
    paths = "".join(
        f'<path fill="{colour}" d="{_path(recording, origin)}"/>'
        for origin, _, colour in _COLOURS
        if origin is not Origin.MISSING
    )
    return (
        f'<svg role="img" aria-label="Where samples come from, a row per marker" '
        f'width="{_WIDTH}" height="{height}" style="max-width:100%" preserveAspectRatio="none" '
        f'viewBox="0 0 {recording.frames} {markers}" shape-rendering="crispEdges">'
        f"{paths}{rows}</svg>"
    )


def _path(recording: Trajectories, origin: Origin) -> str:
    runs = runs_of(np.asarray(recording.origin == origin))
    return "".join(
        f"M{start} {marker}.1h{stop - start}v.8h{start - stop}z"
        for marker, start, stop in zip(*(one.tolist() for one in runs), strict=True)
    )
