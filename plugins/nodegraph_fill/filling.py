"""The recording that a fill takes, and the settings that every fill has."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Literal

from nodegraph_fill.gaps import MaxGap
from nodegraph_fill.meet_ends import Ends
from nodegraph_mocap import Trajectories

Settings = Literal["as_published", "tuned"]
"""The setting ``settings``: the others are as they are set, or those that may be are tuned."""


@dataclass(frozen=True)
class Filling:
    """A recording with gaps, and the settings of every fill.

    Attributes
    ----------
    recording
        Trajectories with gaps.
    ends
        as_published: the estimate as it is. met: its mismatch at each end of a gap, sample minus
        estimate, is spread linearly over the gap, all of it at that end and none at the other;
        a gap that the take begins or ends with has one end.
    max_gap
        Gaps longer than this stay missing; none: gaps of any length are filled. A gap is a run
        of missing samples of one marker.
    settings
        as_published: the others as they are set. tuned: those that declare values to try are
        chosen by the recording itself. Its gaps are laid over samples that are present, and
        these are hidden; setting after setting takes the value with the least mean error there,
        of six in all. With fewer than ten such gaps they stay as they are set.

    Returns
    -------
    Trajectories
        The recording with filled samples, their origin `Origin.FILLED`.
    """

    recording: Trajectories
    _: KW_ONLY
    ends: Ends = "as_published"
    max_gap: MaxGap = None
    settings: Settings = "as_published"
