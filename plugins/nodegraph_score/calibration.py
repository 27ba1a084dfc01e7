"""Whether the standard deviations that an estimate states are those of its errors."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np

from nodegraph import Columns, Truth, node
from nodegraph_mocap import Figure, Mask, Table, Trajectories
from nodegraph_mocap.frame_ranges import runs_of
from nodegraph_score.hidden_errors import columns, hidden_errors
from nodegraph_tables import BetterEnd, TableInfo, with_info
from nodegraph_tables.axes import SMALL, name_lines, plain
from nodegraph_tables.style import BEST, QUIET, REST

if TYPE_CHECKING:
    from numpy.typing import NDArray


_SIDE = 3.6

# of a standard normal distribution: how far from 0 such a share of it lies
_REACH = {
    "50 %": 0.6744897501960817,
    "80 %": 1.2815515655446004,
    "90 %": 1.6448536269514722,
    "95 %": 1.959963984540054,
}
_LENGTHS = {
    "1 to 5": (1, 5), "6 to 15": (6, 15), "16 to 45": (16, 45), "over 45": (46, np.inf),
}  # fmt: skip
_ALL = "all"
_MEANING = (
    "50 % to 95 %: share of errors within that interval of a normal distribution; best is the "
    "level itself. Fills calibrate sigma at 95 %: as errors have heavier tails, the lower levels "
    "are conservative (too wide)."
)
UNITS = {"samples": "samples", **dict.fromkeys(_REACH, "share"), "width": "mm"}
BETTER: dict[str, BetterEnd] = dict.fromkeys(UNITS, "none")


class Calibration(NamedTuple):
    """The number of errors that lie within the stated intervals."""

    table: Annotated[Table, Columns("frames", *UNITS)]
    figure: Figure


@node("score.calibration")
def calibration(estimate: Trajectories, truth: Truth[Trajectories], hidden: Mask) -> Calibration:
    """Share of errors within the intervals that an estimate's sigma states, by length of gap.

    With the error ``e = estimate - truth`` of one coordinate of a hidden sample and the `sigma`
    that the estimate states for it, the error lies within the interval of level p if
    ``|e| <= z sigma``, with ``z = Phi^-1((1 + p) / 2)`` of the standard normal distribution. Of an
    estimate that is calibrated, a share p of the errors does. All three coordinates of a sample
    count, and all samples alike; a gap's are not independent of one another. Errors with heavier
    tails than a normal distribution cannot be calibrated at all levels at once: a sigma that is
    right at 95 %, as that of `fill.subspace_kalman`, is conservative below, its 50 % interval
    too wide.

    ======= ===============================================================================
    frames  length of the gaps: 1 to 5, 6 to 15, 16 to 45, over 45, as far as there are such;
            all. A gap is a run of hidden frames of one marker
    samples hidden samples that the estimate has, with a sigma
    50 %    share of the errors within the interval of that level; so 80 %, 90 % and 95 %.
            Best is the level itself: more means too wide intervals, less too narrow ones
    width   mm, mean width of the interval of 95 %
    ======= ===============================================================================

    Hidden samples that the estimate lacks, or has without a sigma, are left out; they are counted
    in a warning and in the table's notes. Where none is left, shares and width are NaN. Markers
    are matched by name.

    Parameters
    ----------
    estimate
        T frames of M markers, as a method has filled them, with `sigma`.
    truth
        The same frames and markers, present wherever `hidden` is true.
    hidden
        The samples to judge by, (T, M).

    Returns
    -------
    table
        As above.
    figure
        The share of errors within the interval against its level, a line per row.

    Raises
    ------
    ValueError
        If frame counts or markers differ, or the truth lacks a hidden sample.
    """
    error, mask = hidden_errors(estimate, truth, hidden)
    known = np.full(estimate.origin.shape, np.nan) if estimate.sigma is None else estimate.sigma
    sigma = known[:, columns(estimate.markers, truth.markers)].T
    judged = mask & np.isfinite(error[..., 0]) & np.isfinite(sigma)
    table = _table(np.abs(error), sigma, judged, _lengths(mask), _notes(judged, mask))
    return Calibration(table, _draw(table))


def _table(
    error: NDArray[np.float64],
    sigma: NDArray[np.float64],
    judged: NDArray[np.bool_],
    length: NDArray[np.intp],
    notes: tuple[str, ...],
) -> Table:
    from pandas import DataFrame

    rows = {
        name: judged & (length >= least) & (length <= most)
        for name, (least, most) in _LENGTHS.items()
    }
    rows = {name: which for name, which in rows.items() if which.any()} | {_ALL: judged}
    records = []
    for name, which in rows.items():
        off, deviation = error[which], sigma[which]
        within = {
            level: _mean(off <= reach * deviation[:, None]) for level, reach in _REACH.items()
        }
        width = 2.0 * _REACH["95 %"] * _mean(deviation)
        records.append({"frames": name, "samples": len(off), **within, "width": width})
    table = DataFrame.from_records(records, columns=["frames", *UNITS])
    info = TableInfo(
        title="Errors within the stated intervals",
        notes=(_MEANING, *notes),
        units=UNITS,
        better=BETTER,
    )
    return with_info(table, info)


def _lengths(mask: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Return the length of the gap that each hidden sample lies in, (M, T); elsewhere 0."""
    lengths = np.zeros(mask.shape, np.intp)
    for marker, start, stop in zip(*runs_of(mask.T), strict=True):
        lengths[marker, start:stop] = stop - start
    return lengths


