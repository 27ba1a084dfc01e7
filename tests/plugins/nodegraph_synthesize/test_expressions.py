from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from nodegraph_synthesize.expressions import EXPRESSIONS, Held, held_expressions
from nodegraph_synthesize.muscles import CHANNELS, JAW

_RATE = 60.0


def _held(seed: int = 0, seconds: float = 60.0, lopsided: float = 0.0) -> Held:
    random = np.random.default_rng(seed)
    return held_expressions(random, lopsided, round(seconds * _RATE), _RATE)


def _runs(active: np.ndarray) -> np.ndarray:
    """Return the lengths of the runs of True that begin and end within, in seconds."""
    steps = np.diff(active.astype(int))
    ends = np.flatnonzero(steps == -1)
    starts = np.flatnonzero(steps == 1)
    return np.asarray((ends - starts[: len(ends)]) / _RATE)


@pytest.mark.parametrize("seed", range(4))
def test_levels_lie_between_0_and_1_and_every_take_begins_and_pauses_at_0(seed: int) -> None:
    held = _held(seed)
    assert held.levels.min() == held.hush.min() == 0.0
    assert 0.8 < held.levels.max() <= 1.0
    assert 0.8 < held.hush.max() <= 1.0
    np.testing.assert_array_equal(held.levels[: round(0.4 * _RATE)], 0.0)
    assert np.mean(held.levels.max(axis=1) == 0.0) > 0.03


def test_expressions_last_for_seconds_and_are_as_smooth_as_muscles() -> None:
    held = _held(seconds=300.0)
    lengths = _runs(held.levels.max(axis=1) > 0.0)
    assert len(lengths) > 80
    # Onset, apex and offset, and what one muscle is later than another.
    assert lengths.min() > 1.1
    assert lengths.max() < 3.4
    assert np.abs(np.diff(held.levels, axis=0)).max() * _RATE < 6.0


def test_all_come_before_one_comes_back_and_open_mouths_alternate_with_closed_ones() -> None:
    held = _held(seconds=120.0)
    starts = np.flatnonzero(np.diff((held.levels.max(axis=1) > 0.0).astype(int)) == 1)
    names = [_name(held.levels[start : start + 150]) for start in starts[:-1]]
    opened = [JAW in EXPRESSIONS[name] for name in names]
    assert all(first != other for first, other in pairwise(opened))
    assert set(names) == set(EXPRESSIONS)
    of_kind = [name for name in names if JAW not in EXPRESSIONS[name]]
    count = sum(JAW not in muscles for muscles in EXPRESSIONS.values())
    assert len(set(of_kind[:count])) == count


def _name(levels: np.ndarray) -> str:
    """Return the expression whose muscles are those that act in the first 0.6 s."""
    active = levels[:36].max(axis=0) > 0.0
    for name, muscles in EXPRESSIONS.items():
        kinds = [any(channel.startswith(muscle) for muscle in muscles) for channel in CHANNELS]
        if np.array_equal(active, kinds):
            return name
    raise AssertionError(np.array(CHANNELS)[active])


def test_some_expressions_hush_the_actor_and_some_do_not() -> None:
    held = _held(seconds=300.0)
    acting = held.levels.max(axis=1) > 0.5
    assert 0.2 < np.mean(held.hush[acting] == 0.0) < 0.6
    assert not held.hush[: round(0.4 * _RATE)].any()
