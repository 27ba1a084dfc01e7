"""The effect of smoothing on the movement itself, a row per marker."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

import numpy as np

from nodegraph import Columns, Truth, node
from nodegraph_mocap import Table, Trajectories
from nodegraph_mocap.frame_ranges import runs_of
from nodegraph_mocap.truth import check_same_samples
from nodegraph_score.notes import with_notes
from nodegraph_tables import BetterEnd, TableInfo

if TYPE_CHECKING:
    from numpy.typing import NDArray

UNITS = {"samples": "frames", "missing": "frames", "rmse": "mm", "lag": "frames", "kept": "share"}
BETTER: dict[str, BetterEnd] = {"samples": "none", "lag": "none", "kept": "none"}
BAND = 6.0
"""Hz: most of what a face does is slower."""

FARTHEST = 0.5
"""Seconds by which an estimate may be late or early."""


@node("score.smoothness")
def smoothness(
    estimate: Trajectories, truth: Truth[Trajectories]
) -> Annotated[Table, Columns("marker", *UNITS)]:
    """Error, lag and movement kept of a smoothed recording, a row per marker.

    Over the frames in which both have the marker, with e the estimate and x the truth:

    ======= ============================================================================
    marker  its name
    samples how many frames are compared
    missing how many samples of the truth the estimate lacks
    rmse    mm, root of the mean of ``|e[t] - x[t]|^2``
    lag     frames by which the estimate comes late (early: below 0), to a fraction of one
    kept    share of the power below 6 Hz that is left: 1 is all of it, less is movement
            smoothed away, more is noise
    ======= ============================================================================

    The lag is the k for which ``mean(|e[t + k] - x[t]|^2)``, over the frames t for which both are
    known, is least: the bottom of the parabola through the least of them and the two beside it.
    (That is where their correlation is highest, with what each run's ends do to it taken into
    account.) It is looked for up to half a second either way and at most a third of the take.
    Noise that is left blurs it: by about ``rmse / sqrt(sum(|x[t+1] - x[t]|^2))`` frames, much
    where a marker hardly moves.

    The power is the sum of the squared coefficients of the discrete cosine transform (DCT-II)
    of frequencies over 0 and below 6 Hz, over the three coordinates and over every run of
    frames that both have.

    Where nothing can be compared, or the marker or its estimate stands still, the values that
    need movement are NaN, counted in a warning and in the table's notes.

    Parameters
    ----------
    estimate
        T frames, smoothed.
    truth
        The same frames and markers without noise.

    Returns
    -------
    Table
        As above, in the order of the truth's markers.

    Raises
    ------
    ValueError
        If frame counts, rates or markers differ.
    """
    from pandas import DataFrame

    check_same_samples("estimate", estimate, "truth", truth)
    if estimate.rate != truth.rate:
        raise ValueError(f"estimate has {estimate.rate:g} Hz, the truth has {truth.rate:g} Hz")
    estimated, true = estimate.keep(truth.markers).positions, truth.positions
    both = np.isfinite(estimated[..., 0]) & np.isfinite(true[..., 0])
    samples = np.count_nonzero(both, axis=0)
    values = {
        "samples": samples,
        "missing": np.count_nonzero(truth.present, axis=0) - samples,
        "rmse": _errors(estimated, true, both),
        "lag": _lags(estimated, true, both, truth.rate),
        "kept": _kept(estimated, true, both, truth.rate),
    }
    table = DataFrame({"marker": np.array(truth.markers, dtype=object), **values})
    notes = list(_notes(table))
    info = TableInfo("Smoothness", units=UNITS, better=BETTER)
    return with_notes(table, notes, info, of=truth)


def _errors(
    estimated: NDArray[np.float64], true: NDArray[np.float64], both: NDArray[np.bool_]
) -> NDArray[np.float64]:
    squared = np.where(both[..., None], estimated - true, 0.0) ** 2
    return np.sqrt(_divided(squared.sum(axis=(0, 2)), np.count_nonzero(both, axis=0)))


def _lags(
    estimated: NDArray[np.float64], true: NDArray[np.float64], both: NDArray[np.bool_], rate: float
) -> NDArray[np.float64]:
    farthest = min(max(round(FARTHEST * rate), 1), (len(estimated) - 1) // 3)
    if farthest < 1:
        return np.full(estimated.shape[1], np.nan)
    apart = _distances(estimated, true, both, farthest)
    moves = [
        np.any(np.diff(positions, axis=0) != 0.0, axis=2, where=(both[1:] & both[:-1])[..., None])
        for positions in (estimated, true)
    ]
    return np.where(moves[0].any(axis=0) & moves[1].any(axis=0), _bottoms(apart, farthest), np.nan)


def _distances(
    estimated: NDArray[np.float64],
    true: NDArray[np.float64],
    both: NDArray[np.bool_],
    farthest: int,
) -> NDArray[np.float64]:
    """Return the mean squared distance for each shift, (2 farthest + 1, M); NaN over few frames."""
    there = both.astype(np.float64)
    middle = _divided(np.where(both[..., None], true, 0.0).sum(axis=0), there.sum(axis=0)[:, None])
    late, early = (
        np.where(both[..., None], positions - middle, 0.0) for positions in (estimated, true)
    )
    squares = _correlations(np.sum(late**2, axis=2), there, farthest)
    squares += _correlations(there, np.sum(early**2, axis=2), farthest)
    frames = np.rint(_correlations(there, there, farthest))
    enough = frames > 0.5 * frames[farthest]
    summed = squares - 2.0 * _correlations(late, early, farthest).sum(axis=2)
    return _divided(summed, np.where(enough, frames, 0.0))


def _correlations(
    late: NDArray[np.float64], early: NDArray[np.float64], farthest: int
) -> NDArray[np.float64]:
    """Return ``sum(late[t + k] early[t])`` for k from ``-farthest`` on, (2 farthest + 1, ...)."""
    from scipy.fft import irfft, next_fast_len, rfft

    size = next_fast_len(len(late) + farthest, real=True)
    product = rfft(late, size, axis=0) * np.conj(rfft(early, size, axis=0))
    every = irfft(product, size, axis=0)
    return np.concatenate([every[size - farthest :], every[: farthest + 1]])


def _bottoms(apart: NDArray[np.float64], farthest: int) -> NDArray[np.float64]:
    """Return where parabolas through the least of each column have their bottom."""
    filled = np.where(np.isnan(apart), np.inf, apart)
    least = filled.argmin(axis=0)
    column = np.arange(apart.shape[1])
    inside = np.clip(least, 1, 2 * farthest - 1)
    before, bottom, after = (apart[inside + step, column] for step in (-1, 0, 1))
    shift = _divided(0.5 * (before - after), before - 2.0 * bottom + after)
    known = np.isfinite(filled.min(axis=0))
    between = (inside == least) & np.isfinite(shift)
    return np.where(known, least - farthest + np.where(between, shift, 0.0), np.nan)


def _kept(
    estimated: NDArray[np.float64], true: NDArray[np.float64], both: NDArray[np.bool_], rate: float
) -> NDArray[np.float64]:
    power = np.zeros((2, estimated.shape[1]))
    for column, start, stop in zip(
        *(column_runs.tolist() for column_runs in runs_of(both)), strict=True
    ):
        for row, positions in enumerate((estimated, true)):
            power[row, column] += _power(positions[start:stop, column], rate)
    return _divided(power[0], power[1])


def _power(run: NDArray[np.float64], rate: float) -> float:
    from scipy.fft import dct

    count = int(np.ceil(2.0 * BAND * len(run) / rate))
    slow = dct(run - run[0], axis=0, norm="ortho")[1:count]
    return float(np.sum(slow**2))


def _divided(above: NDArray[np.float64], below: NDArray[np.float64]) -> NDArray[np.float64]:
    some = below != 0.0
    return np.where(some, above / np.where(some, below, 1.0), np.nan)


def _notes(table: Table) -> Iterator[str]:
    missing, rows = int(table["missing"].sum()), len(table)
    if missing:
        yield f"{missing} samples of the truth are missing in the estimate and not compared"
    for column, what in (("rmse", "error"), ("lag", "lag"), ("kept", "share of power kept")):
        unknown = int(table[column].isna().sum())
        if unknown:
            yield f"{unknown} of {rows} markers have no {what}"
