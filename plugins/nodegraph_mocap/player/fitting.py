"""What fits into a playback: how many frames, how many vertices, how far away."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from nodegraph import Refusal
from nodegraph_mocap.animation import Animation
from nodegraph_mocap.face_model import Weights
from nodegraph_mocap.head import Head
from nodegraph_mocap.playback import Panel
from nodegraph_mocap.player.data import MOST_STEPS, beyond, step_of
from nodegraph_mocap.recording import Trajectories

MOST_SAMPLES = 2_000_000
"""Frames times markers or morph targets, over all panels; about 10 MB of a report at worst."""

MOST_VERTICES = 1_000_000
"""Vertices of all heads that differ, each morph target's counted."""


def thinning_notes(every: int) -> Iterator[str]:
    """Yield what is left out where not every frame is played."""
    if every > 1:
        yield (
            f"so much cannot be played in full: of {every} frames one is shown, and {every - 1} "
            "are left out, here and in no other result"
        )


def frames_apart(shown: Iterable[Trajectories | Animation | Weights]) -> int:
    """Return n such that every n-th frame is played: 1 where all fit."""
    samples = sum(motion.frames * _across(motion) for motion in shown)
    return max(1, -(-samples // MOST_SAMPLES))


def thinned(shown: Trajectories | Animation, every: int) -> Trajectories | Animation:
    """Return every n-th frame of a recording or an animation, the first included."""
    if every == 1:
        return shown
    if isinstance(shown, Animation):
        motion = shown.head_motion
        return replace(
            shown,
            weights=thinned_weights(shown.weights, every),
            head_motion=motion and motion[::every],
        )
    return replace(shown[::every], rate=shown.rate / every)


def thinned_weights(weights: Weights, every: int) -> Weights:
    """Return every n-th frame of weights, the first included."""
    return replace(weights, values=weights.values[::every], rate=weights.rate / every)


def check_meshes(shown: Iterable[tuple[str, Trajectories | Animation]]) -> None:
    """Refuse heads without triangles, and more of them than a page can hold.

    Raises
    ------
    Refusal
    """
    heads: dict[int, Head] = {}
    for label, motion in shown:
        if not isinstance(motion, Animation):
            continue
        heads[id(motion.head)] = motion.head
        if not len(motion.head.faces):
            raise Refusal(f"the head of {label or 'the animation'} has no triangles to draw")
    vertices = sum(len(head.vertices) * (1 + len(head.names)) for head in heads.values())
    if vertices > MOST_VERTICES:
        raise Refusal(
            f"the heads have {vertices:,} vertices with those of their morph targets; "
            f"a playback holds {MOST_VERTICES:,}: play a coarser mesh"
        )


def out_of_reach(panels: Iterable[Panel]) -> Iterator[str]:
    """Yield notes on samples that are too far away to be played, by recording."""
    panels = list(panels)
    step = step_of(panels)
    for panel in panels:
        if isinstance(panel.shown, Trajectories):
            count = np.count_nonzero(beyond(panel.shown, step))
            if count:
                yield (
                    f"{panel.label or 'the recording'}: {count} samples lie more than "
                    f"{MOST_STEPS * step / 1000:,.0f} m away and are not shown"
                )


def _across(shown: Trajectories | Animation | Weights) -> int:
    """Return the number of values of a frame, a marker counted as one."""
    if isinstance(shown, Weights):
        return len(shown.names)
    if isinstance(shown, Animation):
        return len(shown.head.names) + 4 * (shown.head_motion is not None)
    return len(shown.markers)
