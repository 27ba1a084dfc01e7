from __future__ import annotations

import pytest

from nodegraph_files.units import millimetres_in, to_millimetres


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        ("mm", 1), ("MM ", 1), ("millimeters", 1), ("cm", 10), ("centimetre", 10), ("dm", 100),
        ("m", 1000), ("Metres", 1000), ("meter", 1000), ("in", 25.4), ("inches", 25.4),
        ("ft", 304.8), ("feet", 304.8), ("µm", 0.001),
    ],
)  # fmt: skip
def test_a_known_unit(unit: str, factor: float) -> None:
    assert to_millimetres(unit) == millimetres_in(unit) == factor


@pytest.mark.parametrize(("unit", "told"), [("px", "'px' is unknown"), (" ", "no unit")])
def test_an_unknown_unit_is_told(unit: str, told: str) -> None:
    assert millimetres_in(unit) is None
    with pytest.warns(UserWarning, match=f"{told}.*millimetres are assumed"):
        assert to_millimetres(unit) == 1.0
