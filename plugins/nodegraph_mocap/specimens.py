"""Small values of every type, ordinary and odd, on which the tests of nodes try them.

Values of one name belong together: the mask of a name hides samples that the recording of that
name has, the model of a name has its markers.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph_mocap.animation import Animation
from nodegraph_mocap.detections import Detections
from nodegraph_mocap.face_model import BlendshapeModel, HeadMotion, Weights
from nodegraph_mocap.head import Head
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.marks import Mark, Marks
from nodegraph_mocap.recording import Mask, Origin, Trajectories
from nodegraph_mocap.selection import Selection

if TYPE_CHECKING:
    from numpy.typing import NDArray

FRAMES, RATE = 40, 60.0
MARKERS = (
    "brow_left", "brow_right", "cheek_left", "cheek_right", "lip_left", "lip_right",
    "nose", "forehead", "temple_left", "temple_right",
)  # fmt: skip
SHAPES = ("jawOpen", "mouthSmileLeft", "mouthSmileRight")
_AT_REST = np.array([
    [-31.0, 42.0, 80.0], [32.5, 41.0, 79.0], [-44.0, -3.0, 62.0], [43.0, -2.0, 63.5],
    [-22.0, -41.0, 84.0], [23.5, -42.5, 83.0], [1.0, 3.5, 104.0], [-1.5, 71.0, 72.0],
    [-66.0, 31.0, 21.0], [67.0, 29.5, 22.5],
])  # fmt: skip


def recordings() -> dict[str, Trajectories]:
    """Return recordings of a face that hardly anything is wrong with, and odd ones."""
    face = _face()
    positions = face.positions
    nowhere = np.full_like(positions, np.nan)
    together = positions.copy()
    together[:, 1] = together[:, 0]
    return {
        "complete": face,
        "gaps": _cut(face, [(0, 0, 3), (6, 5, 9), (2, 20, 28), (4, 36, FRAMES)]),
        "several markers missing at once": _cut(
            face, [(0, 10, 18), (2, 8, 20), (4, 12, 15), (5, 12, 30)]
        ),
        "a marker never seen": _cut(face, [(3, 0, FRAMES), (6, 12, 18)]),
        "a frame without any marker": _cut(face, [(m, 15, 17) for m in range(len(MARKERS))]),
        "one frame": _cut(face[:1], [(2, 0, 1)]),
        "two frames": _cut(face[:2], [(2, 1, 2)]),
        "one marker": _cut(face, [(6, 10, 14)]).keep(["nose"]),
        "all missing": _without_marker_set(nowhere),
        "two markers in one place": _cut(_without_marker_set(together), [(0, 10, 14), (6, 20, 24)]),
        "another memory order": _cut(
            _without_marker_set(np.asfortranarray(positions)), [(4, 10, 16)]
        ),
        "made from float32": _without_marker_set(positions.astype(np.float32)[::2]),
        "filled, repaired and with sigma": _partly_processed(face),
    }


def masks() -> dict[str, Mask]:
    """Return a mask for each recording; it hides every fifth present sample of each marker."""
    specimens = {}
    for name, recording in recordings().items():
        frame = np.arange(recording.frames)[:, None]
        hidden = recording.present & ((frame + np.arange(len(recording.markers))) % 5 == 1)
        specimens[name] = Mask(hidden=hidden, markers=recording.markers)
    return specimens


def marks() -> dict[str, Marks]:
    """Return marks of each kind, of a face with all its markers, and none of any."""
    every = (
        Mark(marker="nose", start=5, frames=4),
        Mark(marker="brow_left", start=2, frames=30, kind="swapped", other="brow_right"),
        Mark(marker="cheek_left", start=0, frames=20, kind="named", other="jaw"),
        Mark(marker="forehead", start=0, frames=FRAMES, kind="named", other="hairline"),
    )
    odd = {name: Marks() for name in recordings()}
    return odd | {"complete": Marks(marks=every), "gaps": Marks(marks=every)}


def marker_sets() -> dict[str, MarkerSet]:
    """Return the face's marker set, and one that says nothing."""
    return {"complete": _marker_set(), "one marker": MarkerSet(markers=("nose",))}


def selections() -> dict[str, Selection]:
    """Return some of the face's markers with all numbers of a search, and one marker alone."""
    marker_set = _marker_set()
    pairs = (*marker_set.pairs, *((name,) for name in marker_set.midline))
    selection = Selection(
        chosen=(*marker_set.pairs[2], *marker_set.pairs[0], "nose"),
        pairs=pairs,
        frequencies=np.array([0.9, 0.25, 1.0, 0.0, 0.75, 0.5]),
        columns=("k", "markers", "stability"),
        history=np.array([[5.0, 5.0, 2.65], [10.0, 8.0, np.nan]]),
    )
    return {"complete": selection, "one marker": Selection(chosen=("nose",))}


def detections() -> dict[str, Detections]:
    """Return the present samples of each recording without their names."""
    specimens = {}
    for name, recording in recordings().items():
        counts = recording.present.sum(axis=1)
        specimens[name] = Detections(
            points=recording.positions[recording.present],
            offsets=np.concatenate([[0], np.cumsum(counts)]),
            rate=recording.rate,
        )
    return specimens


