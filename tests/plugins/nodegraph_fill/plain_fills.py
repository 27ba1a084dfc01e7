"""The step-wise fills once more as plain loops, and what other fills are compared with."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from nodegraph_mocap import Origin, Trajectories
from tests.plugins.recordings import make_recording

Positions = NDArray[np.float64]
Weigh = Callable[[list[float]], list[float]]


def plain_gaps(origin: NDArray[np.uint8]) -> list[tuple[int, int, int]]:
    """Marker, first missing frame, first frame after, of every run of missing samples."""
    gaps = []
    for marker in range(origin.shape[1]):
        start = None
        for frame in range(len(origin) + 1):
            missing = frame < len(origin) and origin[frame, marker] == Origin.MISSING
            if missing and start is None:
                start = frame
            if not missing and start is not None:
                gaps.append((marker, start, frame))
                start = None
    return gaps


class PlainPass:
    """The rule of the step-wise fills, one sample at a time."""

    def __init__(
        self,
        recording: Trajectories,
        weigh: Weigh,
        *,
        neighbours: int,
        use_filled: bool,
        ring: int = 0,
        joined: NDArray[np.bool_] | None = None,
    ) -> None:
        self.positions = recording.positions.copy()
        self.origin = recording.origin.copy()
        self.weigh, self.neighbours, self.use_filled = weigh, neighbours, use_filled
        self.ring, self.joined = ring, joined

    def distance(self, frame: int, first: int, second: int) -> float:
        x, y, z = self.positions[frame, first] - self.positions[frame, second]
        return math.sqrt(x * x + y * y + z * z)

    def tier(self, before: int, now: int, marker: int) -> int | None:
        """0 measured at both frames, 1 filled at one of them, None unusable."""
        kinds = {int(self.origin[before, marker]), int(self.origin[now, marker])}
        if Origin.MISSING in kinds:
            return None
        if Origin.FILLED in kinds:
            return 1 if self.use_filled else None
        return 0

    def predict(self, before: int, now: int, marker: int) -> Positions | None:
        candidates = []
        for other in range(self.origin.shape[1]):
            apart = self.joined is not None and not self.joined[marker, other]
            tier = self.tier(before, now, other)
            if other != marker and not apart and tier is not None:
                candidates.append((tier, self.distance(before, marker, other), other))
        chosen = sorted(candidates)[: self.neighbours]
        if not chosen or self.origin[before, marker] == Origin.MISSING:
            return None
        place: Positions = self.positions[before, marker].copy()
        for weight, (_, _, other) in zip(
            self.weigh([d for _, d, _ in chosen]), chosen, strict=True
        ):
            place += weight * (self.positions[now, other] - self.positions[before, other])
        return place

    def urgency(self, before: int, now: int, marker: int) -> tuple[float, float, int]:
        present = [
            (self.distance(before, marker, other), other)
            for other in range(self.origin.shape[1])
            if other != marker and self.origin[before, other] != Origin.MISSING
        ]
        nearest = sorted(present)[: self.ring]
        usable = sum(self.tier(before, now, other) is not None for _, other in nearest)
        mean = sum(d for d, _ in nearest) / len(nearest) if nearest else math.inf
        return (-usable, mean, marker)

    def run(self, wanted: Sequence[tuple[int, int, int]], step: int) -> None:
        samples = {(frame, m) for m, start, stop in wanted for frame in range(start, stop)}
        frames = range(1, len(self.origin)) if step == 1 else range(len(self.origin) - 2, -1, -1)
        for now in frames:
            before = now - step
            waiting = [
                marker
                for marker in range(self.origin.shape[1])
                if (now, marker) in samples and self.origin[before, marker] != Origin.MISSING
            ]
            while waiting:
                if self.ring:
                    waiting.sort(key=lambda marker: self.urgency(before, now, marker))
                marker = waiting.pop(0)
                place = self.predict(before, now, marker)
                if place is not None:
                    self.positions[now, marker] = place
                    self.origin[now, marker] = Origin.FILLED


def run_plainly(
    recording: Trajectories,
    weigh: Weigh,
    *,
    close_gap: str = "none",
    max_gap: int | None = None,
    **rule: Any,
) -> Positions:
    """Fill as the step-wise fills promise; returns the positions."""
    frames = recording.frames
    gaps = [
        gap
        for gap in plain_gaps(recording.origin)
        if gap[2] - gap[1] < frames and (max_gap is None or gap[2] - gap[1] <= max_gap)
    ]
    forward = PlainPass(recording, weigh, **rule)
    forward.run(gaps, 1)
    if close_gap == "blend":
        backward = PlainPass(recording, weigh, **rule)
        backward.run(gaps, -1)
        return _plainly_blended(forward.positions, backward.positions, gaps)
    ramps = list(_plain_ramps(forward, gaps)) if close_gap == "ramp" else []
    forward.run([gap for gap in gaps if gap[1] == 0], -1)
    for marker, frame, shift in ramps:
        forward.positions[frame, marker] += shift
    return forward.positions


def _plainly_blended(
    forward: Positions, backward: Positions, gaps: list[tuple[int, int, int]]
) -> Positions:
    for marker, start, stop in gaps:
        for frame in range(start, stop):
            share = (frame - start + 1) / (stop - start + 1)
            ahead, back = forward[frame, marker], backward[frame, marker]
            if np.isnan(ahead).any():
                forward[frame, marker] = back
            elif not np.isnan(back).any():
                forward[frame, marker] = (1 - share) * ahead + share * back
    return forward


def _plain_ramps(
    filled: PlainPass, gaps: list[tuple[int, int, int]]
) -> Iterator[tuple[int, int, Positions]]:
    for marker, start, stop in gaps:
        if start == 0 or stop == len(filled.positions):
            continue
        place = filled.predict(stop - 1, stop, marker)
        if place is not None:
            mismatch = filled.positions[stop, marker] - place
            for frame in range(start, stop):
                yield marker, frame, mismatch * (frame - start + 1) / (stop - start + 1)


def carry(recording: Trajectories, end: int, frame: int, marker: int, k: int) -> Positions:
    """Where the nearest markers' motion takes a marker, by SciPy's own fit; NaN without one."""
    nowhere = np.full(3, np.nan)
    if not 0 <= end < recording.frames:
        return nowhere
    then, now = recording.positions[end], recording.positions[frame]
    both = recording.present[end] & recording.present[frame]
    apart = [(float(np.linalg.norm(then[i] - then[marker])), i) for i in np.flatnonzero(both)]
    body = [i for _, i in sorted(apart)[:k]]
    if len(body) < 3:
        return nowhere
    source, target = then[body] - then[body].mean(axis=0), now[body] - now[body].mean(axis=0)
    for first in (source, target):
        extent = np.linalg.svd(first, compute_uv=False)
        if extent[1] <= 0.05 * extent[0]:
            return nowhere
    turn, _ = Rotation.align_vectors(target, source)
    return np.asarray(turn.apply(then[marker] - then[body].mean(axis=0)) + now[body].mean(axis=0))


def check_hermite(
    fill: Callable[..., Trajectories], slope: Callable[[list[float], list[float], int], float]
) -> None:
    """Check that a gap is filled by Hermite's curve of the slopes at its ends."""
    truth = np.cumsum(np.random.default_rng(0).normal(size=(14, 5, 3)), axis=0)
    gappy = truth.copy()
    gappy[5:9] = np.nan
    filled = fill(make_recording(gappy)).positions
    known = [0, 1, 2, 3, 4, 9, 10, 11, 12, 13]
    x = [float(frame) for frame in known]
    for marker, axis in np.ndindex(5, 3):
        y = [float(truth[frame, marker, axis]) for frame in known]
        first, last = slope(x, y, 4), slope(x, y, 5)
        for frame in range(5, 9):
            s = (frame - 4) / 5
            expected = (
                (1 + 2 * s) * (1 - s) ** 2 * y[4]
                + s * (1 - s) ** 2 * 5 * first
                + s * s * (3 - 2 * s) * y[5]
                + s * s * (s - 1) * 5 * last
            )
            assert filled[frame, marker, axis] == pytest.approx(expected, abs=1e-10)


def driven(frames: int, markers: int, *, movements: int, noise: float, seed: int) -> Positions:
    """Markers that hidden movements drive, and noise of that standard deviation."""
    random = np.random.default_rng(seed)
    places = random.normal(0, 30, (markers, 3))
    hidden = np.cumsum(random.normal(0, 1, (frames, movements)), axis=0)
    shapes = random.normal(0, 1, (movements, markers, 3))
    off = random.normal(0, noise, (frames, markers, 3))
    return np.asarray(places + np.einsum("tk,kmc->tmc", hidden, shapes) + off)
