"""The difference of an estimated head motion from the true one, a row per frame."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from nodegraph import Columns, Truth, node
from nodegraph_mocap import HeadMotion, Table
from nodegraph_score.pose import check_proper, degrees_apart
from nodegraph_tables import TableInfo, with_info

UNITS = {"frame": "frame", "rotation": "degrees", "translation": "mm", "scale": "percent"}


@node("score.head_motion")
def head_motion(
    estimate: HeadMotion, truth: Truth[HeadMotion]
) -> Annotated[Table, Columns(*UNITS)]:
    """Error of a head motion, a row per frame; a frame is a scan where there are scans.

    With ``captured = s R aligned + t``, R, t, s of the estimate and R', t', s' of the truth:

    =========== ==================================================================
    frame       its index
    rotation    degrees, angle of the turn ``R R'^T`` that leads from one to the other
    translation mm, ``|t - t'|``
    scale       percent, ``100 |s / s' - 1|``
    =========== ==================================================================

    Both must lead to the same aligned face: if the reference of an alignment lies elsewhere than
    the face of which the truth is known, that shows in every frame. What a turn about another
    point does to t counts as translation; t is where the origin of the aligned recording goes.

    Parameters
    ----------
    estimate
        T frames.
    truth
        T frames.

    Raises
    ------
    ValueError
        If frame counts differ, or a rotation is a mirror image.
    """
    from pandas import DataFrame

    if estimate.frames != truth.frames:
        raise ValueError(f"estimate has {estimate.frames} frames, the truth has {truth.frames}")
    check_proper("estimate", estimate)
    check_proper("truth", truth)
    table = DataFrame(
        {
            "frame": np.arange(truth.frames),
            "rotation": degrees_apart(estimate, truth),
            "translation": np.linalg.norm(estimate.translations - truth.translations, axis=1),
            "scale": 100.0 * np.abs(estimate.scales / truth.scales - 1.0),
        }
    )
    return with_info(table, TableInfo(title="Head motion", units=UNITS))
