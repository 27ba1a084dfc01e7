"""Procrustes alignment in which a landmark counts the less the farther it is off (Huber)."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from nodegraph import Unit, node
from nodegraph_align.faces import Faces
from nodegraph_align.fitting import Fitting
from nodegraph_align.poses import Aligned, Transforms, warn
from nodegraph_align.reference import reference_of

_ROUNDS = 200
_TOLERANCE = 1e-9
"""Change of weights from one round to the next, below which a frame is done."""


@node("align.huber", cite=("huber1964", "verboon_heiser1992"), lookahead=0, shares=Faces)
def huber(
    faces: Faces,
    *,
    width: Annotated[float, Field(gt=0), Unit("mm")] = 1.0,
) -> Aligned:
    """Align each frame to a reference, with a bound on what a single landmark does (Huber).

    Landmarks that are called stable do move. Each frame's pose minimizes ``sum(rho(r_i))``, r_i
    the distance of landmark i from its place in the reference: ``rho(r) = r^2 / 2`` up to
    `width`, ``width (r - width / 2)`` beyond. It is found by fits as in align.procrustes with
    weights ``min(1, width / r_i)`` of the fit before, from equal ones on, until no weight changes
    by 1e-9; frames that have not come to rest after 200 fits are counted in a warning. A landmark
    that is very far off is still pulled by as if it were `width` off: align.trimmed leaves it
    out altogether.

    Missing landmarks, the reference and what is refused are as in align.procrustes. Looks ahead
    no frame.

    Parameters
    ----------
    width
        How far from its place a landmark still counts fully.
    """
    if not width > 0:
        raise ValueError(f"width must be positive, got {width}")
    recording = faces.recording
    target, notes = reference_of(recording, faces.reference, faces.landmarks)
    poses, restless = _settled(Fitting.of(recording, target, faces.scale), width)
    if restless:
        notes.append(f"{restless} of {recording.frames} frames have not come to rest")
    warn(poses, recording, target, notes, stacklevel=4)
    return Aligned(*poses.move(recording), target.frame)


def _settled(fitting: Fitting, width: float) -> tuple[Transforms, int]:
    """Return the poses, and how many of them still change."""
    weights = fitting.there.astype(np.float64)
    poses = fitting.fit()
    active = np.flatnonzero(poses.known)
    for _ in range(_ROUNDS):
        apart = fitting.some(active).distances(poses.some(active))
        wanted = width / np.maximum(apart, width)
        changed = np.any(np.abs(wanted - weights[active]) > _TOLERANCE, axis=1)
        active = active[changed]
        if not len(active):
            break
        weights[active] = wanted[changed]
        poses.put(active, fitting.some(active).fit(weights[active]))
        active = active[poses.known[active]]
    return poses, len(active)
