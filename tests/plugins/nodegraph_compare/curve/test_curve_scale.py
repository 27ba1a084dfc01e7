from __future__ import annotations

import numpy as np
import pytest

from nodegraph_compare.curve.points import Points
from nodegraph_compare.curve.scale import Scale, scale_of


def points(*values: float) -> Points:
    value = np.array(values, dtype=float)
    nothing = np.full(len(value), np.nan)
    return Points(
        "a", ({},) * len(value), np.arange(len(value), dtype=float), value, nothing, nothing,
        count=np.ones(len(value), dtype=np.intp), without_x=0, without_value=0,
    )  # fmt: skip


def scale(*values: float, floor: float = np.nan) -> Scale:
    return scale_of([points(*values)], {"a": floor})


@pytest.mark.parametrize(
    ("result", "logarithmic"),
    [
        (scale(1.0, 30.0), False),
        (scale(1.0, 31.0), True),
        (scale(1.0, 20.0, floor=0.5), True),
        (scale(0.0, 20.0, 1.0), False),
        (scale(1e-9, 20.0, 1.0), False),
        (scale(-1.0, 1.0, 100.0), False),
        (scale(0.0, 0.0), False),
        (scale(np.nan), False),
        (scale(), False),
    ],
)
def test_logarithmic_where_positive_values_span_much(result: Scale, logarithmic: bool) -> None:
    assert result.logarithmic == logarithmic


def test_a_logarithmic_scale_shows_what_is_lower_on_its_edge() -> None:
    result = scale(1e-9, 0.0, 0.01, 1.0)
    assert result.lowest == pytest.approx(0.01 / 1.5)
    shown = result.shown(np.array([0.0, 0.005, 0.01, 1.0, np.nan]))
    assert shown[:4].tolist() == [result.lowest, result.lowest, 0.01, 1.0]
    assert np.isnan(shown[4])
    assert result.along(np.array([0.1, 0.0])) == pytest.approx([-1.0, np.log10(result.lowest)])


def test_a_linear_scale_starts_at_0_unless_something_is_negative() -> None:
    assert scale(1.0, 2.0) == Scale(logarithmic=False, lowest=0.0, highest=2.1)
    assert np.isnan(scale(-1.0, 2.0).lowest)
    value = np.array([-1.0, 2.0])
    assert scale(-1.0, 2.0).along(value) is value
