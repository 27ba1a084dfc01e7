from __future__ import annotations

import numpy as np
import pytest

from nodegraph_synthesize.activation import Habits, activations, draw_habits
from nodegraph_synthesize.muscles import CHANNELS

_RATE = 60.0


def _habits(**changes: float) -> Habits:
    drawn = draw_habits(np.random.default_rng(0))
    return Habits(**{**vars(drawn), **changes})


def _played(seconds: float = 60.0, seed: int = 0, **changes: float) -> dict[str, np.ndarray]:
    random = np.random.default_rng(seed)
    values = activations(random, _habits(**changes), round(seconds * _RATE), _RATE)
    return dict(zip(CHANNELS, values.T, strict=True))


def test_activations_lie_between_0_and_1_and_all_muscles_act() -> None:
    for values in _played().values():
        assert values.min() >= 0.0
        assert 0.15 < values.max() <= 1.0


def _peaks(values: np.ndarray, height: float) -> int:
    inner = values[1:-1]
    return int(np.count_nonzero((inner > values[:-2]) & (inner >= values[2:]) & (inner > height)))


@pytest.mark.parametrize("syllables", [2.5, 4.0])
def test_the_jaw_opens_once_a_syllable(syllables: float) -> None:
    jaw = _played(syllables=syllables, silence=0.0)["jawOpen"]
    assert _peaks(jaw, 0.0) / 60.0 == pytest.approx(syllables, rel=0.2)


def test_speech_has_pauses() -> None:
    jaw = _played(seconds=300.0, silence=0.3)["jawOpen"]
    assert 0.1 < np.mean(jaw < 1e-6) < 0.5


def test_blinks_are_short_and_mostly_of_both_eyes() -> None:
    played = _played(seconds=300.0, blinks=0.4)
    left, right = played["orbicularisOculiLeft"] > 0.01, played["orbicularisOculiRight"] > 0.01
    starts = np.flatnonzero(np.diff(left.astype(int)) == 1)
    ends = np.flatnonzero(np.diff(left.astype(int)) == -1)
    lengths = (ends[: len(starts)] - starts[: len(ends)]) / _RATE
    assert 80 < len(starts) < 160
    assert lengths.min() > 0.1
    assert lengths.max() < 0.32
    assert np.mean(right[left]) > 0.85


@pytest.mark.parametrize("seed", range(4))
def test_both_eyes_blink_in_any_ten_seconds(seed: int) -> None:
    habits = draw_habits(np.random.default_rng(seed))
    played = activations(np.random.default_rng(seed), habits, 600, _RATE)
    eyes = [CHANNELS.index(f"orbicularisOculi{side}") for side in ("Left", "Right")]
    assert (played[:, eyes].min(axis=1) > 0.9).any()


@pytest.mark.parametrize(("seconds", "rest"), [(60.0, 0.3), (1.0, 0.1)])
def test_nothing_acts_in_the_rest_at_the_beginning(seconds: float, rest: float) -> None:
    values = np.stack(list(_played(seconds=seconds, silence=0.0).values()), axis=1)
    resting = np.arange(len(values)) / _RATE <= rest
    np.testing.assert_array_equal(values[resting], 0.0)
    assert values[~resting].max(axis=1).all()


@pytest.mark.parametrize(("frames", "rate"), [(2, 60.0), (3, 1000.0), (5, 0.5)])
def test_the_shortest_recordings(frames: int, rate: float) -> None:
    values = activations(np.random.default_rng(0), _habits(), frames, rate)
    assert values.shape == (frames, len(CHANNELS))
    assert np.isfinite(values).all()
