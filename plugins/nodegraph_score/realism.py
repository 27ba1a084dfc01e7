"""How much recordings move as people do: measures beside what they are for people."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np

from nodegraph import Across, Columns, Refusal, Truth, node
from nodegraph_mocap import Figure, Table, Trajectories
from nodegraph_mocap.spread import far_apart
from nodegraph_tables import BetterEnd, TableInfo, with_info
from nodegraph_tables.axes import SMALL, plain
from nodegraph_tables.style import BEST, LINE, QUIET, figure_text

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.float64]

_MARKERS = 16
_FEWEST = 6
_SHORTEST, _SHORT = 0.5, 5.0
"""Seconds below which a recording is not measured, or its measures rest on a few movements."""
_SEGMENT = 4.0
"""Seconds, of the spectrum from which the slope is taken."""
_LOW_PASS = 10.0
"""Hz, of the velocity."""
_BAND = (1.0, 8.0)
"""Hz, of the slope."""
_FAST = 3.0
"""Hz."""
_PART, _PARTS = 0.5, 5
"""Seconds that are predicted at once, and every how many of them are."""
_PENALTY = 1e-3
_OUTSIDE = 1.0
"""Widths of a band to each side, beyond which dots stand at the edge of the figure."""


@dataclass(frozen=True)
class _Measure:
    """A measure, and from where to where it goes for people."""

    unit: str
    low: float
    high: float
    title: str


MEASURES = {
    "together": _Measure("", 0.02, 0.62, "correlation of a neighbour's velocity"),
    "components": _Measure("share", 0.21, 0.35, "components for 99.5 %"),
    "fast": _Measure("share", 0.0, 0.03, "power above 3 Hz"),
    "slope": _Measure("", -4.8, -2.8, "slope of the spectrum"),
    "speed": _Measure("mm/s", 31.0, 89.0, "speed, 99.9th percentile"),
    "kurtosis": _Measure("", 4.4, 12.3, "kurtosis of velocity"),
    "ridge": _Measure("mm", 0.4, 0.7, "error of ridge"),
    "apart": _Measure("share", 0.16, 0.19, "the same, of the movement"),
}
UNITS = {name: measure.unit for name, measure in MEASURES.items() if measure.unit}
BETTER: dict[str, BetterEnd] = dict.fromkeys(MEASURES, "none")
_NOTES = (
    "The rows of people: the lowest and the highest of four takes of one actor (AnimFace, "
    "Carretero 2019) and two people of another laboratory; ridge and apart of two takes of the "
    "first alone. The spectrum of that actor's jaw, slope -10, is left out.",
    "Kurtosis is 0 for a normal distribution, more for movement in bursts with rests between them.",
)


class Realism(NamedTuple):
    """The measures of each recording, and a picture of them."""

    table: Annotated[Table, Columns("recording", *MEASURES)]
    figure: Figure


@node("score.realism")
def realism(recordings: Truth[Across[Trajectories]]) -> Realism:
    """Measure how recordings move, beside how people do, a row per recording.

    Of 16 markers spread over the face, without its head motion (each frame is moved rigidly onto
    the mean shape), with x the position of a marker and v its velocity after a Butterworth
    low-pass of second order at 10 Hz, forwards and backwards:

    ========== ===========================================================================
    together   mean over markers of ``sum v . w / sqrt(sum |v|^2 sum |w|^2)``, with w the
               velocity of the nearest of the others
    components share of the coordinates' principal components that make 99.5 % of the variance
    fast       share of the power of x, its mean taken out, above 3 Hz
    slope      of the logarithm of that power over the logarithm of the frequency, 1 to 8 Hz
    speed      mm/s, 99.9th percentile of ``|v|`` over markers and frames
    kurtosis   mean over coordinates of ``mean(u^4) / mean(u^2)^2 - 3``, u a coordinate of v less
               its mean
    ridge      mm, mean over markers of the root mean square error of a ridge regression on the
               others, of every fifth half second from the rest of the take
    apart      the same over the root mean square of the marker's movement
    ========== ===========================================================================

    The last two rows are the lowest and the highest that people have. What is outside them is not
    wrong, but nothing that six takes of three people show; what is inside may still be unlike
    people in another respect. Missing samples between others are on a line between these.
    Impulses are faster than any face: measure a recording without them.

    Parameters
    ----------
    recordings
        Any recordings, with or without gaps; of made faces the truth or what was measured of it.

    Raises
    ------
    Refusal
        If no recording has 0.5 s at 20 Hz or more and six markers that are ever seen; where some
        have, the others are left out with a warning.
    """
    from pandas import DataFrame

    rows: list[tuple[object, ...]] = []
    reasons = []
    for name, recording in zip(recordings.names(), recordings.values(), strict=True):
        reason = _reason(recording)
        if reason:
            reasons.append(f"{name}: {reason}" if name else reason)
        else:
            rows.append((name or "recording", *_measured(recording, name)))
    if not rows:
        raise Refusal("; ".join(reasons))
    for reason in reasons:
        warnings.warn(f"not measured: {reason}", stacklevel=2)
    for end in ("low", "high"):
        rows.append((f"people, {end}est", *(getattr(each, end) for each in MEASURES.values())))
    table = DataFrame.from_records(rows, columns=["recording", *MEASURES])
    info = TableInfo("How faces move", notes=_NOTES, units=UNITS, better=BETTER)
    return Realism(with_info(table, info), _draw(table))


def _measured(recording: Trajectories, name: str) -> tuple[float, ...]:
    places = _still(_complete(recording, name))
    kept = places[:, np.sort(far_apart(places.mean(axis=0), _MARKERS))]
    velocity = _velocity(kept, recording.rate)
    moved = kept - kept.mean(axis=0)
    flat = moved.reshape(len(moved), -1)
    fast, slope = _spectrum(flat, recording.rate)
    values = np.linalg.svd(flat, compute_uv=False) ** 2
    explained = np.cumsum(values) / max(float(values.sum()), 1e-300)
    components = (1 + int(np.searchsorted(explained, 0.995))) / flat.shape[1]
    speed = float(np.percentile(np.linalg.norm(velocity, axis=2), 99.9))
    around = velocity - velocity.mean(axis=0)
    squares = (around**2).mean(axis=0)
    kurtosis = float(((around**4).mean(axis=0) / np.maximum(squares, 1e-300) ** 2 - 3.0).mean())
    error = _ridge(moved, recording.rate)
    extent = np.sqrt((moved**2).sum(axis=2).mean(axis=0))
    apart = float((error / np.maximum(extent, 1e-300)).mean())
    together = _together(velocity, kept.mean(axis=0))
    return together, components, fast, slope, speed, kurtosis, float(error.mean()), apart


def _reason(recording: Trajectories) -> str:
    """Return why a recording cannot be measured; empty if it can."""
    if recording.frames < _SHORTEST * recording.rate or recording.rate < 2 * _LOW_PASS:
        return (
            f"needs {_SHORTEST:g} s at {2 * _LOW_PASS:g} Hz or more; got {recording.frames} "
            f"frames at {recording.rate:g} Hz"
        )
    seen = np.count_nonzero(recording.present.any(axis=0))
    return f"needs {_FEWEST} markers; {seen} are ever seen" if seen < _FEWEST else ""


def _complete(recording: Trajectories, name: str) -> Numbers:
    """Return (T, M, 3) mm of the markers that are seen, gaps bridged by lines."""
    present = recording.present
    seen = np.flatnonzero(present.any(axis=0))
    missing = 1.0 - present[:, seen].mean()
    of = f"{name}: " if name else ""
    if recording.frames < _SHORT * recording.rate:
        warnings.warn(
            f"{of}{recording.frames / recording.rate:.3g} s hold few movements: with less than "
            f"{_SHORT:g} s the measures are chance",
            stacklevel=4,
        )
    if missing:
        warnings.warn(f"{of}{100 * missing:.3g} % of the samples are bridged", stacklevel=4)
    places, frames = recording.positions[:, seen].copy(), np.arange(recording.frames)
    for column, marker in enumerate(seen):
        there = np.flatnonzero(present[:, marker])
        for axis in range(3):
            places[:, column, axis] = np.interp(frames, there, places[there, column, axis])
    return places


def _still(places: Numbers) -> Numbers:
    """Return each frame moved rigidly onto the mean shape."""
    centred = places - places.mean(axis=1, keepdims=True)
    mean = centred[len(centred) // 2]
    for _ in range(3):
        left, _, right = np.linalg.svd(np.einsum("tmi,mj->tij", centred, mean))
        left[:, :, 2] *= np.sign(np.linalg.det(left @ right))[:, None]
        moved = centred @ (left @ right)
        mean = moved.mean(axis=0)
    return np.asarray(moved)


def _velocity(places: Numbers, rate: float) -> Numbers:
    from scipy.signal import butter, sosfiltfilt

    if rate > 2 * _LOW_PASS:
        sections = butter(2, _LOW_PASS, fs=rate, output="sos")
        places = sosfiltfilt(sections, places, axis=0)
    return np.asarray(np.diff(places, axis=0) * rate)


def _together(velocity: Numbers, shape: Numbers) -> float:
    apart = np.linalg.norm(shape[:, None] - shape, axis=2)
    np.fill_diagonal(apart, np.inf)
    near = velocity[:, apart.argmin(axis=1)]
    power = (velocity**2).sum(axis=(0, 2)) * (near**2).sum(axis=(0, 2))
    return float(((velocity * near).sum(axis=(0, 2)) / np.sqrt(np.maximum(power, 1e-300))).mean())


def _spectrum(flat: Numbers, rate: float) -> tuple[float, float]:
    """Return the share of the power above 3 Hz, and the slope from 1 to 8 Hz."""
    from scipy.signal import welch

    power = (np.abs(np.fft.rfft(flat, axis=0)) ** 2).sum(axis=1)
    frequencies = np.fft.rfftfreq(len(flat), 1.0 / rate)
    fast = float(power[frequencies > _FAST].sum() / max(float(power[1:].sum()), 1e-300))
    length = min(len(flat), round(_SEGMENT * rate))
    frequencies, densities = welch(flat, fs=rate, nperseg=length, axis=0)
    band = (frequencies >= _BAND[0]) & (frequencies <= _BAND[1])
    density = densities[band].sum(axis=1)
    if not (density > 0.0).all():
        return fast, math.nan
    return fast, float(np.polyfit(np.log(frequencies[band]), np.log(density), 1)[0])


def _ridge(moved: Numbers, rate: float) -> Numbers:
    """Return (M,) mm by which each marker is off what the others say of it."""
    frames, markers, _ = moved.shape
    length = min(_PART * rate, frames / _PARTS)
    part = (np.arange(frames) / length).astype(np.intp) % _PARTS
    flat, squares = moved.reshape(frames, -1), np.zeros((frames, markers))
    for held in np.unique(part):
        known, hidden = flat[part != held], flat[part == held]
        products = known.T @ known
        for marker in range(markers):
            others = np.arange(3 * markers) // 3 != marker
            normal = products[others][:, others]
            # where nothing moves, nothing is predicted
            normal.flat[:: len(normal) + 1] += max(_PENALTY * normal.trace() / len(normal), 1e-300)
            weights = np.linalg.solve(normal, products[others][:, ~others])
            error = hidden[:, others] @ weights - hidden[:, ~others]
            squares[part == held, marker] = (error**2).sum(axis=1)
    return np.asarray(np.sqrt(squares.mean(axis=0)))


def _draw(table: Table) -> Figure:
    """Return the figure: a line per measure, on which people are a band and recordings dots."""
    from matplotlib.figure import Figure as Drawing

    figure = Drawing(figsize=(6.4, 0.45 * len(MEASURES) + 0.5))
    axis = figure.add_axes((0.36, 0.1, 0.62, 0.86))
    for row, (name, measure) in enumerate(MEASURES.items()):
        width = measure.high - measure.low
        axis.barh(row, 1.0, 0.5, color=LINE)
        places = (table[name].to_numpy(dtype=np.float64)[:-2] - measure.low) / width
        shown = np.clip(places, -_OUTSIDE, 1.0 + _OUTSIDE)
        inside = (places >= 0.0) & (places <= 1.0)
        axis.plot(shown[inside], np.full(inside.sum(), row), "o", color=BEST, markersize=4)
        axis.plot(
            shown[~inside], np.full((~inside).sum(), row), "o", mfc="white", mec=BEST, markersize=4
        )
        for place, value in ((0.0, measure.low), (1.0, measure.high)):
            end = "right" if place == 0.0 else "left"
            axis.text(place, row - 0.3, f"{value:g}", fontsize=SMALL, color=QUIET, ha=end)
    titles = [figure_text(each.title) for each in MEASURES.values()]
    axis.set_yticks(range(len(titles)), titles, fontsize=SMALL)
    axis.set(xlim=(-_OUTSIDE - 0.05, 1.05 + _OUTSIDE), ylim=(len(titles) - 0.4, -0.6), xticks=[])
    axis.set_xlabel("bands: people; filled: within, hollow: outside", fontsize=SMALL, color=QUIET)
    plain(axis, grid="x")
    return figure
