"""Accelerations that no face reaches, as Qualisys Track Manager detects spikes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import Unit, node
from nodegraph_despike.repair import Repairing, repaired
from nodegraph_mocap import Trajectories
from nodegraph_mocap.frame_ranges import runs_of

if TYPE_CHECKING:
    from numpy.typing import NDArray


@node(
    "despike.acceleration",
    cite="qualisys_spikes",
    adapted=(
        "from Qualisys Track Manager: a spike is put on a straight line, which its user does by"
        " hand"
    ),
    lookahead=None,
    shares=Repairing,
)
def acceleration(
    repairing: Repairing,
    *,
    threshold: Annotated[float, Field(gt=0.0, allow_inf_nan=False), Unit("mm/s^2")] = 20_000.0,
) -> Trajectories:
    """Replace spikes, runs of samples with more than some acceleration, by a straight line.

    With ``a_i = (P_{i+1} - 2 P_i + P_{i-1}) rate^2``, the sample ``P_i`` is bad when
    ``|a_i| > threshold``; a spike is a run of bad frames. Qualisys Track Manager (QTM) detects
    spikes by an acceleration threshold and lists each from its start to its end; the user then
    smooths or interpolates that range. What QTM does by hand is fixed here: the frames
    ``i .. j`` of a spike are put on the line between ``P_{i-1}`` and ``P_{j+1}``.

    An impulse of s millimetres has ``|a| = 2 s rate^2`` in its own frame and ``s rate^2`` in the
    frames beside it: where that is more than the threshold too, these good samples are replaced
    as well, by little, so that one impulse counts as three. Impulses of two frames are found
    likewise; of longer ones only the edges are. A sample without two present neighbours has no
    acceleration and is not bad. How many samples were repaired, and by how much, is in a
    warning; what an earlier method has filled or repaired counts as present.

    Looks ahead 1 frame to judge a sample, and to the first frame after a spike to repair it.

    Parameters
    ----------
    threshold
        The default is twice the acceleration of free fall: an impulse is bad from 2.8 mm at
        60 Hz, from 11 mm at 30 Hz and from 1 mm at 100 Hz.
    """
    recording = repairing.recording
    positions = recording.positions
    bad = np.zeros(recording.origin.shape, dtype=np.bool_)
    bend = np.diff(positions, n=2, axis=0) * recording.rate**2
    bad[1:-1] = np.linalg.norm(bend, axis=2) > threshold
    return repaired(recording, _bridged(positions, bad))


def _bridged(positions: NDArray[np.float64], bad: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return the positions with each run of bad samples on the line between its neighbours."""
    marker, first, after = runs_of(bad)
    length = after - first
    run = np.repeat(np.arange(len(first)), length)
    step = np.arange(len(run)) - np.repeat(np.cumsum(length) - length, length) + 1
    start, end = positions[first - 1, marker], positions[after, marker]
    bridged = positions.copy()
    share = (step / (length + 1)[run])[:, None]
    bridged[first[run] + step - 1, marker[run]] = start[run] + (end - start)[run] * share
    return bridged
