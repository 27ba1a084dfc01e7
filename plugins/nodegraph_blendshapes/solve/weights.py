"""The weights with which a model explains a recording."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import numpy as np
from pydantic import AfterValidator, Field
from pydantic_core import PydanticCustomError

from nodegraph import StateForm, Unit, node
from nodegraph_blendshapes.solve.bounded import System
from nodegraph_blendshapes.solve.frames import columns_of, solve_frames
from nodegraph_blendshapes.solve.problem import SEEN, Problem
from nodegraph_blendshapes.solve.smooth import solve_take
from nodegraph_mocap import BlendshapeModel, MarkerFrame, Table, Trajectories, Weights
from nodegraph_tables import TableInfo, with_info

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from nodegraph_blendshapes.solve.frames import Solved


_Written = tuple[float, float] | Literal["nonnegative", "none"]
_RULE = (
    "two numbers, the lower first and 0, the face at rest, not outside of them, or nonnegative or "
    "none"
)
_WORDS = {"nonnegative": (0.0, math.inf), "none": (-math.inf, math.inf)}


def limits(bounds: Bounds) -> tuple[float, float]:
    """Return the lower and the upper bound, infinite where there is none.

    Raises
    ------
    ValueError
        If they are none of the words and no two numbers with 0 between them.
    """
    limit = _limits(bounds)
    if limit is None:
        raise ValueError(f"bounds must be {_RULE}; got {bounds}")
    return limit


def _limits(bounds: _Written) -> tuple[float, float] | None:
    if isinstance(bounds, str):
        return _WORDS.get(bounds)
    if len(bounds) != 2:
        return None
    low, high = bounds
    finite = math.isfinite(low) and math.isfinite(high)
    return (float(low), float(high)) if finite and low <= 0.0 <= high and low < high else None


def _as_pydantic_says_it(bounds: _Written) -> _Written:
    if _limits(bounds) is None:
        raise PydanticCustomError("bounds", f"Input must be {_RULE}")
    return bounds


Bounds = Annotated[_Written, AfterValidator(_as_pydantic_says_it)]


def notes_of(
    problem: Problem, solved: Solved, names: tuple[str, ...], *, smoothness: float
) -> list[str]:
    """Return a sentence, without its stop, for each thing that was left out or not found."""
    return [
        *problem.notes,
        *_hidden(solved, names, smoothness),
        *_empty(problem),
        *_unsolved(solved),
    ]


def _hidden(solved: Solved, names: tuple[str, ...], smoothness: float) -> Iterator[str]:
    frames = int(np.count_nonzero(solved.unseen.any(axis=1)))
    if frames:
        instead = "follows from the frames around" if smoothness else "is 0"
        counts = solved.unseen.sum(axis=0)
        shapes = ", ".join(
            f"{name} ({count})" for name, count in zip(names, counts, strict=True) if count
        )
        yield (
            f"in {frames} of {len(solved.unseen)} frames the markers by which a shape moves "
            f"{SEEN:g} mm are missing; its weight there {instead}: {shapes}"
        )


def _empty(problem: Problem) -> Iterator[str]:
    empty = np.asarray(~problem.present.any(axis=1))
    if empty.any():
        yield (
            f"{np.count_nonzero(empty)} of {len(empty)} frames have none of the model's markers, "
            f"and no weights; the first is frame {empty.argmax()}"
        )


def _unsolved(solved: Solved) -> Iterator[str]:
    if solved.unsolved.any():
        yield (
            f"in {np.count_nonzero(solved.unsolved)} of {len(solved.values)} frames the weights of "
            "least squares could not be found within rounding; they have none; the first is frame "
            f"{solved.unsolved.argmax()}"
        )


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
    sentences = tuple(f"{note}." for note in notes)
    return with_info(table, TableInfo(title="Residuals", notes=sentences, units=UNITS))


def _apart(problem: Problem, solved: Solved) -> NDArray[np.float64]:
    """Return (T, M) distances between the markers and where the weights put them, mm."""
    posed = np.tensordot(solved.values, problem.shapes, axes=1)
    return np.asarray(np.linalg.norm(problem.offsets - posed, axis=2))


LARGEST = 1e12
Penalty = Annotated[float, Field(ge=0.0, le=LARGEST, allow_inf_nan=False), Unit("mm^2")]


class Explained(NamedTuple):
    """Weights, and what they leave unexplained."""

    weights: Weights
    residuals: Table


_MOST_PATTERNS = 256
"""Sets of markers whose columns are kept ready."""


class _Stream:
    """The weights frame by frame."""

    def __init__(
        self,
        recording: Trajectories,
        model: BlendshapeModel,
        *,
        bounds: Bounds,
        ridge: float,
        smoothness: float,
    ) -> None:
        self._low, self._high = limits(bounds)
        self._ridge = ridge
        self._problem = problem = Problem.of(recording, model)
        self._markers = np.array([recording.markers.index(name) for name in problem.markers])
        self._neutral = model.neutral[[model.markers.index(name) for name in problem.markers]]
        self._systems: dict[bytes, tuple[NDArray[np.intp], NDArray[np.float64], System]] = {}
        values = np.empty((0, len(model.names)))
        self.header = (Weights(values=values, names=model.names, rate=recording.rate), None)

    def push(self, frame: MarkerFrame) -> tuple[NDArray[np.float64], None]:
        there = frame.present.take(self._markers)
        if not there.any():
            return np.full(len(self._problem.shapes), np.nan), None
        shapes, further, system = self._system(there)
        offsets = (frame.positions.take(self._markers, axis=0) - self._neutral)[there]
        weights = system.solve_next(np.concatenate((offsets.ravel(), further)))
        values = np.zeros(len(self._problem.shapes))
        values[shapes] = weights
        if len(weights) and np.isnan(weights[0]):
            values[:] = np.nan
        return values, None

    def drain(self) -> Iterable[object]:
        return ()

    def _system(
        self, there: NDArray[np.bool_]
    ) -> tuple[NDArray[np.intp], NDArray[np.float64], System]:
        """Return which shapes some markers show, what is 0 behind their offsets, and the rest."""
        key = there.tobytes()
        if key not in self._systems:
            if len(self._systems) == _MOST_PATTERNS:
                self._systems.clear()
            shapes, columns = columns_of(self._problem, there, self._ridge)
            further = np.zeros(columns.shape[1] - 3 * np.count_nonzero(there))
            self._systems[key] = shapes, further, System(columns, self._low, self._high)
        return self._systems[key]


@node(
    "solve.weights",
    cite=("lewis2014", "portugal1994", "rockafellar1976", "mehrotra1992"),
    live=StateForm(
        _Stream,
        lookahead=lambda settings: None if settings["smoothness"] else 0,
        outputs=("weights",),
        tolerance=1e-9,
    ),
)
def solve_weights(
    recording: Trajectories,
    model: BlendshapeModel,
    *,
    bounds: Bounds = (0.0, 1.0),
    ridge: Penalty = 0.0,
    smoothness: Penalty = 0.0,
) -> Explained:
    """Find the weights of blendshapes with which a model explains a recording, frame by frame.

    In each frame the weights w that make ``|B w - (x - x0)|^2`` least within the bounds [1]_: x
    are the markers' positions, x0 those of the model's neutral and the columns of B its shapes, at
    the markers that are present in the frame. Head motion must have been removed by alignment to
    the model's neutral. The bounded problem itself is solved, by exchanging the weights that are at
    a bound, many at a time [2]_. The least-squares answer without bounds, clipped to them, is
    another and worse one. Where shapes depend on each other, a ridge of a billionth of the largest
    curvature makes the weights the only ones, and is taken back step by step [3]_. Every answer is
    held against the conditions for a least: the gradient that does not push a weight against its
    bound is at most 1e-11 of ``|column| (|x - x0| + sum |column| |w|)``. A frame of which no
    answer meets them has no weights (NaN), counted in a warning.

    Markers are matched by name; those that only recording or model has are left out, with a
    warning. A shape that moves none of the recording's markers by 0.5 mm cannot be seen: its weight
    is 0, and it is named in a warning and in the table's notes. The same holds in a frame of whose
    present markers it moves none, counted in the table. Where several answers are as good, as with
    two identical shapes or fewer coordinates than shapes, the one of the least sum of squared
    weights is taken, but for the ridge: identical shapes share. A frame without any marker has no
    weights (NaN).

    Looks at no other frame unless there is smoothness; then at all of the take. The least of
    ``sum over frames of |B w[t] - (x[t] - x0)|^2 + ridge |w[t]|^2 + smoothness |w[t] - w[t-1]|^2``
    is convex; it is found by exchanging weights of all frames or from within the bounds [4]_, to a
    gradient of at most 1e-10 of the largest at weights of 0; where rounding does not let it, the
    take is refused. Of several answers it takes, but for a billionth of the largest curvature, the
    one of the least sum of squared weights. A frame without any marker splits the take. The weight
    of a shape that is not seen in a frame follows from the frames around. It takes 8 K^2 bytes per
    frame, K being the number of shapes.

    Parameters
    ----------
    recording
        T frames, with or without gaps, aligned to the model's neutral.
    model
        Its markers may be more or fewer than the recording's.
    bounds
        The least and the largest weight, as ``[0, 1]``; 0, the face at rest, must not lie outside.
        Or ``nonnegative``, or ``none``.
    ridge
        Draws all weights to 0: a weight of 1 costs as much as one coordinate of one marker that is
        off by the square root of this.
    smoothness
        Draws weights to those of the frames before and after: a change by 1 from one frame to the
        next costs as much as one coordinate of one marker that is off by the square root of this.

    Returns
    -------
    weights : Weights
        Weights of all the model's shapes, in its order.
    residuals : Table
        A row per frame: ``markers`` that were used and how many of those that both have are
        ``missing``; over the used ones the distance in mm from where the weights put them, as
        ``rms`` and ``max``, with the ``worst`` marker, the first of equals; how many of the weights
        that could be found are exactly ``at_low`` and ``at_high``, the bounds; how many shapes are
        ``unseen`` there that other frames see. NaN where no marker is present.

    Raises
    ------
    Refusal
        If no frame has a marker of the model, or rounding hides the least with smoothness.
    ValueError
        If recording and model have no marker in common, the model has no shapes, or a setting is
        out of range.

    References
    ----------
    .. [1] J. P. Lewis et al., Practice and theory of blendshape facial models, Eurographics 2014,
       State of the Art Reports, 199-218.
    .. [2] L. F. Portugal, J. J. Judice & L. N. Vicente, A comparison of block pivoting and
       interior-point algorithms for linear least squares problems with nonnegative variables,
       Mathematics of Computation 63 (1994), 625-643.
    .. [3] R. T. Rockafellar, Monotone operators and the proximal point algorithm, SIAM Journal on
       Control and Optimization 14 (1976), 877-898.
    .. [4] S. Mehrotra, On the implementation of a primal-dual interior point method, SIAM Journal
       on Optimization 2 (1992), 575-601.
    """
    low, high = limits(bounds)
    for name, penalty in (("ridge", ridge), ("smoothness", smoothness)):
        if not 0.0 <= penalty <= LARGEST:
            raise ValueError(f"{name} must be from 0 to {LARGEST:g} mm^2, got {penalty}")
    problem = Problem.of(recording, model)
    if smoothness:
        solved = solve_take(problem, low, high, ridge, smoothness)
    else:
        solved = solve_frames(problem, low, high, ridge)
    notes = notes_of(problem, solved, model.names, smoothness=smoothness)
    for note in notes:
        warnings.warn(note, stacklevel=2)
    weights = Weights(values=solved.values, names=model.names, rate=recording.rate)
    return Explained(weights, residual_table(problem, solved, low, high, notes))
