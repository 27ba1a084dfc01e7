"""A cubic curve of local slopes, through each marker's own samples."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nodegraph_fill.along_time import along_time, on_curves

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from nodegraph_fill.gaps import Gaps


@along_time("fill.akima", cite="akima1970", whole_take=True)
def akima(positions: NDArray[np.float64], gaps: Gaps) -> NDArray[np.float64]:
    """Fill gaps with a curve of local slopes that hardly overshoots (Akima, 1970).

    The curve goes through every present sample of the marker; its slope there is a mean of those
    of the chords before and after, each weighted by how little the slopes differ on the other
    side: ``(|m4 - m3| m2 + |m2 - m1| m3) / (|m4 - m3| + |m2 - m1|)`` with the slopes m1 to m4 of
    the four chords around it, coordinate by coordinate (`scipy.interpolate.Akima1DInterpolator`).
    Because this is decided for each coordinate by itself, the curve depends on the axes: a turned
    recording gives a slightly different one.

    Looks ahead two samples beyond the gap's end.
    """
    from scipy.interpolate import Akima1DInterpolator

    return on_curves(positions, gaps, Akima1DInterpolator)
