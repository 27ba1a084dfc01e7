"""The effect of each step of a chain on the error, a row per step."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np

from nodegraph import Across, Columns, Truth, listed, node
from nodegraph_mocap import Table, Trajectories
from nodegraph_mocap.frame_ranges import chunks
from nodegraph_score.notes import with_notes
from nodegraph_score.steps_answer import BETTER, WORSE, absences, answer_of, left_out, worse
from nodegraph_tables import TableInfo

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

COLUMNS = (
    "step", "verdict", "changed", "before", "after", "nearer", "added", "added rmse", "worst",
    "removed", "rmse", "missing", "misplaced",
)  # fmt: skip
UNITS = dict.fromkeys(("before", "after", "added rmse", "worst", "rmse"), "mm")
UNITS["nearer"] = "share"
_FEWEST = 2


@dataclass(frozen=True)
class _Stage:
    """A recording after a step, at the truth's markers.

    Attributes
    ----------
    name : str
    positions : (T, M, 3) array of float64
        NaN where the stage lacks the sample or the truth does not know it.
    error : (T, M) array of float64
        mm to the truth, likewise.
    """

    name: str
    positions: NDArray[np.float64]
    error: NDArray[np.float64]

    @property
    def has(self) -> NDArray[np.bool_]:
        """(T, M), True where there is an error."""
        return np.isfinite(self.error)


@node("score.steps")
def steps(
    stages: Across[Trajectories], truth: Truth[Trajectories]
) -> Annotated[Table, Columns(*COLUMNS)]:
    """Error to the truth before and after each step of a chain, over the samples it changed.

    ``stages: {captured: named, fill: fill, despike: despike, smooth: smooth}`` are a recording as
    it came and after each step, in order. The first row is what came, each other row the step
    from the stage before it. Errors are distances to the truth; markers are matched by name, and
    a sample counts where the truth is known:

    ========== ===========================================================================
    step       name of the stage that it leads to; the first is where the chain begins
    verdict    ``better`` or ``worse`` by `before` and `after`, ``same``; ``begins``; where
               nothing was changed, ``adds``, ``removes`` or ``nothing``
    changed    samples that the stage and the one before it have in different places
    before     mm, root mean square error of those before the step
    after      mm, and after it
    nearer     share of those that came nearer to the truth
    added      samples that the stage has and the one before it has not; a missing sample has
               no error, so that `before` says nothing about them
    added rmse mm, root mean square error of those
    worst      mm, largest error of the changed and the added ones after the step
    removed    samples that the stage no longer has
    rmse       mm, root mean square error of all samples that the stage has
    missing    samples of the truth that it lacks
    misplaced  samples that are nearer to where another marker is than to where their own is:
               wrong names, points of no marker, or errors as large
    ========== ===========================================================================

    A warning names each step that makes it worse. A step that adds samples raises
    `rmse` whenever they are worse than those that were there: that alone is not a fault.

    Parameters
    ----------
    stages
        T frames each, along one axis. One that is absent is passed over: the step after it then
        begins at the last stage that there is.
    truth
        The same frames.

    Returns
    -------
    Table
        As above; its answer has a card per row.

    Raises
    ------
    ValueError
        If there are fewer than two stages, they lie along several axes, frame counts or rates
        differ, or a stage has no marker of the truth.
    """
    from pandas import DataFrame

    _check(stages, truth)
    stages_scored = [_stage(name, stage, truth) for name, stage in _named(stages)]
    rows = [_first_row(stages_scored[0], truth)]
    rows += [_row(before, after, truth) for before, after in itertools.pairwise(stages_scored)]
    table = DataFrame(rows, columns=list(COLUMNS))
    notes = [*worse(rows), *left_out(stages, truth)]
    info = TableInfo(
        "What each step did",
        answer_of(rows),
        units=UNITS,
        sequences=("step",),
    )
    return with_notes(table, notes, info, of=truth)


def _check(stages: Across[Trajectories], truth: Trajectories) -> None:
    if len(stages.axes) > 1:
        raise ValueError(
            f"stages lie along one axis, not along {', '.join(stages.axes)}: say `over` which one"
        )
    if len(stages) < _FEWEST:
        there = ", ".join(stages.names()) or "none"
        raise ValueError(f"a step needs {_FEWEST} stages; there is {there}{absences(stages)}")
    for name, stage in _named(stages):
        if stage.frames != truth.frames:
            raise ValueError(f"{name} has {stage.frames} frames, the truth has {truth.frames}")
        if stage.rate != truth.rate:
            raise ValueError(f"{name} has {stage.rate:g} Hz, the truth has {truth.rate:g} Hz")
        if not set(stage.markers) & set(truth.markers):
            raise ValueError(
                f"{name} has no marker of the truth: it has {listed(stage.markers)}, the truth "
                f"{listed(truth.markers)}"
            )


def _named(stages: Across[Trajectories]) -> Iterator[tuple[str, Trajectories]]:
    return zip(stages.names(), stages.values(), strict=True)


def _stage(name: str, recording: Trajectories, truth: Trajectories) -> _Stage:
    positions = recording.positions_of(truth.markers)
    positions[~truth.present] = np.nan
    return _Stage(name, positions, np.linalg.norm(positions - truth.positions, axis=2))


def _first_row(stage: _Stage, truth: Trajectories) -> dict[str, object]:
    nothing = np.zeros(truth.origin.shape, dtype=np.bool_)
    before = _Stage("", np.full_like(stage.positions, np.nan), np.full(nothing.shape, np.nan))
    return _row(before, stage, truth) | {"verdict": "begins"}


def _row(before: _Stage, after: _Stage, truth: Trajectories) -> dict[str, object]:
    had, has = before.has, after.has
    changed = had & has & np.any(before.positions != after.positions, axis=2)
    added, removed = has & ~had, had & ~has
    moved = (_rms(before.error[changed]), _rms(after.error[changed]))
    nearer = after.error[changed] < before.error[changed]
    return {
        "step": after.name,
        "changed": np.count_nonzero(changed),
        "before": moved[0],
        "after": moved[1],
        "nearer": float(nearer.mean()) if len(nearer) else np.nan,
        "added": np.count_nonzero(added),
        "added rmse": _rms(after.error[added]),
        "removed": np.count_nonzero(removed),
        "worst": _largest(after.error[changed | added]),
        "rmse": _rms(after.error[has]),
        "missing": np.count_nonzero(truth.present & ~has),
        "misplaced": np.count_nonzero(misplaced(after.positions, truth.positions)),
        "verdict": _verdict(moved, bool(added.any()), bool(removed.any())),
    }


def _verdict(moved: tuple[float, float], adds: bool, removes: bool) -> str:
    before, after = moved
    if np.isfinite(before):
        return BETTER if after < before else WORSE if after > before else "same"
    return "adds" if adds else "removes" if removes else "nothing"


def _rms(errors: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(errors**2))) if len(errors) else np.nan


def _largest(errors: NDArray[np.float64]) -> float:
    return float(errors.max()) if len(errors) else np.nan


def misplaced(positions: NDArray[np.float64], truth: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (T, M), True where a sample is nearer to another marker's truth than to its own.

    Parameters
    ----------
    positions, truth
        (T, M, 3) of the same markers; NaN where missing. A sample without a truth is not.
    """
    flags = np.zeros(positions.shape[:2], dtype=np.bool_)
    markers = positions.shape[1]
    for piece in chunks(len(positions), 8 * markers * markers):
        flags[piece] = _misplaced(positions[piece], truth[piece])
    return flags


def _misplaced(positions: NDArray[np.float64], truth: NDArray[np.float64]) -> NDArray[np.bool_]:
    # |p - x|^2 without the |p|^2 that all x have in common, and about the middle of the markers,
    # so that nothing is lost to their distance from the origin
    middle = np.nan_to_num(truth).mean(axis=1, keepdims=True)
    here, there = positions - middle, truth - middle
    lengths = np.sum(there**2, axis=2)
    apart = lengths[:, None, :] - 2.0 * (np.nan_to_num(here) @ np.nan_to_num(there).swapaxes(1, 2))
    own = np.diagonal(apart, axis1=1, axis2=2)
    nearest = np.where(np.isnan(apart), np.inf, apart).min(axis=2, initial=np.inf)
    return np.asarray(np.isfinite(here[..., 0]) & (nearest < own))
