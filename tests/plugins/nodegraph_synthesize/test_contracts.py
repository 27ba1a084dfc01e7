"""A node that adds noise or impulses and breaks a promise is caught."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import nodegraph_mocap
import nodegraph_synthesize
from nodegraph import node
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry
from nodegraph.testing import check_node
from nodegraph_mocap import Mask, Origin, Trajectories
from nodegraph_synthesize.impulses import Spiky
from nodegraph_synthesize.impulses import add as add_impulses
from nodegraph_synthesize.noise import Noisy
from nodegraph_synthesize.noise import add as add_noise

REGISTRY = Registry(
    loaded=[Plugin("mocap", nodegraph_mocap), Plugin("synthesize", nodegraph_synthesize)]
)


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
    @node("noise.broken")
    def broken(recording: Trajectories) -> Noisy:
        """Add noise, and spoil it."""
        return spoil(add_noise(recording))

    with pytest.raises(AssertionError, match=text):
        check_node(broken, registry=REGISTRY)


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
    @node("impulses.broken")
    def broken(recording: Trajectories) -> Spiky:
        """Add impulses, and spoil them."""
        return spoil(add_impulses(recording, share=0.1))

    with pytest.raises(AssertionError, match=text):
        check_node(broken, registry=REGISTRY)


def test_other_ports() -> None:
    @node("noise.broken")
    def noise(recording: Trajectories) -> Trajectories:
        """Add no noise."""
        return recording

    @node("impulses.broken")
    def impulses(recording: Trajectories) -> Mask:
        """Hit nothing."""
        return Mask(hidden=np.zeros_like(recording.present), markers=recording.markers)

    with pytest.raises(AssertionError, match="'noisy' is not a Trajectories; its ports are rec"):
        check_node(noise, registry=REGISTRY)
    with pytest.raises(AssertionError, match="the first output is 'output', not 'spiky'"):
        check_node(impulses, registry=REGISTRY)
