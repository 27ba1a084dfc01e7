"""Measurement noise on a recording, whose truth is known."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
from pydantic import Field

from nodegraph import Truth, Unit, node
from nodegraph_mocap import Trajectories
from nodegraph_mocap.random_numbers import Seed, random_for
from nodegraph_mocap.truth import truth_of
from nodegraph_synthesize.smooth_noise import low_passed_noise

if TYPE_CHECKING:
    from numpy.typing import NDArray


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
    cutoff: Annotated[float | None, Field(gt=0.0, allow_inf_nan=False), Unit("Hz")] = None,
    seed: Seed = 0,
) -> Noisy:
    """Add Gaussian noise to every present sample, white or low-passed.

    ``noisy = recording + sigma g``, with g three standard normal numbers per sample: isotropic,
    independent from marker to marker and, without `cutoff`, from frame to frame. Cameras make
    white noise; a recording that was low-passed before it was published, as most are, has what
    the filter has left of it, and fills that follow a marker's own curve do better there. Missing
    samples stay missing, and `origin` stays as it is: the samples are as measured as before. Where
    the recording states its own `sigma`, the two combine as independent errors do, to
    ``sqrt(own^2 + sigma^2)``; a recording that states none still states none.

    The draws depend on the seed, `cutoff` and the numbers of frames and markers alone: another
    `sigma` is the same noise at another scale, and a gap does not change the noise around it.
    Two of these in a row need two seeds, or the same noise is added twice.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps.
    truth
        The recording that errors are measured to, the same frames and markers without noise;
        `recording` itself if left open. It has no influence on what is added.
    sigma
        Standard deviation of each coordinate, after the filter; the distance from the recording is
        ``sqrt(3)`` of it, root mean square.
    cutoff
        Half-gain frequency of the Butterworth low-pass of second order that white noise has gone
        through forwards and backwards, ``1 / (1 + (f / cutoff)^4)``. None: white.
    seed
        Same seed, same noise. A list, such as ``[$trial, $recording]`` in a graph, is another
        seed for each recording.

    Raises
    ------
    ValueError
        If the frames, rate or markers of `truth` are not those of the recording, or the cut-off is
        not below half its rate.
    """
    shape, random = recording.positions.shape, random_for("noise.add", seed)
    shaken = sigma * noise_of(random, shape, cutoff, recording.rate)
    own = recording.sigma
    noisy = replace(
        recording,
        positions=recording.positions + shaken,
        sigma=None if own is None else np.hypot(own, sigma),
    )
    return Noisy(noisy, truth_of(recording, truth))


def noise_of(
    random: np.random.Generator, shape: tuple[int, ...], cutoff: float | None, rate: float
) -> NDArray[np.float64]:
    """Return (T, M, 3) noise of standard deviation 1, white or low-passed.

    Raises
    ------
    ValueError
        If the cut-off, in Hz, is not below half the rate.
    """
    if cutoff is None:
        return random.standard_normal(shape)
    if not cutoff < 0.5 * rate:
        raise ValueError(
            f"a cut-off of {cutoff:g} Hz is not below half the rate, {0.5 * rate:g} Hz: leave it "
            "out for white noise"
        )
    frames, markers, _ = shape
    return low_passed_noise(random, frames, 3 * markers, cutoff, rate).reshape(shape)
