"""A cubic curve that never overshoots, through each marker's own samples."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nodegraph_fill.along_time import along_time, on_curves

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from nodegraph_fill.gaps import Gaps


@along_time("fill.pchip", cite="fritsch_butland1984", whole_take=True)
def pchip(positions: NDArray[np.float64], gaps: Gaps) -> NDArray[np.float64]:
    """Fill gaps with a monotone piecewise cubic curve (Fritsch & Butland, 1984).

    The curve goes through every present sample of the marker; its slope there is a harmonic
    mean of those of the two chords, or 0 where these differ in sign, coordinate by coordinate, so
    that it never leaves the range of a gap's two ends (`scipy.interpolate.PchipInterpolator`).
    Because this is decided for each coordinate by itself, the curve depends on the axes: a turned
    recording gives a slightly different one.

    Looks ahead one sample beyond the gap's end.
    """
    from scipy.interpolate import PchipInterpolator

    return on_curves(positions, gaps, PchipInterpolator)
