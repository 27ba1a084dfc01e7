"""The fills that estimate all gaps at once from the whole take, and the take as a matrix."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import StateForm, node
from nodegraph_fill.family import CALLER, LEFT, make_fill
from nodegraph_fill.filling import Filling
from nodegraph_fill.gaps import Gaps
from nodegraph_fill.held_out import calibrated
from nodegraph_fill.kept import kept_of, key_of
from nodegraph_fill.meet_ends import are_met, meet_ends
from nodegraph_fill.tuning import is_trying, unless_tuned
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ends = tuple[NDArray[np.float64], NDArray[np.float64]]
    Model = Callable[[Trajectories, Gaps], "Estimate"]


@dataclass(frozen=True)
class Estimate:
    """The estimate of a model for a recording.

    Attributes
    ----------
    positions : (T, M, 3) array of float64
        Millimetres, in the gaps and, without `ends`, at their ends; NaN where there is none.
    sigma : (T, M) array of float64, or None
        Standard deviation in the gaps, mm, to be calibrated; None if the model does not know it.
    ends : pair of (G, 3) arrays of float64, or None
        What the model makes of the sample before and of the sample after each gap, mm, NaN where
        there is none. None: what `positions` has there.
    again : callable or None
        The model as it is to estimate the held-out gaps that `sigma` is calibrated by; None: as
        it estimated these.
    noise : (M,) array of float64, or None
        Variance of the noise of present samples, mm^2. Errors of held-out samples have it, those
        to the place itself have not: `sigma` is calibrated with it and given without. None: 0.
    unsettled : str
        What to warn of, if rounds have not settled.
    """

    positions: NDArray[np.float64]
    sigma: NDArray[np.float64] | None = None
    ends: Ends | None = None
    again: Model | None = None
    noise: NDArray[np.float64] | None = None
    unsettled: str = ""


def whole_take(
    name: str,
    *,
    cite: str | tuple[str, ...],
    adapted: str | Callable[[Mapping[str, Any]], str] = "",
    lookahead: Callable[[Mapping[str, Any]], int | None] | None = None,
    live: StateForm | None = None,
    otherwise: str = "",
) -> Callable[[Callable[..., Estimate]], Callable[..., Trajectories]]:
    """Make a method that estimates all gaps at once a fill.

    The method takes the recording, the gaps to fill, of which there is one at least, and its
    settings, which are keyword-only. It returns an `Estimate`.

    Parameters
    ----------
    name, cite, adapted, lookahead, live
        As for `nodegraph.node`.
    otherwise
        Why it may have no estimate of a sample.
    """

    def decorate(method: Callable[..., Estimate]) -> Callable[..., Trajectories]:
        def fill(filling: Filling, gaps: Gaps, **settings: Any) -> Trajectories:
            if not len(gaps.start):
                return filling.recording
            key = key_of(method, filling, settings)
            model = partial(method, **settings)
            return _filled(filling.recording, gaps, model, key, meets=filling.ends == "met")

        return node(
            name,
            cite=cite,
            adapted=adapted,
            lookahead=lookahead and unless_tuned(lookahead),
            ends=are_met,
            live=live,
            shares=Filling,
        )(make_fill(method, Filling, fill, LEFT, otherwise=otherwise))

    return decorate


@dataclass(frozen=True)
class _Samples:
    """What an estimate has in the gaps.

    Attributes
    ----------
    positions : (S, 3) array of float64
        Millimetres, in the order of `Gaps.samples`.
    sigma : (S,) array of float64, or None
    ends : pair of (G, 3) arrays of float64
        Beside the gaps.
    again, noise, unsettled
        As of the estimate.
    """

    positions: NDArray[np.float64]
    sigma: NDArray[np.float64] | None
    ends: Ends
    again: Model | None
    noise: NDArray[np.float64] | None
    unsettled: str

    @staticmethod
    def of(estimate: Estimate, gaps: Gaps) -> _Samples:
        _, frame, marker, _ = gaps.samples
        return _Samples(
            estimate.positions[frame, marker],
            None if estimate.sigma is None else estimate.sigma[frame, marker],
            estimate.ends or gaps.beside(estimate.positions),
            estimate.again,
            estimate.noise,
            estimate.unsettled,
        )

    def written(self, recording: Trajectories, gaps: Gaps, *, meets: bool) -> Trajectories:
        """Return the recording with these samples, moved to meet the gaps' ends or not."""
        _, frame, marker, _ = gaps.samples
        positions, estimated = recording.positions.copy(), self.positions
        if meets:
            first, last = gaps.beside(recording.positions)
            before, after = self.ends
            estimated = meet_ends(gaps, estimated, first - before, last - after)
        positions[frame, marker] = estimated
        sigma = None
        if self.sigma is not None:
            sigma = recording.sigma
            sigma = np.full(gaps.shape, np.nan) if sigma is None else sigma.copy()
            sigma[frame, marker] = self.sigma
        return recording.with_samples(
            positions, changed=gaps.mask, origin=Origin.FILLED, sigma=sigma
        )


