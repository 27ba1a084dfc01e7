"""Marker correlations: the markers' principal components, carried over to the missing one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from nodegraph import Refusal, Unit
from nodegraph_fill.gaps import Gaps
from nodegraph_fill.kept import kept_of
from nodegraph_fill.tuning import Tune
from nodegraph_fill.whole_take import Estimate, whole_take
from nodegraph_mocap import Trajectories
from nodegraph_mocap.reference_shape import reference_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

Strategy = Literal["each", "together"]

_ROUNDING = 1e-7
"""Share of the largest singular value or spread below which a value may be rounding."""
_FAR = 0.5
"""Factor of the mean distance to all markers beyond which a marker with gaps predicts nothing."""


@whole_take(
    "fill.pca",
    cite="gloersen_federolf2016",
    adapted=(
        "from Gloersen and Federolf 2016: B0' B where their code multiplies by B' B0, and a "
        "weight scale that goes with the size of the face unless it is set (theirs: 200 mm)"
    ),
    otherwise="no marker to fill from, or no frame complete with those",
)
def pca(
    recording: Trajectories,
    gaps: Gaps,
    *,
    strategy: Strategy = "each",
    weight_scale: Annotated[float | None, Field(gt=0, allow_inf_nan=False), Unit("mm")] = None,
    weight_missing: Annotated[float, Field(gt=0, le=1), Tune(0.02, 0.1)] = 0.02,
    singular_values: Annotated[float, Field(gt=0, le=1), Tune(0.9, 0.95, 0.99, 0.999)] = 0.99,
) -> Estimate:
    """Fill gaps from the markers' principal components (Gloersen & Federolf, 2016).

    From every frame the mean of the markers that are never missing is taken off (nothing, where
    there is no such marker). N are the frames that are complete, a row each, three columns per
    marker; each column without its mean, divided by its standard deviation (1 where that is
    0), times its marker's weight. The weight is ``exp(-d^2 / (2 weight_scale^2))``, d the mean
    distance to the marker that is filled, and `weight_missing` for that one itself. B are the
    principal components of N, B0 those of N with zeros for the marker that is filled; of each
    the first are kept until the sum of their singular values reaches the share `singular_values`,
    the larger number for both. A row x with zeros in place of what is missing becomes
    ``x B0 B0' B B'``, and its scaling is undone. This is eq. 1 of Federolf (2013).

    The strategy "each" is the authors' R2, their code's default: every marker is filled by
    itself. Other markers that are missing in one of its gaps' frames are left out, and so are
    those with gaps of their own that are further away than half the mean distance. Complete are
    the frames that have it and all the markers that remain. "together" is R1: all markers that
    have a gap are missing at once, d is the distance to the nearest of them, and complete are
    the frames that have every marker. Gap is here any run of missing samples, filled or not.

    With all components, `singular_values` 1, and next to no `weight_missing`, "together" is linear
    least squares on the markers that are never missing, whatever their weights. With more of it,
    the components hold the missing markers as well, and all of them together give the mean.

    The code that was published multiplies by ``B' B0`` where ``B0' B`` is meant, so that the
    result hangs on the signs that the eigenvectors happen to have; here it does not.

    A marker that shares no complete frame with those that it is filled from, or that there is
    none to fill from, stays missing, counted in a warning. One that is never measured is not
    part of "every marker". Does not depend on where the origin lies; but depends on the axes, each
    coordinate being scaled by itself, and on the unit by a `weight_scale` that is set.

    Looks at the whole take.

    Parameters
    ----------
    strategy
        Whether each marker is filled by itself or all that have gaps together.
    weight_scale
        How quickly a marker's weight falls with its distance; none: the mean distance of any two
        markers. 200 is the authors', for bodies; on three faces the mean distance was 83 to 88 mm
        and mean errors changed by less than 5 %.
    weight_missing
        The weight of the marker that is filled.
    singular_values
        Share of the sum of the singular values that the components kept must reach.

    Raises
    ------
    Refusal
        If there are gaps to fill, and for none of them a complete frame.
    ValueError
        If `strategy` is not one of its choices.
    """
    positions = np.full_like(recording.positions, np.nan)
    centred, middle = _without_mean(recording)
    scale = weight_scale or _mean_distance(recording)
    groups = _each if strategy == "each" else _together
    estimated = False
    for wanted, predictors, distance in groups(recording, np.unique(gaps.marker)):
        complete = np.asarray(recording.present[:, wanted | predictors].all(axis=1))
        weight = np.exp(-(distance**2) / (2.0 * scale**2))
        weight[wanted] = weight_missing
        estimated |= bool(complete.any())
        if complete.any() and predictors.any():
            estimate = _carried(centred, complete, wanted, predictors, weight, singular_values)
            positions[:, wanted] = estimate + middle
    if not estimated:
        raise _refusal(recording, gaps, strategy)
    return Estimate(positions)


_Group = tuple["NDArray[np.bool_]", "NDArray[np.bool_]", "NDArray[np.float64]"]
"""Markers to fill, markers to fill them from, distance of every marker to them; each (M,)."""


def _each(recording: Trajectories, markers: NDArray[np.intp]) -> Iterator[_Group]:
    present = recording.present
    gappy = ~present.all(axis=0)
    kept, key = kept_of(recording), (_distances, markers.tobytes())
    if key not in kept:
        kept[key] = _distances(recording, markers)
    for marker, distance in zip(markers, kept[key], strict=True):
        wanted = np.arange(present.shape[1]) == marker
        far = distance > _FAR * np.nanmean(distance)
        overlapping = (~present[~present[:, marker]]).any(axis=0)
        yield wanted, ~(wanted | (gappy & far) | overlapping), np.nan_to_num(distance)


def _together(recording: Trajectories, markers: NDArray[np.intp]) -> Iterator[_Group]:
    present = recording.present
    always = np.asarray(present.all(axis=0))
    wanted = present.any(axis=0) & ~always
    nearest = np.fmin.reduce(_distances(recording, np.flatnonzero(wanted)), axis=0)
    yield wanted, always, np.nan_to_num(nearest)


def _distances(recording: Trajectories, markers: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return the mean distances of all markers to some, (N, M); NaN for those never beside them."""
    present, distances = recording.present, np.empty((len(markers), len(recording.markers)))
    # the coordinates apart: sums of three in a row take several times as long
    places = np.where(present, np.moveaxis(recording.positions, 2, 0), 0.0)
    for row, marker in zip(distances, markers, strict=True):
        both = present & present[:, [marker]]
        x, y, z = places - places[:, :, [marker]]
        count = np.count_nonzero(both, axis=0)
        total = np.where(both, np.sqrt(x * x + y * y + z * z), 0.0).sum(axis=0)
        row[:] = np.where(count, total / np.maximum(count, 1), np.nan)
    return distances


