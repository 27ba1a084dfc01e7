"""What selections refuse, in plain calls as in a graph, and that rounding ranks none."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_mocap import Selection, Trajectories
from nodegraph_select.checks import check_share, check_whole
from nodegraph_select.greedy import greedy
from nodegraph_select.qr import qr
from nodegraph_select.variance import variance
from tests.plugins.nodegraph_select.faces import make_rigid

Select = Callable[..., Selection]


@pytest.mark.parametrize("select", [greedy, qr, variance])
def test_bad_input(face: Trajectories, select: Select) -> None:
    with pytest.raises(Refusal, match="k = 12 markers cannot be chosen of 11"):
        select(face, k=12)
    with pytest.raises(ValueError, match="k must be a whole number from 1 on, got 0"):
        select(face, k=0)
    with pytest.raises(Refusal, match="no marker moves in 90 frames"):
        select(make_rigid(face), k=2)


@pytest.mark.parametrize("select", [greedy, qr])
def test_rounding_chooses_no_marker(face: Trajectories, select: Select) -> None:
    """Of what does not move, none is ahead of the others but by its name."""
    positions = make_rigid(face).positions.copy()
    positions[:, face.markers.index("nose")] += 1e-4 * face.positions[:, 3]
    positions[:, face.markers.index("lip_left")] += 1e-4 * face.positions[:, 5]
    with pytest.warns(UserWarning, match="2 of the 3 pairs chosen determine all markers"):
        selection = select(replace(face, positions=positions), k=5)
    assert selection.chosen == ("lip_left", "lip_right", "brow_left", "brow_right", "nose")


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
