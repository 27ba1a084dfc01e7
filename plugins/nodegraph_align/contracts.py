"""Contracts of every alignment, third-party ones included."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import HeadMotion, Trajectories, contracts

if TYPE_CHECKING:
    from numpy.typing import NDArray


def gives_the_face_its_motion_and_the_reference(tried: Tried) -> Iterator[str]:
    """Give aligned, head_motion and reference, a recording of one frame."""
    outputs, names = tried.outputs, ("aligned", "head_motion", "reference")
    types = (Trajectories, HeadMotion, Trajectories)
    if tuple(outputs) != names:
        yield f"its outputs are {', '.join(outputs)}; let it return {', '.join(names)}"
        return
    for name, kind in zip(names, types, strict=True):
        if not isinstance(outputs[name], kind):
            yield f"{name} is a {type(outputs[name]).__name__}, not a {kind.__name__}"
    reference = outputs["reference"]
    if isinstance(reference, Trajectories) and reference.frames != 1:
        yield f"reference has {reference.frames} frames: give the one that was aligned to"


def keeps_gaps_and_origin(tried: Tried) -> Iterator[str]:
    """Leave missing samples missing, present ones present, and every sample's origin."""
    for before, after in contracts.before_and_after(tried):
        changed = before.origin != after.origin
        if changed.any():
            yield (
                f"{contracts.places(before, changed)} with another origin: return "
                "dataclasses.replace(recording, positions=aligned)"
            )


def head_motion_leads_back(tried: Tried) -> Iterator[str]:
    """Move each frame as a whole, such that head_motion leads back: captured = s R aligned + t."""
    motion = tried.outputs.get("head_motion")
    for before, after in contracts.before_and_after(tried):
        if not isinstance(motion, HeadMotion) or motion.frames != before.frames:
            continue
        scales = motion.scales[:, None]
        turned = after.positions @ motion.rotations.transpose(0, 2, 1)
        back = scales[..., None] * turned + motion.translations[:, None]
        yield from contracts.differences(before, after, back)
        sigma = np.nan if after.sigma is None else after.sigma * scales
        if before.sigma is not None and not np.allclose(sigma, before.sigma, equal_nan=True):
            yield "sigma is not that of the samples: scale it as the positions are"


def what_is_aligned_stays(tried: Tried) -> Iterator[str]:
    """Leave a recording as it is that is aligned already."""
    for _, aligned in contracts.before_and_after(tried):
        again = contracts.output_again(tried, aligned)
        if again is None:
            yield "declines the recording that it has aligned"
        else:
            yield from contracts.differences(aligned, again, again.positions)


def where_the_head_is_does_not_matter(tried: Tried) -> Iterator[str]:
    """Give the same face wherever the head is; without a reference, turned as the take is."""
    for before, after in contracts.before_and_after(tried):
        alone = tried.inputs.get("reference") is None
        turns = np.stack([contracts.TURN, contracts.TURN if alone else contracts.SWAP])
        turns = turns[np.arange(before.frames) % 2]
        moved = replace(before, positions=before.positions @ turns + contracts.SHIFT)
        again = contracts.output_again(tried, moved)
        if again is None:
            yield "declines the recording of a head elsewhere"
        else:
            expected = after.positions @ turns if alone else after.positions
            yield from _apart(after, again.positions - expected, _moved(tried, after), alone=alone)


CONTRACTS = (
    contracts.takes_and_gives_a_recording,
    gives_the_face_its_motion_and_the_reference,
    keeps_gaps_and_origin,
    head_motion_leads_back,
    what_is_aligned_stays,
    where_the_head_is_does_not_matter,
    contracts.does_not_depend_on_the_order_of_markers,
)


def _moved(tried: Tried, recording: Trajectories) -> NDArray[np.bool_]:
    """Return in which frames, (T,), a head motion was found; in none if nothing was turned."""
    motion = tried.outputs.get("head_motion")
    if not isinstance(motion, HeadMotion) or motion.frames != recording.frames:
        return np.zeros(recording.frames, dtype=np.bool_)
    turned = np.any(motion.rotations != np.eye(3), axis=(1, 2))
    return np.asarray(turned.any() & (turned | np.any(motion.translations != 0.0, axis=1)))


def _apart(
    recording: Trajectories,
    differences: NDArray[np.float64],
    which: NDArray[np.bool_],
    *,
    alone: bool,
) -> Iterator[str]:
    """Yield in which frames results differ; a shift of the whole take is none without reference."""
    known = recording.present & which[:, None]
    if not known.any():
        return
    shift = differences[known].mean(axis=0) if alone else 0.0
    apart = np.where(known, np.linalg.norm(differences - shift, axis=2), 0.0)
    if np.any(apart > contracts.TOLERANCE):
        samples = contracts.places(recording, apart > contracts.TOLERANCE)
        yield f"{samples} differ, by up to {apart.max():.3g} mm"
