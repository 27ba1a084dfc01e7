"""Measurement noise on a recording, whose truth is known."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from nodegraph import Truth, Unit, node
from nodegraph_mocap import Trajectories
from nodegraph_mocap.streams import Seed, random_for
from nodegraph_mocap.truth import truth_of


class Noisy(NamedTuple):
    """A recording with noise, and without it.

    Attributes
    ----------
    noisy : Trajectories
        The recording with noise on every present sample.
    truth : Trajectories
        The truth that was given, else the recording without noise.
    """

    noisy: Trajectories
    truth: Truth[Trajectories]


@node("noise.add")
def add(
    recording: Trajectories,
    truth: Truth[Trajectories] | None = None,
    *,
    sigma: Annotated[float, Field(ge=0.0, le=100.0), Unit("mm")] = 0.1,
    seed: Seed = 0,
) -> Noisy:
    """Add white Gaussian noise to every present sample.

    ``noisy = recording + sigma g``, with g three independent standard normal numbers per sample:
    isotropic, independent from frame to frame and from marker to marker. Missing samples stay
    missing, and `origin` stays as it is: the samples are as measured as before. Where the
    recording states its own `sigma`, the two combine as independent errors do, to
    ``sqrt(own^2 + sigma^2)``; a recording that states none still states none.

    The draws depend on the seed and on the numbers of frames and markers alone: another `sigma`
    is the same noise at another scale, and a gap does not change the noise around it. Two of
    these in a row need two seeds, or the same noise is added twice.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps.
    truth
        The recording that errors are measured to, the same frames and markers without noise;
        `recording` itself if left open. It has no influence on what is added.
    sigma
        Standard deviation of each coordinate; the distance from the recording is ``sqrt(3)`` of
        it, root mean square.
    seed
        Same seed, same noise. A list, such as ``[$trial, $recording]`` in a graph, is another
        seed for each recording.

    Returns
    -------
    Noisy
        noisy, truth.

    Raises
    ------
    ValueError
        If the frames, rate or markers of `truth` are not those of the recording.
    """
    shaken = sigma * random_for("noise.add", seed).standard_normal(recording.positions.shape)
    own = recording.sigma
    noisy = replace(
        recording,
        positions=recording.positions + shaken,
        sigma=None if own is None else np.hypot(own, sigma),
    )
    return Noisy(noisy, truth_of(recording, truth))
