"""A cubic spline through each marker's own samples."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nodegraph import node
from nodegraph_fill.along_time import bridge, on_curves
from nodegraph_fill.gaps import Gaps, MaxGap
from nodegraph_fill.meet_ends import Ends
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@node("fill.cubic", cite="deboor1978", lookahead=None, ends=True)
def cubic(
    recording: Trajectories, *, ends: Ends = "as_published", max_gap: MaxGap = None
) -> Trajectories:
    """Fill gaps with a cubic spline through all samples of the marker (de Boor).

    The spline goes through every present sample of the marker, in and after each gap with
    continuous first and second derivatives, and has no knot at the second and the last but one
    sample (`scipy.interpolate.CubicSpline`, not-a-knot). Through three samples it is a parabola,
    through two a straight line. It is linear in the samples, and so turns with the face. In long
    gaps it may swing far out: nothing bounds it.

    A gap at the start or at the end of the take has one end only and stays missing, counted in
    a warning, as does a marker that is never measured. Samples that are present come out as
    they went in; those that an earlier fill has made count like measured ones.

    Looks at the whole take, although what is far from a gap hardly counts.

    Parameters
    ----------
    recording
        Trajectories with gaps.
    ends
        No matter: the fill meets both ends by itself.
    max_gap
        Gaps longer than this stay missing; none: gaps of any length are filled. A gap is a run
        of missing samples of one marker.

    Returns
    -------
    Trajectories
        The recording with filled samples, their origin `Origin.FILLED`.
    """
    return bridge(recording, ends, max_gap, _between)


def _between(positions: NDArray[np.float64], gaps: Gaps) -> NDArray[np.float64]:
    from scipy.interpolate import CubicSpline

    return on_curves(positions, gaps, CubicSpline)
