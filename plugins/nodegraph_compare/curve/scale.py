"""The scale along y on which curves are drawn and knees are measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.curve.points import Points

_WIDEST_LINEAR = 30.0
_DEEPEST = 1e-6
_ROOM = 1.5


@dataclass(frozen=True)
class Scale:
    """A linear or logarithmic scale.

    Attributes
    ----------
    logarithmic : bool
    lowest, highest : float
        Where the figure ends; NaN where the scale is linear and the figure ends where it may.
        What is lower is drawn on the lower edge.
    """

    logarithmic: bool
    lowest: float
    highest: float

    def shown(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where values are drawn."""
        return np.maximum(values, self.lowest) if self.logarithmic else values

    def along(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return values as distances along the scale."""
        return np.log10(self.shown(values)) if self.logarithmic else values


def scale_of(curves: Sequence[Points], level: Mapping[Label, float] | None) -> Scale:
    """Return the scale of all curves and floors together.

    Logarithmic, where no value is negative and the largest is more than 30 times the smallest of
    those above its millionth part; then it ends a little below that smallest one.
    """
    values = np.concatenate([*(points.value for points in curves), [*(level or {}).values()]])
    values = values[np.isfinite(values)]
    if not len(values) or values.min() < 0 or values.max() == 0:
        return Scale(logarithmic=False, lowest=np.nan, highest=np.nan)
    highest = float(values.max())
    smallest = float(values[values > _DEEPEST * highest].min())
    if highest > _WIDEST_LINEAR * smallest:
        return Scale(
            logarithmic=True,
            lowest=smallest / _ROOM,
            highest=highest * _ROOM,
        )
    return Scale(logarithmic=False, lowest=0.0, highest=1.05 * highest)
