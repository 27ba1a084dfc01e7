"""A cubic spline through each marker's own samples."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nodegraph_fill.along_time import along_time, on_curves

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from nodegraph_fill.gaps import Gaps


@along_time("fill.cubic", cite="deboor1978", whole_take=True)
def cubic(positions: NDArray[np.float64], gaps: Gaps) -> NDArray[np.float64]:
    """Fill gaps with a cubic spline through all samples of the marker (de Boor).

    The spline goes through every present sample of the marker, in and after each gap with
    continuous first and second derivatives, and has no knot at the second and the last but one
    sample (`scipy.interpolate.CubicSpline`, not-a-knot). Through three samples it is a parabola,
    through two a straight line. It is linear in the samples, and so turns with the face. In long
    gaps it may swing far out: nothing bounds it.

    Looks at the whole take, although what is far from a gap hardly counts.
    """
    from scipy.interpolate import CubicSpline

    return on_curves(positions, gaps, CubicSpline)
