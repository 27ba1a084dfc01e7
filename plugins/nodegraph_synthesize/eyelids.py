"""Closing of the eyes: the skin of the upper lid slides down over the eyeball to the lower lid.

An open eye is about 10 mm high, and a marker of 3 to 4 mm sits on the skin of a lid, some 2 mm
from its edge. So two markers one above the other, 15 mm apart on the open eye, are still 4 to
5 mm apart when the edges meet: less is not possible. The lower lid rises by about a millimetre.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_synthesize.surface import on_face

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_synthesize.proportions import Proportions

EYELIDS = "orbicularisOculi"
"""The muscle around the eye, whose channels close the left eye and the right one."""

_CENTRE, _HALF_WIDTH = 31.0, 17.5
"""Centre and half width of the eye on the average face, in u, mm."""
_HEIGHTS = (8.0, 18.0, 34.0, 44.0)
"""v below the lower lid, on it, on the upper lid, and where the brow begins, mm."""
_LOWERED = (0.0, -1.0, 11.0, 0.0)
"""Distance that the skin at these heights goes down when the eye closes, mm."""


def eyelid_offsets(
    points: NDArray[np.float64], proportions: Proportions
) -> dict[str, NDArray[np.float64]]:
    """Return (N, 3) mm by which each eye's closing moves (N, 3) points, by the channel's name.

    Between the heights the skin is stretched or gathered evenly, and never folded.
    """
    return {
        f"{EYELIDS}Left": _closed(points, proportions, _CENTRE),
        f"{EYELIDS}Right": _closed(points, proportions, -_CENTRE),
    }


def _closed(
    points: NDArray[np.float64], proportions: Proportions, centre: float
) -> NDArray[np.float64]:
    u, v = points[:, 0] / proportions.width, points[:, 1] / proportions.height
    across = np.minimum(((u - centre) / _HALF_WIDTH) ** 2, 1.0)
    lowered = np.interp(v, _HEIGHTS, _LOWERED) * np.cos(across * np.pi / 2)
    before, after = (
        on_face(np.stack([u, height], axis=1), proportions) for height in (v, v - lowered)
    )
    return np.asarray(after - before)