def _filled(
    recording: Trajectories, gaps: Gaps, model: Model, key: Hashable, *, meets: bool
) -> Trajectories:
    """Return the recording filled; `key` says which model it is, with which settings."""
    kept = kept_of(recording)

    def samples(key: Hashable, estimate: Callable[[], Estimate], gaps: Gaps) -> _Samples:
        found: _Samples | None = kept.get(key)
        if found is None:
            found = kept[key] = _Samples.of(estimate(), gaps)
        if found.unsettled and not is_trying():
            warnings.warn(found.unsettled, stacklevel=CALLER + 2)
        return found

    found = samples(key, partial(model, recording, gaps), gaps)
    filled = found.written(recording, gaps, meets=meets)
    if found.sigma is None or is_trying():
        return filled

    def held_out(hidden: Trajectories, held: Gaps) -> Trajectories:
        estimate = partial(found.again or model, hidden, held)
        return samples((key, "held out"), estimate, held).written(hidden, held, meets=meets)

    return calibrated(filled, held_out, recording, gaps, found.noise)


@dataclass(frozen=True)
class TakeMatrix:
    """A recording as a matrix: a row per frame, three columns per marker, without their means.

    Attributes
    ----------
    rows : (T, P) array of float64
        Millimetres, zero where missing. Markers that are never present have no columns.
    missing : (T, P) array of bool
    middle : (P,) array of float64
        The means.
    seen : (M,) array of bool
        Whether each marker has columns.
    """

    rows: NDArray[np.float64]
    missing: NDArray[np.bool_]
    middle: NDArray[np.float64]
    seen: NDArray[np.bool_]

    @staticmethod
    def of(recording: Trajectories) -> TakeMatrix:
        """Return the matrix of a recording that has a present sample."""
        seen = np.asarray(recording.present.any(axis=0))
        rows = recording.positions[:, seen].reshape(recording.frames, -1)
        missing = np.isnan(rows)
        # away from the origin first: a mean of large numbers loses digits
        start = rows[missing.argmin(axis=0), np.arange(rows.shape[1])]
        middle = start + np.nanmean(rows - start, axis=0)
        return TakeMatrix(np.where(missing, 0.0, rows - middle), missing, middle, seen)

    def with_lines(self) -> NDArray[np.float64]:
        """Return the rows with straight lines through the gaps, level at the take's ends."""
        missing, lines, last = self.missing, self.rows.copy(), len(self.rows) - 1
        frames = np.arange(len(self.rows))[:, None]
        before = np.maximum.accumulate(np.where(missing, -1, frames), axis=0)[missing]
        after = np.minimum.accumulate(np.where(missing, last + 1, frames)[::-1], axis=0)[::-1]
        frame, column = np.nonzero(missing)
        first = np.where(before < 0, after[missing], before)
        stop = np.where(after[missing] > last, before, after[missing])
        level = lines[first, column]
        slope = (lines[stop, column] - level) / np.maximum(stop - first, 1)
        lines[missing] = level + slope * (frame - first)
        return lines

    def positions(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return rows like these as positions, (T, M, 3); NaN for a marker without columns."""
        positions = np.full((len(rows), len(self.seen), 3), np.nan)
        positions[:, self.seen] = (rows + self.middle).reshape(len(rows), -1, 3)
        return positions

    def hidden_ends(self, gaps: Gaps) -> HiddenEnds:
        """Return the frames before and after each gap, with what is missing in the gap hidden."""
        end = np.concatenate([gaps.start - 1, gaps.stop])
        inside = np.concatenate([gaps.start, gaps.stop - 1])
        marker = np.concatenate([gaps.marker, gaps.marker])
        there = (end >= 0) & (end < gaps.shape[0])
        end, inside, marker = end[there], inside[there], marker[there]
        return HiddenEnds(end, marker, self.missing[end] | self.missing[inside], there)


@dataclass(frozen=True)
class HiddenEnds:
    """The samples beside gaps, which a model is to estimate as it does the samples in them.

    A model that is shown the sample agrees with it whatever it makes of the gap; the mismatch
    with a model that is not tells how far off it is in the gap.

    Attributes
    ----------
    frame, marker : (E,) arrays of int
        The sample.
    missing : (E, P) array of bool
        Whether it is hidden: it is missing in that frame or in the gap's frame beside it.
    within : (2 G,) array of bool
        Whether each gap's first end, and then each gap's last end, lies within the take.
    """

    frame: NDArray[np.intp]
    marker: NDArray[np.intp]
    missing: NDArray[np.bool_]
    within: NDArray[np.bool_]

    def of_gaps(self, estimates: NDArray[np.float64]) -> Ends:
        """Return the estimates (E, M, 3), each that of its own marker, as `Estimate.ends`."""
        both = np.full((len(self.within), 3), np.nan)
        both[self.within] = estimates[np.arange(len(estimates)), self.marker]
        before, after = np.split(both, 2)
        return before, after
