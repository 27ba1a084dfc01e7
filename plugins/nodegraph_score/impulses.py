"""Impulses found and good samples changed, a row per take or per marker."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, get_args

import numpy as np

from nodegraph import Columns, Truth, node
from nodegraph_mocap import Mask, Origin, Table, Trajectories
from nodegraph_mocap.truth import check_same_samples
from nodegraph_score.notes import with_notes
from nodegraph_tables import BetterEnd, TableInfo

if TYPE_CHECKING:
    from numpy.typing import NDArray

Per = Literal["take", "marker"]

UNITS = {
    "samples": "samples",
    "hits": "samples",
    "found": "samples",
    "false positives": "samples",
    "rmse": "mm",
    "error": "mm",
    "wrong": "of 100,000",
    "missed": "share",
    "false positive rate": "share",
    "change": "mm",
    "recall": "share",
    "precision": "share",
}
BETTER: dict[str, BetterEnd] = {
    "samples": "none",
    "hits": "none",
    "found": "higher",
    "recall": "higher",
    "precision": "higher",
}


@node("score.impulses")
def impulses(
    estimate: Trajectories,
    truth: Truth[Trajectories],
    impulses: Truth[Mask],
    *,
    per: Per = "take",
) -> Annotated[Table, Columns("marker", *UNITS)]:
    """Impulses that a method has found, and good samples that it took for some.

    A sample is *hit* where the mask says so, else *clean*; it is *repaired* where the estimate
    has it with that origin. With e the distance from the estimate's sample to the true one:

    =================== ================================================================
    marker              its name; ``all`` where a row is the take
    samples             how many are judged
    hits                how many of them are hit
    found               how many hits are repaired
    false positives     how many clean samples are repaired
    rmse                mm, root of the mean of ``e^2`` over all samples
    error               mm, mean of e over the hits, found or not
    wrong               hits not found and clean samples repaired, of 100,000 samples
    missed              share of the hits that are not found
    false positive rate share of the clean samples that are repaired
    change              mm, mean of e over the false positives: by how much good samples
                        were moved, where the truth is the recording before the impulses
    recall              share of the hits that are found, ``1 - missed``
    precision           share of the repaired samples that are hits
    =================== ================================================================

    Of rmse, error, wrong, missed, false positive rate and change less is better. A share or mean of
    nothing is NaN: error, missed and recall without a hit, precision without a repaired sample,
    change without a false positive. A sample is judged where the truth and the estimate have
    it, unless it was called repaired in the truth already, where it is not known what repaired it.
    Rows without a hit, and samples left out, are counted in a warning and in the table's notes.

    Markers are matched by name.

    Parameters
    ----------
    estimate
        T frames of M markers, as a method has repaired them.
    truth
        The same frames and markers without impulses.
    impulses
        The samples that were hit, (T, M).
    per
        The unit of a row: the take, or a marker.

    Raises
    ------
    ValueError
        If frame counts or markers differ, or `per` is not one of its choices.
    """
    if per not in get_args(Per):
        raise ValueError(f"per must be take or marker, got {per!r}")
    check_same_samples("estimate", estimate, "truth", truth)
    check_same_samples("impulses", impulses, "truth", truth)
    estimate = estimate.keep(truth.markers)
    hit = impulses.hidden[:, [impulses.markers.index(name) for name in truth.markers]]
    both = estimate.present & truth.present
    judged = both & (truth.origin != Origin.REPAIRED)
    distance = np.linalg.norm(estimate.positions - truth.positions, axis=2)
    repaired = estimate.origin == Origin.REPAIRED
    rows = slice(None) if per == "marker" else np.newaxis
    columns = _columns(judged.T[rows], hit.T[rows], repaired.T[rows], distance.T[rows])
    table = _table(("all",) if per == "take" else truth.markers, columns)
    notes = [*_without(table, per), *_left_out(estimate, truth, hit, both, judged)]
    info = TableInfo("Impulses", units=UNITS, better=BETTER)
    return with_notes(table, notes, info, of=truth)


def _columns(
    judged: NDArray[np.bool_],
    hit: NDArray[np.bool_],
    repaired: NDArray[np.bool_],
    distance: NDArray[np.float64],
) -> dict[str, NDArray[np.generic]]:
    """Return the numbers of each row, over all axes but the first."""
    hits, clean = judged & hit, judged & ~hit
    detected, wrong = hits & repaired, clean & repaired
    error = np.where(judged, distance, 0.0)
    lost = hits & ~repaired
    missed = _share(_count(lost), _count(hits))
    return {
        "samples": _count(judged),
        "hits": _count(hits),
        "found": _count(detected),
        "false positives": _count(wrong),
        "rmse": np.sqrt(_share(_total(error**2), _count(judged))),
        "error": _share(_total(error * hits), _count(hits)),
        "wrong": 100_000.0 * _share(_count(lost | wrong), _count(judged)),
        "missed": missed,
        "false positive rate": _share(_count(wrong), _count(clean)),
        "change": _share(_total(error * wrong), _count(wrong)),
        "recall": 1.0 - missed,
        "precision": _share(_count(detected), _count(detected) + _count(wrong)),
    }


def _count(flags: NDArray[np.bool_]) -> NDArray[np.intp]:
    return np.asarray(np.count_nonzero(flags.reshape(len(flags), -1), axis=1))


def _total(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(values.reshape(len(values), -1).sum(axis=1))


def _share(part: NDArray[np.generic], whole: NDArray[np.intp]) -> NDArray[np.float64]:
    return np.where(whole > 0, part / np.maximum(whole, 1), np.nan)


def _table(names: tuple[str, ...], columns: dict[str, NDArray[np.generic]]) -> Table:
    from pandas import DataFrame

    return DataFrame({"marker": np.array(names, dtype=object), **columns})


def _without(table: Table, per: Per) -> list[str]:
    """Return a note on the number of rows without an impulse."""
    lacking = int((table["hits"] == 0).sum())
    if not lacking:
        return []
    if per == "take":
        return ["no sample is hit by an impulse: there is no error, missed or recall"]
    return [f"{lacking} of {len(table)} markers have no impulse: no error, missed or recall"]


def _left_out(
    estimate: Trajectories,
    truth: Trajectories,
    hit: NDArray[np.bool_],
    both: NDArray[np.bool_],
    judged: NDArray[np.bool_],
) -> list[str]:
    """Return a note on the samples that are not judged."""
    notes = []
    for what, where in (
        ("that only the truth has", truth.present & ~estimate.present),
        ("that only the estimate has", estimate.present & ~truth.present),
        ("called repaired in the truth already", both & ~judged),
    ):
        if where.any():
            hits = np.count_nonzero(where & hit)
            notes.append(f"{np.count_nonzero(where)} samples {what} are not judged ({hits} hit)")
    return notes
