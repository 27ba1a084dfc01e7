"""The packed data of a playback's script: positions, origins, meshes, morphs, weights.

Positions and vertices are rounded to steps of 0.01 mm at most: they are off by 0.005 mm at most in
each coordinate. Weights are rounded to 0.0001, which moves a vertex by less than that for each
5 cm of a morph. A recording is packed as differences from that of the same markers and frames
before it with which it shares the most samples: what several fills of one recording share is there
once. So is a head that several animations share.
"""

from __future__ import annotations

import gzip
import hashlib
import json
from dataclasses import astuple
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.animation import Animation
from nodegraph_mocap.face_layout import edges_of
from nodegraph_mocap.frame_ranges import runs_of
from nodegraph_mocap.playback import Curves, Panel, Playback, Strip
from nodegraph_mocap.recording import Origin, Trajectories

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from nodegraph_mocap.head import Head


MOST_STEPS = 2**30
"""Largest magnitude of a number, in steps; sums of two still fit 32 bits."""

_LEVEL = 4  # takes a third of the time of 6; a page is larger by 4 to 10 %


class Blob:
    """Collects arrays; what each method returns is how the head names the array."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._length = 0

    def steps(
        self, values: NDArray[np.float64], step: float, like: NDArray[np.int32] | None = None
    ) -> tuple[dict[str, object], NDArray[np.int32]]:
        """Add numbers, rounded to whole steps, each row as differences along itself.

        What is NaN repeats the number before it: where it is must be kept elsewhere. The four
        bytes of the differences lie apart, so that the upper ones, nearly always equal, vanish in
        the compression; and so do rows that are those of `like`.

        Parameters
        ----------
        values
            (rows, length), none farther from 0 than `MOST_STEPS` steps.
        step
            The size of one step; a number is off by half of it at most.
        like
            Steps of the same shape from which to tell the differences.

        Returns
        -------
        dict, (rows, length) array of int32
            How the head names the array, and its steps.
        """
        whole = np.rint(held(values) / step).astype(np.int32)
        differences = np.diff(whole if like is None else whole - like, axis=1, prepend=np.int32(0))
        planes = np.ascontiguousarray(differences.astype("<i4")).view(np.uint8).reshape(-1, 4).T
        place = self._add(planes.tobytes())
        return {"at": place, "rows": whole.shape[0], "length": whole.shape[1], "step": step}, whole

    def small(self, values: NDArray[np.uint8]) -> int:
        """Add whole numbers from 0 to 255."""
        return self._add(np.ascontiguousarray(values).tobytes())

    def exact(self, values: NDArray[np.float64]) -> dict[str, int]:
        """Add numbers as float32, about seven digits of each."""
        return {"at": self._add(values.astype("<f4").tobytes()), "length": values.size}

    def packed(self, head: object) -> bytes:
        """Return everything, under a head that names the arrays."""
        text = json.dumps(head, separators=(",", ":"), allow_nan=False).encode()
        # numbers of four bytes can be read in place only where they begin at a multiple of four
        text += b" " * (-len(text) % 4)
        content = b"".join([len(text).to_bytes(4, "little"), text, *self._parts])
        return gzip.compress(content, compresslevel=_LEVEL, mtime=0)

    def _add(self, content: bytes) -> int:
        place = self._length
        content += bytes(-len(content) % 4)
        self._parts.append(content)
        self._length += len(content)
        return place


def held(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (rows, length) numbers in which NaN repeats the one before it; 0 before the first."""
    known = ~np.isnan(values)
    if known.all():
        return values
    last = np.maximum.accumulate(np.where(known, np.arange(values.shape[1]), 0), axis=1)
    return np.nan_to_num(np.take_along_axis(values, last, axis=1))


_FINEST = 0.01
_STEPS_ACROSS = 5_000
_WEIGHT_STEP = 1e-4
_MOST_ERRORS = 95
_ROUND = (1.0, 2.0, 5.0, 10.0)
_MOST_GAPS = 300


def packed(playback: Playback) -> bytes:
    """Return what the script needs to play, compressed; see `nodegraph_mocap.player.data`."""
    return _Packing(playback).packed()


def step_of(panels: Iterable[Panel]) -> float:
    """Return the rounding of positions in mm: 0.01, or finer where the panels are tiny."""
    finest = max((panel.radius for panel in panels), default=1.0) / _STEPS_ACROSS
    return float(min(_FINEST, 10.0 ** np.floor(np.log10(finest))))


def beyond(recording: Trajectories, step: float) -> NDArray[np.bool_]:
    """Return (T, M), True for samples that are too far away to be stored in steps."""
    far = np.abs(recording.positions) > MOST_STEPS * step
    return np.asarray(far.any(axis=2))


