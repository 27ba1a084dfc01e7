"""A node that adds noise or impulses and breaks a promise is caught."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from nodegraph_mocap import Mask, Origin, Trajectories
from nodegraph_synthesize.impulses import Spiky
from nodegraph_synthesize.impulses import add as add_impulses
from nodegraph_synthesize.noise import Noisy
from nodegraph_synthesize.noise import add as add_noise
from tests.promises import Family

NOISE = Family("noise", "synthesize")
IMPULSES = Family("impulses", "synthesize")


def other_truth(face: Noisy) -> Noisy:
    return face._replace(truth=face.noisy)


def fills(face: Noisy) -> Noisy:
    positions = np.nan_to_num(face.noisy.positions)
    full = face.noisy.with_samples(positions, changed=~face.noisy.present, origin=Origin.MEASURED)
    return face._replace(noisy=full)


def says_repaired(face: Noisy) -> Noisy:
    origin = np.where(face.noisy.present, np.uint8(Origin.REPAIRED), np.uint8(Origin.MISSING))
    return face._replace(noisy=replace(face.noisy, origin=origin))


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (other_truth, "return it as it came"),
        (fills, "origins differ from the recording's"),
        (says_repaired, "origins differ from the recording's"),
    ],
)
def test_noise_that_breaks_a_promise(spoil: Callable[[Noisy], Noisy], text: str) -> None:
    def broken(recording: Trajectories) -> Noisy:
        """Add noise, and spoil it."""
        return spoil(add_noise(recording))

    NOISE.refuses(broken, text)


def everywhere(face: Spiky) -> Spiky:
    positions = face.spiky.positions + 1.0
    return face._replace(spiky=replace(face.spiky, positions=positions))


def without_impulse(face: Spiky) -> Spiky:
    return face._replace(spiky=face.truth)


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (everywhere, "samples differ that are not among the impulses"),
        (without_impulse, "impulses are where nothing differs"),
    ],
)
def test_impulses_that_are_not_where_they_are_said_to_be(
    spoil: Callable[[Spiky], Spiky], text: str
) -> None:
    def broken(recording: Trajectories) -> Spiky:
        """Add impulses, and spoil them."""
        return spoil(add_impulses(recording, share=0.1))

    IMPULSES.refuses(broken, text)


def test_other_ports() -> None:
    def noise(recording: Trajectories) -> Trajectories:
        """Add no noise."""
        return recording

    def impulses(recording: Trajectories) -> Mask:
        """Hit nothing."""
        return Mask(hidden=np.zeros_like(recording.present), markers=recording.markers)

    NOISE.refuses(noise, "'noisy' is not a Trajectories; its ports are rec")
    IMPULSES.refuses(impulses, "the first output is 'output', not 'spiky'")
