"""Errors of filled gaps, a row per gap."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Annotated

import numpy as np

from nodegraph import Columns, Refusal, RunningForm, Truth, node
from nodegraph_mocap import MarkerFrame, Mask, Table, Trajectories
from nodegraph_mocap.frame_ranges import RunsOfTrue, runs_of
from nodegraph_mocap.suspect import impulses, lengths
from nodegraph_score.hidden_errors import columns, hidden_errors
from nodegraph_score.take import take_of
from nodegraph_tables import BetterEnd, Poses, TableInfo, Take, poses_of, with_info

if TYPE_CHECKING:
    from numpy.typing import NDArray

UNITS = {
    "start": "frame",
    "frames": "frames",
    "rmse": "mm",
    "mae": "mm",
    "coordinate mae": "mm",
    "max": "mm",
    "jump": "mm",
    "velocity": "mm/frame",
    "acceleration": "mm/frame^2",
    "filled": "share",
}
# where lower is not better
BETTER: dict[str, BetterEnd] = {"start": "none", "frames": "none", "filled": "higher"}


_RUNNING = {"gaps": "", **{name: UNITS[name] for name in ("filled", "rmse", "mae", "max", "jump")}}


class _Stream:
    """The means over the gaps so far."""

    def __init__(self, estimate: Trajectories, truth: Trajectories, hidden: Mask) -> None:
        hidden_errors(estimate, truth, hidden)  # that the markers are the same
        self._of_estimate = columns(estimate.markers, truth.markers)
        self._of_hidden = columns(hidden.markers, truth.markers)
        self._markers = truth.markers
        self._before = np.full((len(truth.markers), 3), np.nan)  # errors
        # of each marker's open gap: its frames, those filled, their squares, sum and largest
        self._open = np.zeros((5, len(truth.markers)))
        self._closed = np.zeros((2, 5))

    def push(
        self, estimate: MarkerFrame, truth: MarkerFrame, hidden: NDArray[np.bool_]
    ) -> NDArray[np.float64]:
        hidden = hidden[self._of_hidden]
        unknown = np.flatnonzero(hidden & np.isnan(truth.positions[:, 0]))
        if len(unknown):
            marker = self._markers[unknown[0]]
            raise Refusal(f"marker {marker!r}: hidden, but the truth has no sample")
        error = estimate.positions[self._of_estimate] - truth.positions
        ended = ~hidden & (self._open[0] > 0.0)
        if ended.any():
            jumps = lengths(error[ended] - self._before[ended])
            self._closed += _counts_and_sums(self._open[:, ended], jumps)
            self._open[:, ended] = 0.0
        self._before = error
        distance = lengths(error)
        filled = hidden & ~np.isnan(distance)
        distance = np.where(filled, distance, 0.0)
        self._open[:4] += hidden, filled, distance**2, distance
        self._open[4] = np.maximum(self._open[4], distance)
        gaps = self._open[:, self._open[0] > 0.0]
        counts, sums = self._closed + _counts_and_sums(gaps, np.full(gaps.shape[1], np.nan))
        with np.errstate(invalid="ignore"):
            return np.array([counts[0], *sums / counts])


def _counts_and_sums(gaps: NDArray[np.float64], jumps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how many of (5, G) gaps have each number of `_RUNNING`, and its sum, (2, 5)."""
    frames, filled, squares, total, largest = gaps
    numbers = np.array((filled / frames, np.sqrt(squares / frames), total / frames, largest, jumps))
    numbers[1:, filled < frames] = np.nan
    return np.array((np.count_nonzero(~np.isnan(numbers), axis=1), np.nansum(numbers, axis=1)))


def _means_over_gaps(table: Table) -> list[float]:
    return [len(table), *(table[name].mean() for name in _RUNNING if name != "gaps")]


