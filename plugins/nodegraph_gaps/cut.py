"""Gaps of known content: samples that were measured, hidden at random."""

from __future__ import annotations

from inspect import signature
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field

from nodegraph import Truth, Unit, node
from nodegraph_gaps.bursts import Bursts
from nodegraph_gaps.groups import AnyMarkers, Groups, contiguous, region
from nodegraph_gaps.places import free_places, place_events
from nodegraph_gaps.transplant import transplanted
from nodegraph_mocap import Mask, Origin, Trajectories
from nodegraph_mocap.random_numbers import Seed, entropy
from nodegraph_mocap.reference_shape import reference_shape
from nodegraph_mocap.truth import truth_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

Pattern = Literal["random", "contiguous", "region", "end", "occlusion"]


class Cut(NamedTuple):
    """A recording with gaps, and what they hide.

    Attributes
    ----------
    gappy : Trajectories
        The recording without the hidden samples.
    truth : Trajectories
        The recording that errors are measured to: the truth that was put in, else the recording as
        it came.
    hidden : Mask
        The samples that were hidden.
    """

    gappy: Trajectories
    truth: Truth[Trajectories]
    hidden: Mask


def _check_fit(
    recording: Trajectories,
    pattern_from: Trajectories | None,
    length: int,
    count: int,
    simultaneous: int,
    pattern: Pattern,
) -> None:
    """Refuse settings that no seed can fulfil."""
    if pattern_from is not None:
        _refuse(length=length, count=count, simultaneous=simultaneous, pattern=pattern)
        return
    # an event of several markers takes as many places as as many events of one marker
    free = free_places(recording, length, at_end=pattern == "end")
    random = np.random.default_rng(0)
    _, fitting = place_events(free, length, count * simultaneous, AnyMarkers(1), random)
    fitting = fitting // simultaneous if simultaneous <= len(recording.markers) else 0
    _check_count(fitting, recording, length, count, simultaneous, pattern)


@node("gaps.cut", requires=_check_fit)
def cut(
    recording: Trajectories,
    pattern_from: Trajectories | None = None,
    truth: Truth[Trajectories] | None = None,
    *,
    length: Annotated[int, Field(ge=1), Unit("frames")] = 15,
    count: Annotated[int, Field(ge=1), Unit("gap events")] = 20,
    simultaneous: Annotated[int, Field(ge=1), Unit("markers")] = 1,
    pattern: Pattern = "random",
    seed: Seed = 0,
) -> Cut:
    """Hide measured samples in gap events, to ask a fill for them.

    An event hides the same frames of one or several markers. Only measured (or repaired)
    samples are hidden, and a present sample stays on each side of every gap, so that no two
    gaps touch. Events of different markers may lie at the same time.

    Which samples are hidden follows from the seed, the recording's present samples and its
    reference shape (the most complete frame) alone, and in bursts from names or speeds of its
    markers, so that all methods face the same gaps.
    Events are drawn one after the other among the places that are still free. Where chance has
    left too little room for all of them, they are drawn instead from a dense packing, which
    begins at the take's start. All this needs the whole take: on a stream, `gaps.dropout` hides
    samples as they arrive.

    With `pattern` occlusion, events come in bursts: 8 on average (geometric), each around one of
    four neighbours, at times that are normal around the burst's middle with a standard deviation
    of 0.2 s, or as near to these as there is room. Of 34 real gaps of 13 markers on a body, at 100
    Hz, 28 have another gap of the same marker within 0.2 s (7 if their times were random), and
    they lie in four such bursts. Bursts centre on any marker, four times as often on one of the
    mouth or an eyelid, as its name says (mouth, lip, eyelid, lid): a convention, as no open
    recording of a face has gaps of its own. Without such names they centre on markers in
    proportion to their mean speed in relation to all markers; on that body, markers with gaps were
    a fifth faster than others.

    With `pattern_from`, the gaps of that recording are laid over this one instead, once and as a
    whole; `length`, `count`, `simultaneous` and `pattern` must then be left at their defaults.

    - A gap is a run of missing (or filled) samples of one marker with a measured sample on each
      side; runs that reach the beginning or the end of the take are left out and counted.
    - Times are in seconds: a gap of n frames at a rate r has ``n rate / r`` frames here, rounded,
      one at least, and begins as much later than the first gap of all, rounded. Where rounding
      would make two gaps of a marker touch, the later one waits until a sample is between them.
      So as many markers are missing at once as in that recording, but for rounding.
    - When the first gap begins is drawn by the seed among the frames at which everything fits;
      in a long recording up to 1000 frames are tried.
    - All gaps of one marker go to one marker, in the order of their first gaps. A marker that is
      missing at the same time as ones that have their place goes to the free marker nearest (in
      the reference shape) to the one that it shares the most frames with; others go to any free
      marker, drawn by the seed. Free is a marker that takes no other's gaps and where all of
      these fit.

    Of that recording nothing but its gaps and its rate counts.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps of their own.
    pattern_from
        A recording with gaps, whose pattern is taken; its markers may be of any kind.
    truth
        The recording that errors are measured to, the same frames and markers without noise;
        `recording` itself if left open. It has no influence on what is hidden.
    length
        Frames that an event hides.
    count
        How many events.
    simultaneous
        Markers that an event hides.
    pattern
        Which markers an event hides. random: any. contiguous: a random marker and those
        nearest to it. region: a random marker and those nearest to it on one side of it, in a
        random direction, as when something covers the face from that side; markers of the
        other side follow where that side has too few. end: any, and the event reaches the
        take's last frame, with a present sample before it only. occlusion: a marker and those
        nearest to it, in bursts, see below.
    seed
        Same seed, same gaps. A list, such as ``[$trial, $recording]`` in a graph, is another
        seed for each recording.

    Raises
    ------
    ValueError
        If the events do not fit; the message says how many do. With `pattern_from`: if it has
        no gap, or another setting than `seed` is given. With `truth`: if its frames, rate or
        markers are not those of the recording, or it lacks a sample that is hidden.
    """
    random = np.random.default_rng(entropy(seed))
    if pattern_from is None:
        hidden = _events(recording, length, count, simultaneous, pattern, random)
    else:
        _refuse(length=length, count=count, simultaneous=simultaneous, pattern=pattern)
        hidden = transplanted(recording, pattern_from, random)
    return Cut(
        without(recording, hidden),
        truth_of(recording, truth, hidden),
        Mask(hidden=hidden, markers=recording.markers),
    )