def _mean_distance(recording: Trajectories) -> float:
    shape = reference_shape(recording)
    shape = shape[~np.isnan(shape[:, 0])]
    total = float(np.linalg.norm(shape[:, None] - shape, axis=2).sum())
    # all markers in one place weigh alike, whatever the scale
    return total / max(len(shape) * (len(shape) - 1), 1) or 1.0


def _without_mean(
    recording: Trajectories,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return positions without the mean of the markers that are never missing, and that mean."""
    always = recording.present.all(axis=0)
    middle = np.zeros((recording.frames, 1, 3))
    if always.any():
        middle = recording.positions[:, always].mean(axis=1, keepdims=True)
    return recording.positions - middle, middle


def _carried(
    positions: NDArray[np.float64],
    complete: NDArray[np.bool_],
    wanted: NDArray[np.bool_],
    predictors: NDArray[np.bool_],
    weight: NDArray[np.float64],
    share: float,
) -> NDArray[np.float64]:
    """Return the wanted markers in every frame, (T, W, 3); NaN where a predictor is missing."""
    used = np.flatnonzero(wanted | predictors)
    rows = positions[:, used].reshape(len(positions), -1)
    hidden = np.repeat(wanted[used], 3)
    middle, spread = rows[complete].mean(axis=0), rows[complete].std(axis=0)
    still = spread <= _ROUNDING * spread.max()
    scale = np.repeat(weight[used], 3) / np.where(still, 1.0, spread)
    rows = (rows - middle) * scale
    shown = np.where(hidden, 0.0, rows)
    full, rest = _components(rows[complete]), _components(shown[complete])
    count = max(_enough(values, share) for values, _ in (full, rest))
    back, onto = (_first(count, *spectrum) for spectrum in (full, rest))
    estimate = ((shown @ onto) @ (onto.T @ back)) @ back[hidden].T
    return np.asarray((estimate / scale[hidden] + middle[hidden]).reshape(len(rows), -1, 3))


def _components(rows: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the singular values and, as columns, the principal components, largest first."""
    squares, vectors = np.linalg.eigh(rows.T @ rows)
    return np.sqrt(np.maximum(squares[::-1], 0.0)), vectors[:, ::-1]


def _first(
    count: int, values: NDArray[np.float64], vectors: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the first components, fewer where the rest is rounding: it points anywhere."""
    return vectors[:, : min(count, int(np.count_nonzero(values > _ROUNDING * values[0])))]


def _enough(values: NDArray[np.float64], share: float) -> int:
    reached = np.cumsum(values)
    return 1 + int(np.searchsorted(reached, share * reached[-1]))


def _refusal(recording: Trajectories, gaps: Gaps, strategy: str) -> Refusal:
    seen = np.count_nonzero(recording.present.any(axis=0))
    most = int(recording.present.sum(axis=1).max())
    what = "every marker" if strategy == "together" else "a gap's marker and all that it needs"
    return Refusal(
        f"needs one complete frame: none of {recording.frames} has {what} "
        f"({len(np.unique(gaps.marker))} of {seen} markers have gaps to fill; at most {most} are "
        "present at once)"
    )
