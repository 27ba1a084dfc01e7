"""Some of the simulated cells, those that take a moment."""

from __future__ import annotations

import pytest

from tests.simulations.inference import QUICK, TOLERANCE, deviations


@pytest.mark.parametrize("name", QUICK)
def test_rates_are_those_that_are_expected(name: str) -> None:
    _, differences = deviations(name)
    assert max(map(abs, differences.values())) <= TOLERANCE