@node(
    "score.gaps",
    live=RunningForm(
        _Stream,
        numbers=_RUNNING,
        summary=_means_over_gaps,
        streams=("estimate", "truth", "hidden"),
        tolerance=1e-9,  # sums are in the order of frames
    ),
)
def gaps(
    estimate: Trajectories, truth: Truth[Trajectories], hidden: Mask
) -> Annotated[Table, Columns("gap", "marker", *UNITS, "suspect")]:
    """Errors of an estimate in the gaps that a mask has hidden, a row per gap.

    A gap is a run of hidden frames of one marker. With the frames ``a`` to ``b`` of a gap, the
    error ``e[t] = estimate[t] - truth[t]`` of its marker and ``|.|`` the Euclidean length:

    ============== =======================================================================
    gap            0, 1, ... in the order of the first frame, then of the truth's markers
    marker         its name
    start          its first frame, ``a``
    frames         its length, ``b - a + 1``
    rmse           mm, root of the mean of ``|e[t]|^2`` over ``t = a .. b``
    mae            mm, mean of ``|e[t]|`` over ``t = a .. b``
    coordinate mae mm, mean of the absolute values of all coordinates of ``e[t]`` over
                   ``t = a .. b``, which some papers call the mean absolute error
    max            mm, largest ``|e[t]|`` over ``t = a .. b``
    jump           mm, ``|e[b+1] - e[b]|``: by how much the estimate's step from the gap to the
                   next sample differs from the true step; NaN where ``b`` is the last frame
    velocity       mm/frame, root mean square of ``|e[t] - e[t-1]|`` over ``t = a .. b+1``:
                   every step that has an end in the gap
    acceleration   mm/frame^2, root mean square of ``|e[t+1] - 2 e[t] + e[t-1]|`` over
                   ``t = a-1 .. b+1``: every second difference that has a sample in the gap
    filled         share of the gap's samples that the estimate has
    suspect        what is wrong with the truth in the gap, empty where nothing is: the frames of
                   its impulses, with their distances in mm
    ============== =======================================================================

    Differences that reach beyond the take, or to a sample beside the gap that the estimate or
    the truth lacks, are left out; where none is left the value is NaN.

    A gap that is not wholly filled has no error: its seven errors are NaN, whatever samples it
    has, so that a method does not gain by leaving difficult samples missing. How many gaps that
    concerns is in a warning and in the table's notes.

    Where the truth has an impulse in the gap, errors say how far the estimate is from that, and
    the better one is worse. An impulse is a sample off the midpoint of its two neighbours by more
    than 8 times the marker's median, against which both neighbours are off in the other direction;
    one that lasts two frames or more is not recognized. How many gaps have one is in the notes.

    Markers are matched by name. The table knows how long the recording is and over how many frames
    its motion is correlated, so that a comparison can tell what one recording can bear.

    On a stream the means of `filled`, `rmse`, `mae`, `max` and `jump` over the gaps so far are
    kept current, a gap that is still open with the samples that it has so far.

    Parameters
    ----------
    estimate
        T frames of M markers, as a method has filled them.
    truth
        The same frames and markers, present wherever `hidden` is true.
    hidden
        The samples to score, (T, M).

    Returns
    -------
    Table
        As above; empty when nothing is hidden.

    Raises
    ------
    ValueError
        If frame counts or markers differ, or the truth lacks a hidden sample.
    """
    error, mask = hidden_errors(estimate, truth, hidden)
    some = np.flatnonzero(mask.any(axis=1))
    error, jumps = error[some], impulses(truth.positions[:, some]).T
    markers = [truth.markers[column] for column in some]
    has, poses = np.isfinite(error[..., 0]), poses_of(truth.markers, truth.positions, truth.rate)
    found = runs_of(mask[some].T).by_start()
    return _table(found, error, has, jumps, markers, poses, take_of(truth))


def _table(
    gaps: RunsOfTrue,
    error: NDArray[np.float64],
    has: NDArray[np.bool_],
    jumps: NDArray[np.float64],
    markers: list[str],
    poses: Poses,
    take: Take,
) -> Table:
    from pandas import DataFrame

    frames = gaps.stop - gaps.start
    present = np.rint(_means(has.astype(np.float64), gaps, 0, 0) * frames)
    whole = present == frames
    errors = {
        name: np.where(whole, values, np.nan) for name, values in _errors(gaps, error).items()
    }
    suspect = _suspect(jumps, gaps)
    table = DataFrame(
        {
            "gap": np.arange(len(frames)),
            "marker": np.array(markers, dtype=object)[gaps.marker],
            "start": gaps.start,
            "frames": frames,
            **errors,
            "filled": present / frames,
            "suspect": np.array(suspect, dtype=object),
        }
    )
    notes = _notes(whole, int(frames.sum() - present.sum()), int(frames.sum()))
    if any(suspect):
        notes.append(
            f"In {sum(map(bool, suspect))} of {len(suspect)} gaps the truth itself has an impulse "
            "(column 'suspect'): there the errors are not a measure of the estimate."
        )
    title = "Errors in gaps"
    info = TableInfo(title, notes=tuple(notes), units=UNITS, better=BETTER, poses=poses, take=take)
    return with_info(table, info)