def _refuse(**settings: object) -> None:
    """Refuse settings that the pattern of a recording decides."""
    known = signature(cut).parameters
    conflicting = [name for name, value in settings.items() if value != known[name].default]
    if conflicting:
        raise ValueError(
            f"{', '.join(conflicting)}: the gaps come from pattern_from; leave these settings out, "
            "or leave pattern_from open"
        )


def _events(
    recording: Trajectories,
    length: int,
    count: int,
    simultaneous: int,
    pattern: Pattern,
    random: np.random.Generator,
) -> NDArray[np.bool_]:
    free = free_places(recording, length, at_end=pattern == "end")
    groups = _groups(recording, pattern, simultaneous, random)
    events, fitting = place_events(free, length, count, groups, random)
    _check_count(fitting, recording, length, count, simultaneous, pattern)
    hidden = np.zeros(recording.origin.shape, dtype=np.bool_)
    for start, markers in events:
        hidden[start : start + length, markers] = True
    return hidden


def _check_count(
    fitting: int,
    recording: Trajectories,
    length: int,
    count: int,
    simultaneous: int,
    pattern: Pattern,
) -> None:
    if fitting < count:
        each = "" if simultaneous == 1 else f" on {simultaneous} markers at once"
        raise ValueError(
            f"{count} gaps of {length} frames{each} requested, {fitting} fit into "
            f"{recording.frames} frames of {len(recording.markers)} markers ({pattern}): ask for "
            "fewer or shorter"
        )


def _groups(
    recording: Trajectories, pattern: Pattern, size: int, random: np.random.Generator
) -> AnyMarkers | Groups | Bursts:
    if pattern == "occlusion":
        return Bursts(recording, size)
    if pattern == "contiguous":
        return contiguous(reference_shape(recording), size)
    if pattern == "region":
        return region(reference_shape(recording), size, random)
    return AnyMarkers(size)


def without(recording: Trajectories, hidden: NDArray[np.bool_]) -> Trajectories:
    """Return the recording without the samples of a (T, M) mask."""
    positions = np.where(hidden[..., None], np.nan, recording.positions)
    return recording.with_samples(positions, changed=hidden, origin=Origin.MISSING)