def error_scale(playback: Playback) -> float:
    """Return the error in mm at which the colours end: round, above 19 of 20 made samples.

    Of all samples where none was made; 1 where nothing can be compared.
    """
    recordings = [panel.shown for panel in playback.panels if isinstance(panel.shown, Trajectories)]
    truth = _truth_of(playback)
    if truth is None:
        return 1.0
    errors = [_errors(recording, truth) for recording in recordings]
    estimated = [
        distances[shown.origin > Origin.MEASURED]
        for distances, shown in zip(errors, recordings, strict=True)
    ]
    for parts in (estimated, errors):
        every = np.concatenate(
            [np.empty(0), *(distances[np.isfinite(distances)] for distances in parts)]
        )
        largest = float(np.percentile(every, _MOST_ERRORS)) if len(every) else 0.0
        if largest > 0:
            return _rounded_up(largest)
    return 1.0


def columns_in(truth: Trajectories, recording: Trajectories) -> list[int]:
    """Return for each marker of a recording its column in the truth, -1 where it has none."""
    place = {marker: column for column, marker in enumerate(truth.markers)}
    return [place.get(marker, -1) for marker in recording.markers]


def _errors(recording: Trajectories, truth: Trajectories) -> NDArray[np.float64]:
    apart = recording.positions - truth.positions_of(recording.markers)
    return np.asarray(np.linalg.norm(apart, axis=2))


def _rounded_up(value: float) -> float:
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * min(digit for digit in _ROUND if digit * power >= value * (1 - 1e-9)))


class _Packing:
    """One playback on its way into a blob."""

    def __init__(self, playback: Playback) -> None:
        self.playback = playback
        self.blob = Blob()
        self.step = step_of(playback.with_truth)
        self._heads: dict[str, int] = {}
        self._head_entries: list[dict[str, object]] = []
        self._recordings: dict[int, tuple[tuple[str, ...], NDArray[np.float64]]] = {}
        self._steps: dict[int, NDArray[np.int32]] = {}

    def packed(self) -> bytes:
        panels = [self._panel(place, panel) for place, panel in enumerate(self.playback.with_truth)]
        head = {
            "panels": panels,
            "heads": self._head_entries,
            "truth": 0 if self.playback.truth else None,
            "errors": error_scale(self.playback),
            "every": self.playback.every,
            "start": _first_second(self.playback),
            "gaps": _gaps(self.playback),
            "curves": [self._curves(curves) for curves in self.playback.curves],
        }
        return self.blob.packed(head)

    def _panel(self, place: int, panel: Panel) -> dict[str, object]:
        shown = panel.shown
        entry = {
            "label": panel.label,
            "frames": shown.frames,
            "rate": shown.rate,
            "centre": panel.centre.tolist(),
            "right": panel.right.tolist(),
            "up": panel.up.tolist(),
            "radius": panel.radius,
        }
        if isinstance(shown, Animation):
            return entry | self._animation(shown)
        return {
            **entry,
            **self._recording(place, shown),
            "strip": panel.strip and self._strip(panel.strip),
            "marks": [astuple(mark) for mark in panel.marks],
            "can_be_marked": panel.can_be_marked,
        }

    def _recording(self, place: int, recording: Trajectories) -> dict[str, object]:
        origin = np.where(beyond(recording, self.step), Origin.MISSING, recording.origin)
        positions = np.where(origin[..., None] == Origin.MISSING, np.nan, recording.positions)
        rows = positions.reshape(recording.frames, 3 * len(recording.markers)).T
        like = self._nearest(recording.markers, rows)
        differing = None if like is None else self._steps[like]
        entry, self._steps[place] = self.blob.steps(rows, self.step, differing)
        self._recordings[place] = recording.markers, rows
        known = _truth_of(self.playback)
        return {
            "kind": "markers",
            "markers": recording.markers,
            "edges": edges_of(recording),
            "positions": entry,
            "like": like,
            "origin": self.blob.small(origin.T.astype(np.uint8)),
            "truth": columns_in(known, recording) if known and place > 0 else None,
            "error": _mean_error(recording, known) if known and place > 0 else None,
        }

    def _nearest(self, markers: tuple[str, ...], rows: NDArray[np.float64]) -> int | None:
        """Return the recording packed before that shares the most samples with this one."""
        alike = {
            place: np.count_nonzero(other == rows)
            for place, (names, other) in self._recordings.items()
            if names == markers and other.shape == rows.shape
        }
        return max(alike, key=alike.__getitem__, default=None)

    def _animation(self, animation: Animation) -> dict[str, object]:
        weights = animation.morph_weights
        motion = animation.head_motion
        entry, _ = self.blob.steps(weights.T, _WEIGHT_STEP)
        turned = None
        if motion is not None:
            scaled = motion.scales[:, None, None] * motion.rotations
            turned = self.blob.exact(
                np.concatenate([scaled.reshape(-1, 9), motion.translations], axis=1)
            )
        return {
            "kind": "mesh",
            "head": self._head(animation.head),
            "weights": entry,
            "error": None,
            "known": self.blob.small(np.asarray(np.isfinite(weights).all(axis=1), dtype=np.uint8)),
            "motion": turned,
        }

    def _strip(self, strip: Strip) -> dict[str, object]:
        # as the script expects them
        kinds = [self.blob.small(each.T) for each in (strip.missing, strip.filled, strip.repaired)]
        return {
            "stretches": len(strip.missing),
            "kinds": kinds,
            "impulses": [strip.impulse_markers.tolist(), strip.impulse_seconds.tolist()],
            "left_out": strip.left_out,
        }

    def _curves(self, curves: Curves) -> dict[str, object]:
        weights = curves.weights
        entry, _ = self.blob.steps(weights.values.T, _WEIGHT_STEP)
        return {
            "label": curves.label,
            "frames": weights.frames,
            "rate": weights.rate,
            "names": weights.names,
            "weights": entry,
            "known": self.blob.small(np.isfinite(weights.values).T.astype(np.uint8)),
        }

    def _head(self, head: Head) -> int:
        mark = hashlib.sha256()
        for array in (head.vertices, head.morphs, head.faces):
            mark.update(array.tobytes())
        number = self._heads.setdefault(mark.hexdigest(), len(self._heads))
        if number == len(self._head_entries):
            self._head_entries.append(
                {
                    "vertices": self._flat(head.vertices, self.step),
                    "morphs": self._flat(head.morphs, self.step),
                    "faces": self._flat(head.faces.astype(np.float64), 1.0),
                    "count": len(head.vertices),
                }
            )
        return number

    def _flat(self, values: NDArray[np.float64], step: float) -> dict[str, object]:
        return self.blob.steps(values.reshape(-1, 1), step)[0]


