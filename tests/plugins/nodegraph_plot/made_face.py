"""A small face with a gap, for the tests of both figures."""

from __future__ import annotations

import numpy as np

from nodegraph_mocap import MarkerSet, Origin, Trajectories

POINTS = {
    "nose": (0, 0, 30),
    "forehead": (2, 60, 5),
    "chin": (-1, -60, 8),
    "brow_l": (30, 30, 8),
    "brow_r": (-30, 30, 8),
    "cheek_l": (50, -5, -15),
    "cheek_r": (-50, -5, -15),
    "mouth_l": (22, -32, 14),
    "mouth_r": (-22, -32, 14),
}
MARKERS = tuple(POINTS)
SET = MarkerSet(
    markers=MARKERS,
    pairs=tuple((f"{name}_l", f"{name}_r") for name in ("brow", "cheek", "mouth")),
    midline=("nose", "forehead", "chin"),
    edges=(("nose", "chin"), ("mouth_l", "mouth_r"), ("mouth_l", "chin")),
)
FRAMES = 40
GAP = slice(15, 21)
GAP_MARKER = MARKERS.index("mouth_l")


def truth(*, marker_set: MarkerSet | None = SET) -> Trajectories:
    wave = np.sin(np.arange(FRAMES) / 5)[:, np.newaxis, np.newaxis]
    sway = np.linspace(0.5, 2, 3 * len(MARKERS)).reshape(len(MARKERS), 3)
    positions = np.array(list(POINTS.values()), dtype=float) + wave * sway
    return Trajectories(positions=positions, markers=MARKERS, rate=60.0, marker_set=marker_set)


def gappy() -> Trajectories:
    whole = truth()
    positions = whole.positions.copy()
    positions[GAP, GAP_MARKER] = np.nan
    return Trajectories(positions=positions, markers=MARKERS, rate=60.0, marker_set=SET)


def filled(offset: float) -> Trajectories:
    """Return the recording with its gap filled by the truth moved along all axes."""
    holed = gappy()
    changed = ~holed.present
    positions = np.where(changed[..., np.newaxis], truth().positions + offset, holed.positions)
    return holed.with_samples(positions, changed=changed, origin=Origin.FILLED)
