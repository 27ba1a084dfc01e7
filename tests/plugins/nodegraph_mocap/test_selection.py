"""A selection holds what it says, and nothing that contradicts itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nodegraph_mocap import Selection
from nodegraph_mocap.specimens import recordings, selections

PAIRS = (("l", "r"), ("m",))


def test_what_is_known_is_kept_read_only() -> None:
    result = Selection(
        chosen=("m", "r"),
        pairs=PAIRS,
        frequencies=np.array([0.5, 1.0]),
        columns=("k", "markers"),
        history=np.array([[5.0, 2.0], [6.0, np.nan]]),
    )
    assert result.chosen == ("m", "r")
    assert result.frequencies is not None
    assert result.history is not None
    assert not result.frequencies.flags.writeable
    assert not result.history.flags.writeable


def test_markers_alone_are_enough() -> None:
    result = Selection(chosen=("a",))
    assert (result.pairs, result.frequencies, result.history) == ((), None, None)


@pytest.mark.parametrize(
    ("fields", "what"),
    [
        ({"chosen": ("m", "m")}, "chosen markers: named twice: m"),
        ({"chosen": ("x", "m")}, "chosen, but in no pair: x"),
        ({"pairs": (("m",), ("m",))}, "pairs: named twice: m"),
        ({"pairs": (("m",), ())}, "pairs: number 1 holds no marker"),
        ({"frequencies": np.array([1.0])}, r"frequencies: must be \(2\)"),
        ({"frequencies": np.array([1.0, 1.5])}, "must be shares, 0 to 1"),
        ({"frequencies": np.array([1.0, np.nan])}, "missing"),
        ({"columns": ("k",)}, "columns k without a history"),
        ({"columns": ("k",), "history": np.zeros((3, 2))}, r"history: must be \(rows, 1\)"),
    ],
)
def test_contradictions(fields: dict[str, Any], what: str) -> None:
    with pytest.raises(ValueError, match=what):
        Selection(**{"chosen": ("m",), "pairs": PAIRS, **fields})


def test_specimens_choose_markers_of_the_recordings_of_their_names() -> None:
    for name, value in selections().items():
        assert set(value.chosen) <= set(recordings()[name].markers)