def _mean_error(recording: Trajectories, truth: Trajectories) -> float | None:
    """Return the mean distance of the samples that were made, of all where none was."""
    errors = _errors(recording, truth)
    processed = recording.origin > Origin.MEASURED
    known = errors[np.isfinite(errors) & (processed if processed.any() else True)]
    return float(known.mean()) if len(known) else None


def _gaps(playback: Playback) -> list[list[object]]:
    """Return where samples are missing or made by a method: first and last second, and the marker.

    Of too many the longest, in the order of their middles: a reader goes from one to the next. What
    was made, or is missing, throughout a take is not a gap.
    """
    recordings = [panel.shown for panel in playback.panels if isinstance(panel.shown, Trajectories)]
    gaps = {
        (int(start) / shown.rate, int(stop) / shown.rate, shown.markers[marker])
        for shown in recordings
        for runs in (runs_of(~shown.present), runs_of(shown.origin > Origin.MEASURED))
        for marker, start, stop in zip(runs.marker, runs.start, runs.stop, strict=True)
        if stop - start < shown.frames
    }
    most = sorted(gaps, key=lambda gap: (gap[0] - gap[1], gap))[:_MOST_GAPS]
    return [list(gap) for gap in sorted(most, key=lambda gap: (gap[0] + gap[1], gap))]


def _first_second(playback: Playback) -> float:
    """Return when most samples are seen that a method has made, with a known truth if any has.

    Where none was made, the frame in which the heads move most: at rest they show nothing.
    """
    seconds, most = 0.0, (0, 0)
    truth = _truth_of(playback)
    for panel in playback.panels:
        if isinstance(panel.shown, Trajectories):
            estimated = panel.shown.origin > Origin.MEASURED
            known = (
                estimated & np.isfinite(_errors(panel.shown, truth)) if truth else estimated & False
            )
            counts = list(
                zip(known.sum(axis=1).tolist(), estimated.sum(axis=1).tolist(), strict=True)
            )
            frame = max(range(len(counts)), key=lambda frame: counts[frame])
            if counts[frame] > most:
                most, seconds = counts[frame], frame / panel.shown.rate
    return seconds if most[1] else _most_moved(playback)


def _most_moved(playback: Playback) -> float:
    """Return when the weights of the animations are largest, 0 where there are none."""
    seconds, most = 0.0, 0.0
    for panel in playback.panels:
        if isinstance(panel.shown, Animation) and panel.shown.frames:
            # a frame that lacks a weight has no pose
            sizes = np.nan_to_num(np.abs(panel.shown.morph_weights).sum(axis=1))
            frame = int(np.argmax(sizes))
            if sizes[frame] > most:
                most, seconds = float(sizes[frame]), frame / panel.shown.rate
    return seconds


def _truth_of(playback: Playback) -> Trajectories | None:
    known = playback.truth.shown if playback.truth else None
    return known if isinstance(known, Trajectories) else None
