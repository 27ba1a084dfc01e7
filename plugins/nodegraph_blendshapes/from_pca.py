"""A model of the directions in which a face differs most."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
from pydantic import Field

from nodegraph import Refusal, node
from nodegraph_blendshapes.model import APART, with_neutral
from nodegraph_blendshapes.rest_pose import pose_at_rest
from nodegraph_mocap import BlendshapeModel, Table, Trajectories
from nodegraph_tables import TableInfo, with_info

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ROUNDING = 1e-9
"""Share by which two weights may differ and still count as equal."""


class PcaModel(NamedTuple):
    """The outputs of `blendshapes.from_pca`."""

    model: BlendshapeModel
    neutral: Trajectories
    components: Table


class _Principal(NamedTuple):
    """(K, M, 3) shapes and the (K,) variance of each, the largest first."""

    shapes: NDArray[np.float64]
    variances: NDArray[np.float64]


@node("blendshapes.from_pca", cite=("blanz1999", "krzanowski2000"))
def from_pca(
    recording: Trajectories,
    neutral: Trajectories | None = None,
    *,
    components: Annotated[int, Field(ge=1)] | None = None,
    variance: Annotated[float, Field(gt=0, le=1)] = 0.98,
) -> PcaModel:
    """Build a model from the principal components of aligned frames or scans.

    With ``X`` (T, 3M) the frames' offsets from the neutral and ``X = U S V^T``, shape k is
    ``V[k] S[k] / sqrt(T)``: weight 1 is one standard deviation of the frames [1]_ [2]_. The
    neutral is their mean; where another one is fed, the standard deviation is the root mean square
    of the offsets from that. Each shape has the sign that makes the largest of its weights in the
    frames positive. Head motion must have been removed: what remains of it becomes a component.

    Parameters
    ----------
    recording
        Aligned, T frames (or a frame per scan), without missing samples.
    neutral
        A face at rest, its first frame, aligned alike, with the markers of `recording`; others are
        left out, with a warning. By default the mean of the frames.
    components
        Number of shapes. By default as few as keep `variance`.
    variance
        Share of the variance that the shapes keep at least; `components` goes before it.

    Returns
    -------
    model : BlendshapeModel
        Shapes ``pc_1``, ``pc_2``, ..., the one with the largest variance first.
    neutral : Trajectories
        The model's face at rest: one frame, its rate set to 1 Hz, with the recording's marker set.
    components : Table
        A row per component that there is: its `shape`, the `share` of the variance that it
        explains, the share that those up to it explain (`cumulative`), the root mean square over
        markers of their `movement` at weight 1 (mm), and whether the model has it (`kept`).

    Raises
    ------
    Refusal
        If samples are missing, the frames do not differ, or have fewer components than asked for.
    ValueError
        If `neutral` lacks a marker of the recording.

    References
    ----------
    .. [1] V. Blanz and T. Vetter, A morphable model for the synthesis of 3D faces, SIGGRAPH '99,
       187-194.
    .. [2] W. J. Krzanowski, Principles of multivariate analysis, Oxford University Press, 2000.
    """
    _check_complete(recording)
    at_rest = _at_rest(recording, neutral)
    principal = _principal(recording.positions, at_rest)
    count = _count(principal.variances, components, variance)
    model = BlendshapeModel(
        neutral=at_rest,
        shapes=principal.shapes[:count],
        names=tuple(f"pc_{number}" for number in range(1, count + 1)),
        markers=recording.markers,
    )
    return PcaModel(*with_neutral(model, recording.marker_set), _table(principal, count))


def _check_complete(recording: Trajectories) -> None:
    missing = np.argwhere(~recording.present)
    if len(missing):
        frame, marker = missing[0]
        raise Refusal(
            f"needs complete frames, but {len(missing)} samples are missing, the first in frame "
            f"{frame}, marker {recording.markers[marker]!r}; fill the recording first"
        )
    if not recording.positions.size:
        raise Refusal("needs frames: the recording has none")


def _at_rest(recording: Trajectories, neutral: Trajectories | None) -> NDArray[np.float64]:
    if neutral is not None:
        return pose_at_rest(neutral, 0, recording)
    # offsets from the first frame are small, and so is what rounding does to their mean
    first = recording.positions[0]
    return np.asarray(first + (recording.positions - first).mean(axis=0))


def _principal(positions: NDArray[np.float64], at_rest: NDArray[np.float64]) -> _Principal:
    """Return the components by which coordinates differ by more than rounding from those at rest.

    Parameters
    ----------
    positions
        (T, M, 3), complete.
    at_rest
        (M, 3).
    """
    frames = len(positions)
    offsets = (positions - at_rest).reshape(frames, -1)
    weights, sizes, directions = np.linalg.svd(offsets, full_matrices=False)
    sizes /= np.sqrt(frames)
    count = int(np.count_nonzero(sizes > APART * np.sqrt(offsets.shape[1])))
    sizes = sizes[:count]
    signs = _signs(weights[:, :count])
    shapes = directions[:count] * (signs * sizes)[:, None]
    return _Principal(shapes.reshape(count, *at_rest.shape), sizes**2)


def _signs(weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return per column the sign of its largest number, the first of equals."""
    size = np.abs(weights)
    largest = np.argmax(size >= (1 - _ROUNDING) * size.max(axis=0, initial=0.0), axis=0)
    return np.asarray(np.sign(np.take_along_axis(weights, largest[None], axis=0)[0]))


def _count(variances: NDArray[np.float64], components: int | None, variance: float) -> int:
    there = len(variances)
    if components is not None and components < 1:
        raise ValueError(f"components must be 1 or more, got {components}")
    if not 0.0 < variance <= 1.0:
        raise ValueError(f"variance must be above 0 and at most 1, got {variance}")
    if not there:
        raise Refusal("the frames do not differ: there is no component")
    if components is None:
        sums = np.cumsum(variances)
        return int(np.searchsorted(sums / sums[-1], variance)) + 1
    if components > there:
        raise Refusal(
            f"the frames differ in {there} directions only; {components} components were asked for"
        )
    return components


def _table(principal: _Principal, count: int) -> Table:
    from pandas import DataFrame

    shares = principal.variances / principal.variances.sum()
    numbers = np.arange(1, len(shares) + 1)
    table = DataFrame(
        {
            "shape": [f"pc_{number}" for number in numbers],
            "share": shares,
            "cumulative": np.cumsum(shares),
            "movement": np.sqrt((principal.shapes**2).sum(axis=2).mean(axis=1)),
            "kept": numbers <= count,
        }
    )
    note = f"The model's {count} shapes explain {100 * shares[:count].sum():.2f} % of the variance."
    return with_info(
        table, TableInfo(title="Principal components", notes=(note,), units={"movement": "mm"})
    )
