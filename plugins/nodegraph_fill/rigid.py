"""The nearest markers' motion as a rigid body, from both ends of the gap."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import node
from nodegraph_fill.gaps import Gaps, MaxGap, to_gap_end
from nodegraph_fill.meet_ends import Ends
from nodegraph_fill.rigid_motion import carried
from nodegraph_fill.streams import live_form
from nodegraph_fill.whole_take import Estimate, fill_from
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_fill.along_time import Between


def _between(neighbours: int) -> Between:
    def mixed(positions: NDArray[np.float64], gaps: Gaps) -> NDArray[np.float64]:
        gap, frame, marker, share = gaps.samples
        ahead = carried(positions, gaps.start[gap] - 1, frame, marker, neighbours)
        back = carried(positions, gaps.stop[gap], frame, marker, neighbours)
        both = ahead + (back - ahead) * share[:, None]
        return np.where(np.isnan(back), ahead, np.where(np.isnan(ahead), back, both))

    return mixed


@node(
    "fill.rigid",
    cite="vicon_nexus",
    adapted="from Vicon Nexus: the body is the nearest markers, fitted from both ends of the gap",
    lookahead=to_gap_end,
    ends=True,
    live=live_form(_between, one_end=True),
)
def rigid(
    recording: Trajectories,
    *,
    neighbours: Annotated[int, Field(ge=3)] = 6,
    ends: Ends = "as_published",
    max_gap: MaxGap = None,
) -> Trajectories:
    """Fill gaps as if the nearest markers and the missing one were one rigid body.

    From frame a, the last before the gap: the nearest markers i that are present both there and
    at frame t are fitted by the rigid motion that minimizes
    ``sum |R P[a, i] + c - P[t, i]|^2``, and the sample is ``R P[a, m] + c``. The same is done
    from frame b, the first after the gap, and both are mixed linearly: ``(t - a) / (b - a)`` of
    the second. A gap at the start or the end of the take is filled from its one end.

    Where fewer than three neighbours are present, or where they lie on a line (their second
    principal extent is under a twentieth of the first), the sample stays missing from that
    end; from both, it stays missing, counted in a warning. So does a marker that is never
    measured. Samples that are present come out as they went in; those that an earlier fill has
    made count like measured ones.

    Looks ahead to the gap's end.

    Parameters
    ----------
    recording
        Trajectories with gaps.
    neighbours
        How many markers make up the body, fewer where there are fewer, three at least; equally
        near ones go by marker order.
    ends
        No matter: bodies at both ends meet them by themselves.
    max_gap
        Gaps longer than this stay missing; none: gaps of any length are filled. A gap is a run
        of missing samples of one marker.

    Returns
    -------
    Trajectories
        The recording with filled samples, their origin `Origin.FILLED`.
    """
    between = _between(neighbours)

    def model(recording: Trajectories, gaps: Gaps) -> Estimate:
        _, frame, marker, _ = gaps.samples
        positions = np.full_like(recording.positions, np.nan)
        positions[frame, marker] = between(recording.positions, gaps)
        return Estimate(positions)

    otherwise = "no three neighbours that span a plane"
    return fill_from(recording, max_gap, model, ends=ends, otherwise=otherwise)
