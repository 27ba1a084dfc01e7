"""Impulses on a recording: single samples that are far off, at known places."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
from pydantic import Field

from nodegraph import Truth, Unit, node
from nodegraph_mocap import Mask, Trajectories
from nodegraph_mocap.random_numbers import Seed, random_for
from nodegraph_mocap.truth import truth_of
from nodegraph_synthesize.damage import lone_samples, offsets

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Spiky(NamedTuple):
    """A recording with impulses, and where they are.

    Attributes
    ----------
    spiky : Trajectories
        The recording with impulses.
    truth : Trajectories
        The truth that was given, else the recording without impulses.
    impulses : Mask
        The samples that an impulse has hit.
    """

    spiky: Trajectories
    truth: Truth[Trajectories]
    impulses: Truth[Mask]


@node("impulses.add")
def add(
    recording: Trajectories,
    truth: Truth[Trajectories] | None = None,
    *,
    share: Annotated[float, Field(ge=0.0, le=0.2), Unit("share")] = 0.005,
    size: Annotated[float, Field(gt=0.0, le=1000.0), Unit("mm")] = 5.0,
    seed: Seed = 0,
) -> Spiky:
    """Put single samples off by one distance, each in a random direction.

    An impulse moves one sample of one marker by exactly `size`, in a direction uniform over the
    sphere; the frames before and after are as they were. A sample is hit only where its marker
    is present in the frame before and in the frame after, and no marker is hit in two frames in
    a row: so none is hit in the first or last frame or beside a gap, where a rule that looks at
    both steps of a sample cannot see an impulse at all. `origin` and `sigma` stay as they are,
    as the recording does not know what has hit it.

    Places and directions are drawn from the seed and the present samples alone: another `size`
    hits the same samples in the same directions, and a larger `share` hits those of a smaller
    one, in the same directions, and more. In a recording without gaps about a third of the
    samples can be hit at most: those whose random key is the lowest of three frames.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps.
    truth
        The recording that errors are measured to, the same frames and markers without noise;
        `recording` itself if left open. It has no influence on what is hit.
    share
        Share of the present samples that is hit, to the nearest whole number of samples.
    size
        Distance of each hit sample from where it was.
    seed
        Same seed and present samples, same places and directions. A list, such as
        ``[$trial, $recording]`` in a graph, is another seed for each recording.

    Raises
    ------
    ValueError
        If the impulses do not fit; the message says how many do. If the frames, rate or markers
        of `truth` are not those of the recording, or it lacks a sample that is hit.
    """
    present = recording.present
    random = random_for("impulses.add", seed)
    keys = random.random(present.shape)
    jumps = offsets(random, np.full(present.shape, size))
    wanted = round(share * np.count_nonzero(present))
    hit = lone_samples(keys, _inside(present), wanted)
    _check(hit, present, wanted, share, seed)
    positions = np.where(hit[..., None], recording.positions + jumps, recording.positions)
    return Spiky(
        replace(recording, positions=positions),
        truth_of(recording, truth, hit),
        Mask(hidden=hit, markers=recording.markers),
    )


def _inside(present: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return where a sample and those before and after it are present."""
    inside = np.zeros_like(present)
    inside[1:-1] = present[:-2] & present[1:-1] & present[2:]
    return inside


def _check(
    hit: NDArray[np.bool_], present: NDArray[np.bool_], wanted: int, share: float, seed: Seed
) -> None:
    samples, fitting = np.count_nonzero(present), np.count_nonzero(hit)
    if fitting < wanted:
        raise ValueError(
            f"{wanted} impulses requested ({share} of {samples} present samples), {fitting} fit "
            f"with seed {seed}, in single frames with a present sample on each side: ask for a "
            "smaller share"
        )
    if share > 0 and not wanted:
        warnings.warn(f"no impulse: {share} of {samples} present samples is none", stacklevel=3)
