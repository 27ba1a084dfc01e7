"""An alignment that breaks a promise is caught."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from nodegraph_align.huber import huber
from nodegraph_align.poses import Aligned
from nodegraph_align.procrustes import procrustes
from nodegraph_align.trimmed import trimmed
from nodegraph_mocap import HeadMotion, Origin, Trajectories
from tests.promises import Family

ALIGN = Family("align")
Spoil = Callable[[Trajectories, Aligned], Aligned]


def moves_the_first_marker(take: Trajectories, output: Aligned) -> Aligned:
    positions = output.aligned.positions.copy()
    positions[:, 0] += 1.0
    return output._replace(aligned=replace(output.aligned, positions=positions))


def gives_no_motion(take: Trajectories, output: Aligned) -> Aligned:
    still = np.zeros_like(output.head_motion.translations)
    return output._replace(head_motion=replace(output.head_motion, translations=still))


def fills(take: Trajectories, output: Aligned) -> Aligned:
    aligned = output.aligned
    missing = ~aligned.present
    positions = np.where(missing[..., None], 0.0, aligned.positions)
    filled = aligned.with_samples(positions, changed=missing, origin=Origin.FILLED)
    return output._replace(aligned=filled)


def keeps_sigma(take: Trajectories, output: Aligned) -> Aligned:
    motion = output.head_motion
    half = replace(motion, scales=2.0 * motion.scales)
    positions = 0.5 * output.aligned.positions
    return output._replace(aligned=replace(output.aligned, positions=positions), head_motion=half)


def gives_every_frame(take: Trajectories, output: Aligned) -> Aligned:
    return output._replace(reference=output.aligned)


def does_nothing_to_the_last_frame(take: Trajectories, output: Aligned) -> Aligned:
    positions, motion = output.aligned.positions.copy(), output.head_motion
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    positions[-1], rotations[-1], translations[-1] = take.positions[-1], np.eye(3), 0.0
    turned = replace(motion, rotations=rotations, translations=translations)
    return output._replace(aligned=replace(output.aligned, positions=positions), head_motion=turned)


def turns_by_what_was_there(take: Trajectories, output: Aligned) -> Aligned:
    """A quarter turn about z in each frame, wherever the head was."""
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    motion = output.head_motion
    return output._replace(
        aligned=replace(output.aligned, positions=take.positions @ quarter.T),
        head_motion=replace(
            motion,
            rotations=np.tile(quarter.T, (take.frames, 1, 1)),
            translations=np.zeros((take.frames, 3)),
        ),
    )


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (moves_the_first_marker, "head_motion leads back"),
        (gives_no_motion, "head_motion leads back"),
        (fills, "with another origin: return"),
        (keeps_sigma, "sigma is not that of the samples"),
        (gives_every_frame, "reference has 40 frames: give the one"),
        (turns_by_what_was_there, "Leave a recording as it is that is aligned already"),
        (turns_by_what_was_there, "Give the same face wherever the head is"),
    ],
)
def test_an_alignment_that_breaks_a_promise(spoil: Spoil, text: str) -> None:
    def broken(recording: Trajectories, reference: Trajectories | None = None) -> Aligned:
        """Align, and spoil it."""
        return spoil(recording, procrustes(recording, reference))

    ALIGN.refuses(broken, text)


def test_frames_that_stay_as_they_are_are_no_fault() -> None:
    def partial(recording: Trajectories, reference: Trajectories | None = None) -> Aligned:
        """Align all frames but the last, which cannot be."""
        return does_nothing_to_the_last_frame(recording, procrustes(recording, reference))

    ALIGN.accepts(partial)


class Renamed(NamedTuple):
    face: Trajectories
    head_motion: HeadMotion
    reference: Trajectories


def test_outputs_by_other_names() -> None:
    def broken(recording: Trajectories, reference: Trajectories | None = None) -> Renamed:
        """Align, and call it otherwise."""
        return Renamed(*procrustes(recording, reference))

    ALIGN.refuses(broken, "let it return aligned, head_motion, reference")


def test_one_that_depends_on_the_head_although_it_has_a_reference() -> None:
    def broken(recording: Trajectories, reference: Trajectories | None = None) -> Aligned:
        """Align to the recording's own first frame, whatever the reference."""
        return procrustes(recording)

    ALIGN.refuses(broken, "Give the same face wherever the head is")


@pytest.mark.parametrize(
    ("align", "settings"),
    [
        (procrustes, {"steps": ()}),
        (procrustes, {"steps": ("translate", "scale"), "scale": "rms"}),
        (trimmed, {"share": 0.5}),
        (huber, {"width": 0.1, "scale": "rms"}),
    ],
)
def test_good_ones_pass(align: Callable[..., Aligned], settings: dict[str, object]) -> None:
    ALIGN.accepts(align, **settings)
