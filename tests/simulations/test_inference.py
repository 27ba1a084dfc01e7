"""Some of the simulated cells, those that take a moment."""

from __future__ import annotations

import pytest

from tests.simulations.inference import QUICK, beyond


@pytest.mark.usefixtures("without_pictures")
@pytest.mark.parametrize("name", QUICK)
def test_rates_are_within_their_bounds(name: str) -> None:
    rates, off = beyond(name, QUICK[name])
    assert not off, rates
