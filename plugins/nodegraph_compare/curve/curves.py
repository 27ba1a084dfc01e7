"""The curves of one comparison, as the answer, the lead and the figure show them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nodegraph import Label
    from nodegraph_compare.curve.marks import Mark, Marks
    from nodegraph_compare.curve.points import Axes, Points
    from nodegraph_compare.curve.scale import Scale
    from nodegraph_compare.recordings import Recordings


@dataclass(frozen=True, eq=False, kw_only=True)
class Curves:
    """Curves with their floor and their marks.

    Attributes
    ----------
    axes : Axes
        The names of what is shown.
    points : tuple of Points
        Of each label.
    marked : Marks
        The places with a mark.
    floors : mapping of label to float, optional
        The noise floor of each label, NaN for one without; None where there is no floor.
    scale : Scale
        Along y.
    mark, tolerance
        As set.
    unit : str
        Of the metric.
    recordings : Recordings
        That the scores are of.
    """

    axes: Axes
    points: tuple[Points, ...]
    marked: Marks
    floors: Mapping[Label, float] | None
    scale: Scale
    mark: Mark
    tolerance: float
    unit: str
    recordings: Recordings

    @property
    def drawn(self) -> Sequence[Points]:
        """Curves of which a point has a number."""
        return [points for points in self.points if len(points.curve)]

    @property
    def enough(self) -> float | None:
        """The error that is small enough; None where other places are marked."""
        return None if isinstance(self.mark, str) else self.mark

    def floor(self, points: Points) -> float:
        """Return the noise floor under a curve; NaN where there is none."""
        return (self.floors or {}).get(points.label, math.nan)
