"""Strategies for recordings, their gaps, and their points without names."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph_mocap.detections import Detections
from nodegraph_mocap.recording import Mask, Origin, Trajectories
from nodegraph_mocap.testing.events import (
    MOST_EVENTS,
    RADIUS,
    RATES,
    at_rest,
    names_of,
    runs,
    seeds,
)
from nodegraph_mocap.testing.faces import marker_sets

if TYPE_CHECKING:
    from hypothesis.strategies import DrawFn, SearchStrategy
    from numpy.typing import NDArray


def recordings(
    *,
    frames: tuple[int, int] = (1, 24),
    markers: tuple[int, int] = (1, 8),
    gaps: bool = True,
    processed: bool = True,
    with_marker_set: bool = True,
) -> SearchStrategy[Trajectories]:
    """Return a strategy for recordings of a face.

    Its markers are at rest, move smoothly, or jump about; single samples lie elsewhere.

    Parameters
    ----------
    frames, markers
        The least and the largest number; at most 16 markers.
    gaps
        Whether samples may be missing: runs of one marker, also at the ends or of the whole take,
        frames without any marker, or everything.
    processed
        Whether samples may be filled or repaired, and have a sigma.
    with_marker_set
        Whether there may be a marker set.
    """
    from hypothesis import strategies as st

    @st.composite
    def recording(draw: DrawFn) -> Trajectories:
        positions, names = _moving(draw, frames, markers)
        face = Trajectories(positions=positions, markers=names, rate=draw(st.sampled_from(RATES)))
        if with_marker_set and draw(st.booleans()):
            face = replace(face, marker_set=draw(marker_sets(names)))
        if gaps:
            face = _without(face, _events(draw, face))
        return _partly_processed(draw, face) if processed else face

    return recording()


def cuts(**how: Any) -> SearchStrategy[tuple[Trajectories, Trajectories, Mask]]:
    """Return a strategy for recordings with gaps that were cut: gappy, truth, what is hidden.

    Parameters
    ----------
    how
        As for `recordings`, of the truth.
    """
    from hypothesis import strategies as st

    @st.composite
    def cut(draw: DrawFn) -> tuple[Trajectories, Trajectories, Mask]:
        truth = draw(recordings(**how))
        hidden = draw(masks(truth))
        return _without(truth, hidden.hidden), truth, hidden

    return cut()


def masks(recording: Trajectories) -> SearchStrategy[Mask]:
    """Return a strategy for masks that hide present samples of one recording, none or more."""
    from hypothesis import strategies as st

    @st.composite
    def mask(draw: DrawFn) -> Mask:
        hidden = _events(draw, recording) & recording.present
        return Mask(hidden=hidden, markers=recording.markers)

    return mask()


def detections(**how: Any) -> SearchStrategy[Detections]:
    """Return a strategy for points without names: present samples in any order, and ghosts.

    Parameters
    ----------
    how
        As for `recordings`, of the recording whose points they are.
    """
    from hypothesis import strategies as st

    @st.composite
    def seen(draw: DrawFn) -> Detections:
        recording = draw(recordings(**how))
        frame, marker = np.nonzero(recording.present)
        points = recording.positions[frame, marker]
        ghosts = draw(st.lists(st.integers(0, recording.frames - 1), max_size=MOST_EVENTS))
        chance = np.random.default_rng(draw(seeds()))
        frame = np.concatenate([frame, np.array(ghosts, dtype=frame.dtype)])
        points = np.concatenate([points, chance.normal(0.0, RADIUS, (len(ghosts), 3))])
        order = np.lexsort((chance.permutation(len(frame)), frame))
        counts = np.bincount(frame, minlength=recording.frames)
        offsets = np.concatenate([[0], np.cumsum(counts)])
        return Detections(points=points[order], offsets=offsets, rate=recording.rate)

    return seen()


def _moving(
    draw: DrawFn, frames: tuple[int, int], markers: tuple[int, int]
) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Return (T, M, 3) positions and the names."""
    from hypothesis import strategies as st
    from hypothesis.extra.numpy import arrays

    names, count = names_of(draw, markers), draw(st.integers(*frames))
    shape = (count, len(names), 3)
    chance = np.random.default_rng(draw(seeds()))
    motion = draw(st.sampled_from([_still, _smooth, _jumping]))(shape, chance)
    offsets = st.floats(-500.0, 500.0, allow_subnormal=False, width=32)
    off = draw(arrays(np.float64, shape, elements=offsets, fill=st.just(0.0)))
    return at_rest(len(names)) + motion + off, names


def _still(shape: tuple[int, ...], chance: np.random.Generator) -> NDArray[np.float64]:
    return np.zeros(shape)


def _smooth(shape: tuple[int, ...], chance: np.random.Generator) -> NDArray[np.float64]:
    time = np.arange(shape[0])[:, None, None]
    period, phase = chance.uniform(10.0, 60.0, shape[1:]), chance.uniform(0.0, 6.0, shape[1:])
    return np.asarray(5.0 * np.sin(2.0 * np.pi * time / period + phase))


def _jumping(shape: tuple[int, ...], chance: np.random.Generator) -> NDArray[np.float64]:
    return chance.normal(0.0, 5.0, shape)


def _events(draw: DrawFn, recording: Trajectories) -> NDArray[np.bool_]:
    """Return (T, M): runs of markers, whole frames, or everything."""
    from hypothesis import strategies as st

    where = runs(draw, recording.origin.shape)
    last = recording.frames - 1
    where[draw(st.lists(st.integers(0, last), max_size=2))] = True
    if draw(st.integers(0, 15)) == 15:
        where[:] = True
    return where


def _without(recording: Trajectories, where: NDArray[np.bool_]) -> Trajectories:
    positions = np.where(where[..., None], np.nan, recording.positions)
    sigma = None if recording.sigma is None else np.where(where, np.nan, recording.sigma)
    return recording.with_samples(positions, changed=where, origin=Origin.MISSING, sigma=sigma)


def _partly_processed(draw: DrawFn, recording: Trajectories) -> Trajectories:
    from hypothesis import strategies as st

    origin = recording.origin.copy()
    for kind in (Origin.FILLED, Origin.REPAIRED):
        if draw(st.booleans()):
            origin[runs(draw, origin.shape) & recording.present] = kind
    sigma = np.where(recording.present, 0.1, np.nan) if draw(st.booleans()) else None
    return replace(recording, origin=origin, sigma=sigma)
