"""Settings of plain calls are what a graph's must be."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nodegraph_select.checks import check_share, check_whole


@pytest.mark.parametrize("value", [3, 4, np.int64(7)])
def test_whole_numbers_that_are_large_enough(value: int) -> None:
    check_whole("runs", value, 3)


@pytest.mark.parametrize("value", [2, -1, 3.0, 3.5, np.nan, "3", None])
def test_what_is_no_such_number(value: Any) -> None:
    with pytest.raises(ValueError, match=r"^runs must be a whole number from 3 on, got "):
        check_whole("runs", value, 3)


@pytest.mark.parametrize("value", [1e-300, 0.5, 1, 1.0])
def test_shares(value: float) -> None:
    check_share("variance", value)


@pytest.mark.parametrize("value", [0.0, -0.1, 1.0 + 1e-9, np.inf, np.nan])
def test_what_is_no_share(value: float) -> None:
    with pytest.raises(ValueError, match=r"^variance must be above 0 and at most 1, got "):
        check_share("variance", value)
