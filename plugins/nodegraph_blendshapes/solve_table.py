"""How well the weights explain each frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap import Table

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_blendshapes.solve_frames import Solved
    from nodegraph_blendshapes.solve_problem import Problem

UNITS = {
    "frame": "frame",
    "markers": "markers",
    "missing": "markers",
    "rms": "mm",
    "max": "mm",
    "at_low": "weights",
    "at_high": "weights",
    "unseen": "shapes",
}


def residual_table(
    problem: Problem, solved: Solved, low: float, high: float, notes: list[str]
) -> Table:
    """Return a row per frame; see `solve.weights`."""
    from pandas import DataFrame

    apart = _apart(problem, solved)
    count = problem.present.sum(axis=1)
    squares = np.square(apart, where=problem.present, out=np.zeros_like(apart)).sum(axis=1)
    farthest = np.where(problem.present, apart, -1.0).argmax(axis=1)
    some = count > 0
    names = np.array([*problem.markers, ""], dtype=object)
    values = solved.values[:, problem.seen]
    solvable = ~solved.unseen[:, problem.seen]
    table = DataFrame(
        {
            "frame": np.arange(len(apart)),
            "markers": count,
            "missing": len(problem.markers) - count,
            "rms": np.where(some, np.sqrt(squares / np.maximum(count, 1)), np.nan),
            "max": apart[np.arange(len(apart)), farthest],
            "worst": names[np.where(some, farthest, -1)],
            "at_low": ((values == low) & solvable).sum(axis=1),
            "at_high": ((values == high) & solvable).sum(axis=1),
            "unseen": solved.unseen.sum(axis=1),
        }
    )
    table.attrs.update(title="Residuals", notes=[f"{note}." for note in notes], units=dict(UNITS))
    return table


def _apart(problem: Problem, solved: Solved) -> NDArray[np.float64]:
    """Return (T, M) distances between the markers and where the weights put them, mm."""
    posed = np.tensordot(solved.values, problem.shapes, axes=1)
    return np.asarray(np.linalg.norm(problem.offsets - posed, axis=2))
