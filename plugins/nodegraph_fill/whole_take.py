"""What the fills share that estimate all gaps at once: written, counted; the take as a matrix."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_fill.gaps import LONG, NEVER, Gaps, warn_left
from nodegraph_fill.held_out import calibrated
from nodegraph_fill.meet_ends import Ends, check_ends, meet_ends
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Estimate:
    """What a model makes of a recording.

    Attributes
    ----------
    positions : (T, M, 3) array of float64
        Millimetres, in the gaps and, without `ends`, at their ends; NaN where there is none.
    sigma : (T, M) array of float64, or None
        Standard deviation in the gaps, mm, to be calibrated; None if the model does not know it.
    ends : two (G, 3) arrays of float64, or None
        What the model makes of the sample before and of the sample after each gap, mm, if that
        is not what `positions` has there; NaN where there is none.
    """

    positions: NDArray[np.float64]
    sigma: NDArray[np.float64] | None = None
    ends: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None


def fill_from(
    recording: Trajectories,
    max_gap: int | None,
    model: Callable[[Trajectories, Gaps], Estimate],
    *,
    ends: Ends,
    otherwise: str = "",
) -> Trajectories:
    """Fill gaps with what a model estimates, and warn of those left; called by a node.

    Parameters
    ----------
    recording
        Trajectories with gaps.
    max_gap
        Longer gaps stay missing.
    model
        Takes the recording and the gaps to fill; not called when there are none.
    ends
        The setting; for ``met`` the model estimates the samples beside the gaps, too.
    otherwise
        Why the model may have no estimate.
    """

    def fill(recording: Trajectories, gaps: Gaps) -> Trajectories:
        return _written(recording, gaps, model(recording, gaps), ends)

    check_ends(ends)
    gaps = Gaps.of(recording)
    long = gaps.longer_than(max_gap) & ~gaps.never
    wanted = gaps.subset(~(long | gaps.never))
    filled = recording
    if len(wanted.start):
        filled = calibrated(fill, recording, wanted)
    reasons = [(gaps.subset(gaps.never), NEVER), (gaps.subset(long), LONG)]
    warn_left(filled, reasons, otherwise, stacklevel=3)
    return filled


def _written(recording: Trajectories, gaps: Gaps, estimate: Estimate, ends: Ends) -> Trajectories:
    _, frame, marker, _ = gaps.samples
    estimated = estimate.positions[frame, marker]
    positions = recording.positions.copy()
    if ends == "met":
        before, after = estimate.ends or gaps.beside(estimate.positions)
        first, last = gaps.beside(recording.positions)
        estimated = meet_ends(gaps, estimated, first - before, last - after)
    positions[frame, marker] = estimated
    sigma = None
    if estimate.sigma is not None:
        sigma = recording.sigma
        sigma = np.full(gaps.shape, np.nan) if sigma is None else sigma.copy()
        sigma[frame, marker] = estimate.sigma[frame, marker]
    return recording.with_samples(positions, changed=gaps.mask, origin=Origin.FILLED, sigma=sigma)


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
        Which markers have columns.
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
        What is not shown: what is missing in that frame or in the gap's frame beside it.
    within : (2 G,) array of bool
        Which of the gaps' first ends, and then of their last ends, lie within the take.
    """

    frame: NDArray[np.intp]
    marker: NDArray[np.intp]
    missing: NDArray[np.bool_]
    within: NDArray[np.bool_]

    def of_gaps(
        self, estimates: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the estimates (E, M, 3), each that of its own marker, as `Estimate.ends`."""
        both = np.full((len(self.within), 3), np.nan)
        both[self.within] = estimates[np.arange(len(estimates)), self.marker]
        before, after = np.split(both, 2)
        return before, after
