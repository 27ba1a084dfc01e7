"""A cubic curve that never overshoots, through each marker's own samples."""

from __future__ import annotations

from nodegraph_fill.pchip import pchip
from tests.plugins.nodegraph_fill.plain_fills import check_hermite


def slope(x: list[float], y: list[float], i: int) -> float:
    """The harmonic mean of the slopes beside an inner sample, or 0 at a turning point."""
    before = (y[i] - y[i - 1]) / (x[i] - x[i - 1])
    after = (y[i + 1] - y[i]) / (x[i + 1] - x[i])
    if before * after <= 0:
        return 0.0
    near, far = x[i] - x[i - 1], x[i + 1] - x[i]
    w1, w2 = 2 * far + near, far + 2 * near
    return (w1 + w2) / (w1 / before + w2 / after)


def test_equals_the_hermite_curve_of_harmonic_slopes() -> None:
    check_hermite(pchip, slope)
