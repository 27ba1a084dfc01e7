"""What the figures of comparisons share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray


def turned(axis: Axes) -> None:
    """Turn the names along x, so that long ones do not meet."""
    axis.tick_params(axis="x", rotation=40)
    for text in axis.get_xticklabels():
        text.set(ha="right", rotation_mode="anchor")


def reach(
    mean: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return how far the bars go; an end that is not finite has none, or it would set the scale.

    Parameters
    ----------
    mean, low, high : (N,) arrays of float64

    Returns
    -------
    (2, N) array of float64
        Below and above the mean.
    """
    reach = np.stack([mean - low, high - mean])
    return np.where(np.isfinite(reach), np.clip(reach, 0.0, None), 0.0)


def without_drawing(why: str) -> Figure:
    """Return a figure with the reason why nothing is drawn."""
    figure = Figure(figsize=(4.2, 1.2))
    figure.text(0.5, 0.5, why, ha="center", va="center")
    return figure
