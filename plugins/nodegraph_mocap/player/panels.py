"""From where a panel of a player is seen: all that it shows fits into the picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.animation import Animation
from nodegraph_mocap.playback import Panel
from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.view import frontal

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap.view import Projection

_OUTER = 0.1
"""Percent of the samples on each side that may lie outside: impulses must not shrink a face."""

_ROOM = 1.12
_FRAMES = 60
_POINTS = 20_000
"""Of those of a recording, evenly spaced, that say where it lies."""


def panel_of(label: str, shown: Trajectories | Animation, view: str) -> Panel:
    """Return the panel of a recording or an animation, seen from the front or as requested."""
    if isinstance(shown, Animation):
        seen = frontal(_markers_of(shown), view)
        points = posed(shown, shown.head.vertices).reshape(-1, 3)
    else:
        seen = frontal(shown, view)
        chosen = shown.measured if shown.measured.any() else shown.present
        points = shown.positions[chosen]
        points = points[:: len(points) // _POINTS + 1]
    centre, radius = _fit(points, seen)
    return Panel(
        label=label, shown=shown, centre=centre, right=seen.right, up=seen.up, radius=radius
    )


def posed(animation: Animation, vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (P, V, 3) where (V, 3) vertices at rest are in some frames of an animation.

    Of at most sixty frames, evenly spaced.
    """
    motion = animation.head_motion
    if motion is None:
        return vertices[np.newaxis]
    count = min(_FRAMES, animation.frames)
    frames = np.linspace(0, animation.frames - 1, count).round().astype(np.intp)
    turned = vertices @ motion.rotations[frames].transpose(0, 2, 1)
    moved = motion.translations[frames, np.newaxis]
    return np.asarray(motion.scales[frames, np.newaxis, np.newaxis] * turned + moved)


def _markers_of(animation: Animation) -> Trajectories:
    head = animation.head
    return Trajectories(
        positions=posed(animation, head.vertices[head.marker_vertices]),
        markers=head.markers,
        rate=animation.rate,
    )


def _fit(points: NDArray[np.float64], seen: Projection) -> tuple[NDArray[np.float64], float]:
    """Return the middle of all points, and the distance from it to the picture's edge."""
    if not len(points):
        return seen.centre, 1.0
    axes = np.stack([seen.right, seen.up, np.cross(seen.right, seen.up)])
    low, high = np.percentile(points @ axes.T, [_OUTER, 100 - _OUTER], axis=0)
    radius = _ROOM * float((high - low)[:2].max()) / 2
    return (low + high) / 2 @ axes, radius if radius > 0 else 1.0
