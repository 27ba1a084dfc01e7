"""The nearest markers' motion as a rigid body, from both ends of the gap."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph_fill.along_time import along_time
from nodegraph_fill.rigid_motion import carried
from nodegraph_fill.tuning import Tune

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_fill.gaps import Gaps


@along_time(
    "fill.rigid",
    cite="vicon_nexus",
    adapted="from Vicon Nexus: the body is the nearest markers, fitted from both ends of the gap",
    one_end=True,
    otherwise="no three neighbours that span a plane",
)
def rigid(
    positions: NDArray[np.float64],
    gaps: Gaps,
    *,
    neighbours: Annotated[int, Field(ge=3), Tune(4, 6, 10, 16)] = 6,
) -> NDArray[np.float64]:
    """Fill gaps as if the nearest markers and the missing one were one rigid body.

    From frame a, the last before the gap: the nearest markers i that are present both there and
    at frame t are fitted by the rigid motion that minimizes
    ``sum |R P[a, i] + c - P[t, i]|^2``, and the sample is ``R P[a, m] + c``. The same is done
    from frame b, the first after the gap, and both are mixed linearly: ``(t - a) / (b - a)`` of
    the second. A gap at the start or the end of the take is filled from its one end.

    Where fewer than three neighbours are present, or where they lie on a line (their second
    principal extent is under a twentieth of the first), the sample stays missing from that
    end; from both, it stays missing, counted in a warning.

    Looks ahead to the gap's end.

    Parameters
    ----------
    neighbours
        How many markers make up the body, fewer where there are fewer, three at least; equally
        near ones go by marker order.
    """
    gap, frame, marker, share = gaps.samples
    ahead = carried(positions, gaps.start[gap] - 1, frame, marker, neighbours)
    back = carried(positions, gaps.stop[gap], frame, marker, neighbours)
    both = ahead + (back - ahead) * share[:, None]
    return np.where(np.isnan(back), ahead, np.where(np.isnan(ahead), back, both))