def _mean(values: NDArray[np.float64] | NDArray[np.bool_]) -> float:
    return float(values.mean()) if values.size else np.nan


def _notes(judged: NDArray[np.bool_], mask: NDArray[np.bool_]) -> tuple[str, ...]:
    hidden, left = np.count_nonzero(mask), np.count_nonzero(mask & ~judged)
    if not left:
        return ()
    note = f"{left} of {hidden} hidden samples are missing or have no sigma; they are left out"
    warnings.warn(note, stacklevel=3)
    return (f"{note}.",)


def _draw(table: Table) -> Figure:
    """Return the figure: a line per row of the table, the last of all gaps, and the diagonal."""
    from matplotlib.figure import Figure as Drawing

    levels = {level: float(level.removesuffix(" %")) / 100.0 for level in _REACH}
    figure = Drawing(figsize=(_SIDE, _SIDE))
    axis = figure.add_axes((0.14, 0.13, 0.84, 0.84))
    axis.set(xlim=(0.4, max(levels.values())), ylim=(0.0, 1.0))
    axis.plot([0.0, 1.0], [0.0, 1.0], color=REST, linewidth=0.9, linestyle=":")
    *_, whole = table["frames"]
    names, ends, colours = ["as stated"], [max(levels.values())], [REST]
    for _, row in table.iterrows():
        name = row["frames"]
        colour = BEST if name == whole else REST
        shares = [row[level] for level in levels]
        label = "all gaps" if name == whole else f"{name} frames"
        axis.plot(list(levels.values()), shares, ".-", color=colour, label=label, clip_on=False)
        if math.isfinite(shares[-1]):
            names.append(label)
            ends.append(shares[-1])
            colours.append(colour)
    axis.text(0.42, 0.97, "conservative", fontsize=SMALL, color=QUIET, va="top")
    axis.text(axis.get_xlim()[1] - 0.02, 0.4, "too narrow", fontsize=SMALL, color=QUIET, ha="right")
    axis.set_xlabel("level of the normal interval", fontsize=SMALL, color=QUIET)
    axis.set_ylabel("share of errors within it", fontsize=SMALL, color=QUIET)
    plain(axis, grid="both")
    name_lines(axis, names, ends, colours, _SIDE * axis.get_position().height)
    return figure
