"""A cubic curve of local slopes, through each marker's own samples."""

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


@node("fill.akima", cite="akima1970", lookahead=None, ends=True)
def akima(
    recording: Trajectories, *, ends: Ends = "as_published", max_gap: MaxGap = None
) -> Trajectories:
    """Fill gaps with a curve of local slopes that hardly overshoots (Akima, 1970).

    The curve goes through every present sample of the marker; its slope there is a mean of those
    of the chords before and after, each weighted by how little the slopes differ on the other
    side: ``(|m4 - m3| m2 + |m2 - m1| m3) / (|m4 - m3| + |m2 - m1|)`` with the slopes m1 to m4 of
    the four chords around it, coordinate by coordinate (`scipy.interpolate.Akima1DInterpolator`).
    Because this is decided for each coordinate by itself, the curve depends on the axes: a turned
    recording gives a slightly different one.

    A gap at the start or at the end of the take has one end only and stays missing, counted in
    a warning, as does a marker that is never measured. Samples that are present come out as
    they went in; those that an earlier fill has made count like measured ones.

    Looks ahead two samples beyond the gap's end.

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
    from scipy.interpolate import Akima1DInterpolator

    return on_curves(positions, gaps, Akima1DInterpolator)
