"""The nearest markers' motion as a rigid body, from both ends of the gap."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import node
from nodegraph_fill.gaps import LONG, NEVER, Gaps, MaxGap, warn_left
from nodegraph_fill.rigid_motion import carried
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


@node("fill.rigid", cite="vicon_nexus")
def rigid(
    recording: Trajectories,
    *,
    neighbours: Annotated[int, Field(ge=3)] = 6,
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
    max_gap
        Gaps longer than this stay missing; none: gaps of any length are filled. A gap is a run
        of missing samples of one marker.

    Returns
    -------
    Trajectories
        The recording with filled samples, their origin `Origin.FILLED`.
    """
    gaps = Gaps.of(recording)
    long = gaps.longer_than(max_gap) & ~gaps.never
    wanted = gaps.chosen(~(long | gaps.never))
    positions = recording.positions.copy()
    _, frame, marker, _ = wanted.samples
    positions[frame, marker] = _mixed(recording, wanted, neighbours)
    filled = recording.with_samples(positions, changed=wanted.mask, origin=Origin.FILLED)
    reasons = [(gaps.chosen(gaps.never), NEVER), (gaps.chosen(long), LONG)]
    warn_left(filled, reasons, "no three neighbours that span a plane", stacklevel=2)
    return filled


def _mixed(recording: Trajectories, gaps: Gaps, neighbours: int) -> NDArray[np.float64]:
    gap, frame, marker, share = gaps.samples
    ahead = carried(recording, gaps.start[gap] - 1, frame, marker, neighbours)
    back = carried(recording, gaps.stop[gap], frame, marker, neighbours)
    mixed = ahead + (back - ahead) * share[:, None]
    return np.where(np.isnan(back), ahead, np.where(np.isnan(ahead), back, mixed))
