"""A cubic curve of local slopes, through each marker's own samples."""

from __future__ import annotations

from nodegraph_fill.akima import akima
from tests.plugins.nodegraph_fill.plain_fills import check_hermite


def slope(x: list[float], y: list[float], i: int) -> float:
    """Akima's mean of the chords beside a sample that has two others on each side."""
    m1, m2, m3, m4 = ((y[i + k + 1] - y[i + k]) / (x[i + k + 1] - x[i + k]) for k in range(-2, 2))
    after, before = abs(m4 - m3), abs(m2 - m1)
    return (m2 + m3) / 2 if after + before == 0 else (after * m2 + before * m3) / (after + before)


def test_equals_the_hermite_curve_of_akimas_slopes() -> None:
    check_hermite(akima, slope)
