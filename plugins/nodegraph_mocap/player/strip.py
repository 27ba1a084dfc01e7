"""Where samples of a recording are missing, made or look like impulses, over its time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.playback import Strip
from nodegraph_mocap.recording import Origin, Trajectories
from nodegraph_mocap.suspect import impulses

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_STRETCHES = 1500
"""Into which a recording is divided; a longer one has several frames in each."""

MOST_IMPULSES = 3000


def strip_of(recording: Trajectories) -> Strip:
    """Return the strip of a recording; of more impulses than a page holds, the largest."""
    sizes = impulses(recording.positions)
    frames, markers = np.nonzero(sizes)
    largest = np.sort(np.argsort(-sizes[frames, markers], kind="stable")[:MOST_IMPULSES])
    missing, filled, repaired = (
        _shares(recording.origin == origin)
        for origin in (Origin.MISSING, Origin.FILLED, Origin.REPAIRED)
    )
    return Strip(
        missing=missing,
        filled=filled,
        repaired=repaired,
        impulse_markers=markers[largest],
        impulse_seconds=frames[largest] / recording.rate,
        left_out=len(frames) - len(largest),
    )


def _shares(flags: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Return (stretches, M) shares of 255: 0 only where nothing is flagged."""
    frames = len(flags)
    stretches = min(frames, MOST_STRETCHES)
    edges = np.arange(stretches + 1) * frames // max(stretches, 1)
    counts = np.add.reduceat(flags, edges[:-1], axis=0, dtype=np.int64)
    return np.ceil(255 * counts / np.diff(edges)[:, np.newaxis]).astype(np.uint8)
