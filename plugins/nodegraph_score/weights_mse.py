"""The error of the weights of blendshapes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np

from nodegraph import Columns, Truth, listed, node
from nodegraph_mocap import Selection, Table, Weights
from nodegraph_mocap.shape_names import matched, sides_as
from nodegraph_score.notes import with_notes
from nodegraph_tables import Poses, TableInfo

if TYPE_CHECKING:
    from numpy.typing import NDArray

UNITS = {
    "frames": "frames",
    "missing": "frames",
    "shapes": "shapes",
    "shared": "shapes",
    "markers": "markers",
}
MEASURED = ("mse", "rmse", "max", "worst", "worst_mse", "shared_mse")


@node("score.weights_mse")
def weights_mse(
    estimate: Weights, reference: Truth[Weights], selection: Selection | None = None
) -> Annotated[Table, Columns(*MEASURED, *UNITS)]:
    """Mean squared error of blendshape weights, one row for a take.

    With ``e[t, k]`` the weight of shape k in frame t minus that of the reference:

    ========== =========================================================================
    mse        mean of ``e[t, k]^2`` over the frames compared and over all shapes
    rmse       its square root
    max        largest ``|e[t, k]|``
    frames     how many frames are compared
    missing    how many are not, as a weight is missing (NaN) in either
    shapes     how many shapes there are
    worst      the shape of the largest mean of ``e[t, k]^2`` over frames; of equals, the
               first
    worst_mse  that mean
    shared     how many shapes both have
    shared_mse mean of ``e[t, k]^2`` over the same frames and over these shapes
    markers    how many markers are chosen; only with a selection
    ========== =========================================================================

    Shapes are matched by name, whichever convention each is written in (``EyeBlinkLeft``,
    ``eyeBlinkLeft``, ``eyeBlink_L``). A weight without sides, such as ``browInnerUp``, is compared
    with both sides where the reference has these instead, and the mean of two sides with one of
    the reference. Every shape of either counts: one that the other lacks is 0 there, as is one
    that no marker shows, so that it weighs on the error as it would on the face.
    Warnings and the table's notes count and name such shapes, and count the frames left out.
    Where the two come from models with other shapes, `mse` grows with the movement of those that
    one lacks, and falls with each that rests: compare methods by `shared_mse` then. `mse` is the
    metric of a comparison that names none.

    Parameters
    ----------
    estimate
        T frames.
    reference
        T frames: what the weights are, or those from all markers.
    selection
        The markers that the estimate is made from.

    Returns
    -------
    Table
        As above. Where no frame can be compared the numbers are NaN.

    Raises
    ------
    ValueError
        If frame counts differ, the two have no shape in common, or a shape of one may be two of
        the other.
    """
    if estimate.frames != reference.frames:
        raise ValueError(
            f"estimate has {estimate.frames} frames, the reference {reference.frames}: it must "
            "have as many"
        )
    errors, names, is_shared, notes = _errors(estimate, reference)
    known = np.asarray(np.isfinite(errors).all(axis=1))
    if not known.all():
        notes.append(
            f"{np.count_nonzero(~known)} of {len(known)} frames lack a weight and are not compared"
        )
    table = _table(errors[known], names, is_shared, int(np.count_nonzero(~known)), selection)
    pairs = () if selection is None else selection.pairs
    markers = tuple(sorted(name for pair in pairs for name in pair))
    poses = Poses(markers, b"", reference.frames, reference.rate)
    return with_notes(table, notes, TableInfo("Errors of weights", units=UNITS, poses=poses))


def _errors(
    estimate: Weights, reference: Weights
) -> tuple[NDArray[np.float64], tuple[str, ...], NDArray[np.bool_], list[str]]:
    """Return (T, K) differences, the shapes' names, which ones both have, and what one lacks."""
    sides = sides_as(estimate.names, reference.names)
    matches = matched(sides.names, reference.names)
    if not matches:
        raise ValueError(
            f"no shape is in both: estimate has {listed(estimate.names)}, reference "
            f"{listed(reference.names)}"
        )
    spare = tuple(name for name in sides.names if name not in matches)
    names = (*reference.names, *spare)
    places = {name: number for number, name in enumerate(names)}
    errors = np.zeros((estimate.frames, len(names)))
    columns = [places[matches.get(name, name)] for name in sides.names]
    errors[:, columns] = sides.of(estimate.values)
    errors[:, : len(reference.names)] -= reference.values
    driven = set(matches.values())
    lacking = tuple(name for name in reference.names if name not in driven)
    notes = [
        f"{len(absent)} of {len(names)} shapes only the {what} has; they are 0 in the other: "
        f"{listed(absent)}"
        for what, absent in (("estimate", spare), ("reference", lacking))
        if absent
    ]
    return errors, names, np.array([name in driven for name in names]), [*sides.notes, *notes]


def _table(
    errors: NDArray[np.float64],
    names: tuple[str, ...],
    is_shared: NDArray[np.bool_],
    missing: int,
    selection: Selection | None,
) -> Table:
    from pandas import DataFrame

    some = len(errors) > 0
    by_shape = np.square(errors).mean(axis=0) if some else np.full(len(names), np.nan)
    worst = int(by_shape.argmax())
    row = {
        "mse": by_shape.mean(),
        "rmse": np.sqrt(by_shape.mean()),
        "max": np.abs(errors).max() if some else np.nan,
        "frames": len(errors),
        "missing": missing,
        "shapes": len(names),
        "worst": names[worst] if some else "",
        "worst_mse": by_shape[worst],
        "shared": np.count_nonzero(is_shared),
        "shared_mse": by_shape[is_shared].mean(),
    }
    if selection is not None:
        row["markers"] = len(selection.chosen)
    return DataFrame([row])