def models() -> dict[str, BlendshapeModel]:
    """Return one model."""
    return {"complete": _model()}


def head_motions() -> dict[str, HeadMotion]:
    """Return a head that keeps still, as long as each recording."""
    return {name: HeadMotion.still(each.frames) for name, each in recordings().items()}


def heads() -> dict[str, Head]:
    """Return the face's head, and what is left of it without its markers or morph targets."""
    head = _head()
    return {
        "complete": head,
        "a head without markers": replace(
            head, markers=(), marker_vertices=np.zeros(0, dtype=np.int64)
        ),
        "a head without morph targets": replace(head, names=(), morphs=head.morphs[:0]),
    }


def weights() -> dict[str, Weights]:
    """Return weights of the face's shapes: complete, a single frame, and with some missing."""
    complete = _weights(FRAMES)
    gappy = complete.values.copy()
    gappy[:3, 0] = gappy[10:14, 1] = np.nan
    return {
        "complete": complete,
        "one frame": _weights(1),
        "gaps": replace(complete, values=gappy),
        "weights of another program": replace(
            complete, names=("MouthSmile_R", "JawOpen", "TongueOut")
        ),
        "weights without sides": replace(
            complete, values=complete.values[:, :2], names=("jawOpen", "mouthSmile")
        ),
    }


def animations() -> dict[str, Animation]:
    """Return the head with its weights, and with head motion but where some are missing."""
    head, driven, still = _head(), weights(), HeadMotion.still
    return {
        "complete": Animation(head=head, weights=driven["complete"], head_motion=still(FRAMES)),
        "one frame": Animation(head=head, weights=driven["one frame"], head_motion=still(1)),
        "gaps": Animation(head=head, weights=driven["gaps"]),
    }


def _face() -> Trajectories:
    """Return a recording in which every marker moves smoothly and in its own way."""
    rng = np.random.default_rng(20)
    seconds = np.arange(FRAMES)[:, None, None] / RATE
    markers = len(MARKERS)
    speed = rng.uniform(0.5, 2.0, (3, 1, 3)) + rng.uniform(0.0, 0.05, (3, markers, 3))
    reach = rng.uniform(0.5, 2.0, (3, markers, 3))
    waves = reach[:, None] * np.sin(2 * np.pi * speed[:, None] * seconds + rng.uniform(0, 6, 3))
    return Trajectories(
        positions=_AT_REST + waves.sum(axis=0),
        markers=MARKERS,
        rate=RATE,
        marker_set=_marker_set(),
    )


def _marker_set() -> MarkerSet:
    sides = ("brow", "cheek", "lip", "temple")
    return MarkerSet(
        markers=MARKERS,
        pairs=tuple((f"{name}_left", f"{name}_right") for name in sides),
        midline=("nose", "forehead"),
        stable=("temple_left", "temple_right", "nose", "forehead"),
        edges=(("brow_left", "forehead"), ("forehead", "brow_right"), ("lip_left", "lip_right")),
    )


def _cut(recording: Trajectories, gaps: list[tuple[int, int, int]]) -> Trajectories:
    """Return the recording with gaps of (marker, first frame, frame after the last)."""
    positions, hidden = recording.positions.copy(order="K"), np.zeros(recording.origin.shape, bool)
    for marker, start, stop in gaps:
        hidden[start:stop, marker] = True
    positions[hidden] = np.nan
    return recording.with_samples(positions, changed=hidden, origin=Origin.MISSING)


def _without_marker_set(positions: NDArray[Any]) -> Trajectories:
    return Trajectories(positions=positions, markers=MARKERS, rate=RATE)


def _partly_processed(face: Trajectories) -> Trajectories:
    gappy = _cut(face, [(6, 20, 25), (1, 3, 6)])
    origin = gappy.origin.copy()
    origin[10:14, 2] = Origin.FILLED
    origin[30, 5] = Origin.REPAIRED
    sigma = np.where(gappy.present, 0.1, np.nan)
    return replace(gappy, origin=origin, sigma=sigma)


def _model() -> BlendshapeModel:
    shapes = np.random.default_rng(3).normal(0.0, 4.0, (len(SHAPES), len(MARKERS), 3))
    return BlendshapeModel(neutral=_AT_REST, shapes=shapes, names=SHAPES, markers=MARKERS)


def _head() -> Head:
    model = _model()
    return Head(
        vertices=model.neutral,
        faces=np.array([[0, 7, 6], [7, 1, 6], [6, 4, 5], [2, 6, 4], [6, 3, 5]]),
        morphs=model.shapes,
        names=SHAPES,
        markers=MARKERS,
        marker_vertices=np.arange(len(MARKERS)),
    )


def _weights(frames: int) -> Weights:
    values = np.random.default_rng(4).uniform(0.0, 1.0, (frames, len(SHAPES)))
    return Weights(values=values, names=SHAPES, rate=RATE)