def _suspect(jumps: NDArray[np.float64], gaps: RunsOfTrue) -> list[str]:
    """Return the impulses of the truth in each gap; `jumps` is (M, T)."""
    texts = [""] * len(gaps.marker)
    for gap in np.flatnonzero(_maxima(jumps, gaps)):
        first = gaps.start[gap]
        inside = jumps[gaps.marker[gap], first : gaps.stop[gap]]
        texts[gap] = ", ".join(
            f"impulse in frame {first + frame} ({inside[frame]:.1f} mm)"
            for frame in np.flatnonzero(inside)
        )
    return texts


def _errors(gaps: RunsOfTrue, error: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Return each error of each gap; `error` is (M, T, 3)."""
    distance = lengths(error)
    step = _padded(lengths(np.diff(error, axis=1)), before=1, after=0)
    bend = _padded(lengths(np.diff(error, n=2, axis=1)), before=1, after=1)
    return {
        "rmse": np.sqrt(_means(distance**2, gaps, 0, 0)),
        "mae": _means(distance, gaps, 0, 0),
        "coordinate mae": _means(np.abs(error).mean(axis=2), gaps, 0, 0),
        "max": _maxima(distance, gaps),
        "jump": np.append(step, np.full((len(step), 1), np.nan), axis=1)[gaps.marker, gaps.stop],
        "velocity": np.sqrt(_means(step**2, gaps, 0, 1)),
        "acceleration": np.sqrt(_means(bend**2, gaps, 1, 1)),
    }


def _padded(values: NDArray[np.float64], *, before: int, after: int) -> NDArray[np.float64]:
    """Return values of differences at the frames they belong to; NaN where there is none."""
    return np.pad(values, ((0, 0), (before, after)), constant_values=np.nan)


def _means(
    values: NDArray[np.float64], gaps: RunsOfTrue, before: int, after: int
) -> NDArray[np.float64]:
    """Return the mean of the numbers from `before` a gap to `after` it; NaN where none is."""
    samples, starts = _samples(values, gaps, before, after)
    if not len(starts):
        return np.empty(0)
    known = ~np.isnan(samples)
    total = np.add.reduceat(np.where(known, samples, 0.0), starts)
    count = np.add.reduceat(known.astype(np.intp), starts)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _maxima(values: NDArray[np.float64], gaps: RunsOfTrue) -> NDArray[np.float64]:
    samples, starts = _samples(values, gaps, 0, 0)
    return np.maximum.reduceat(samples, starts) if len(starts) else np.empty(0)


def _samples(
    values: NDArray[np.float64], gaps: RunsOfTrue, before: int, after: int
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return the samples of a (M, T) array, gap after gap, and where each gap starts."""
    first = np.maximum(gaps.start - before, 0)
    lengths = np.minimum(gaps.stop + after, values.shape[1]) - first
    starts = np.cumsum(lengths) - lengths
    frame = np.arange(lengths.sum()) + np.repeat(first - starts, lengths)
    return values[np.repeat(gaps.marker, lengths), frame], starts


def _notes(whole: NDArray[np.bool_], missing: int, samples: int) -> list[str]:
    if not len(whole):
        warnings.warn("nothing is hidden: there is no gap to score", stacklevel=4)
        return ["Nothing is hidden: there is no gap to score."]
    if whole.all():
        return []
    note = (
        f"{np.count_nonzero(~whole)} of {len(whole)} gaps are not wholly filled ({missing} of "
        f"{samples} samples missing); their errors are NaN"
    )
    warnings.warn(note, stacklevel=4)
    return [f"{note}."]
