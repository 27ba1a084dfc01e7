from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_mocap import Mask, Origin, Trajectories
from nodegraph_score.impulses import impulses
from nodegraph_tables import info_of
from tests.plugins.recordings import quietly

NAMES = ("brow", "cheek", "chin")


def spiked(seed: int, frames: int = 12) -> tuple[Trajectories, Trajectories, Mask]:
    """An estimate with samples of every origin, a truth with some missing, and hits."""
    random = np.random.default_rng(seed)
    shape = (frames, len(NAMES))
    truth = random.normal(size=(*shape, 3))
    estimate = truth + random.normal(size=truth.shape)
    origins = []
    for positions in (truth, estimate):
        origin = random.choice([0, 1, 1, 1, 2, 3], size=shape).astype(np.uint8)
        positions[origin == 0] = np.nan
        origins.append(origin)
    first, second = (
        Trajectories(positions=positions, markers=NAMES, rate=60.0, origin=origin)
        for positions, origin in zip((estimate, truth), origins[::-1], strict=True)
    )
    return first, second, Mask(hidden=random.random(shape) < 0.3, markers=NAMES)


def mean(values: list[float]) -> float:
    return sum(values) / len(values) if values else np.nan


def plainly(
    estimate: Trajectories, truth: Trajectories, mask: Mask, markers: list[int]
) -> dict[str, float]:
    """State the docstring's table with a loop over samples."""
    errors, hits, actual, wrong = [], [], [], []
    clean = repaired = 0
    for frame, marker in np.ndindex(truth.origin.shape):
        if marker not in markers or not estimate.origin[frame, marker]:
            continue
        if truth.origin[frame, marker] in (Origin.MISSING, Origin.REPAIRED):
            continue
        apart = estimate.positions[frame, marker] - truth.positions[frame, marker]
        error = float(np.sqrt((apart**2).sum()))
        marked = estimate.origin[frame, marker] == Origin.REPAIRED
        errors.append(error)
        repaired += bool(marked)
        if mask.hidden[frame, marker]:
            hits.append(error)
            actual += [error] * bool(marked)
        else:
            clean += 1
            wrong += [error] * bool(marked)
    return {
        "samples": len(errors),
        "hits": len(hits),
        "found": len(actual),
        "false positives": len(wrong),
        "rmse": mean([error**2 for error in errors]) ** 0.5,
        "error": mean(hits),
        "wrong": 100_000 * (len(hits) - len(actual) + len(wrong)) / (len(errors) or np.nan),
        "missed": 1 - len(actual) / len(hits) if hits else np.nan,
        "false positive rate": len(wrong) / clean if clean else np.nan,
        "change": mean(wrong),
        "recall": len(actual) / len(hits) if hits else np.nan,
        "precision": len(actual) / repaired if repaired else np.nan,
    }


@given(seed=st.integers(0, 10_000), frames=st.integers(1, 12))
def test_every_number_is_the_documented_one(seed: int, frames: int) -> None:
    values = spiked(seed, frames)
    take = quietly(impulses, *values)
    assert take["marker"].tolist() == ["all"]
    assert take.iloc[0].drop("marker").to_dict() == pytest.approx(
        plainly(*values, [0, 1, 2]), nan_ok=True
    )
    rows = quietly(impulses, *values, per="marker")
    assert rows["marker"].tolist() == list(NAMES)
    for marker in range(3):
        assert rows.iloc[marker].drop("marker").to_dict() == pytest.approx(
            plainly(*values, [marker]), nan_ok=True
        )


def clean(frames: int = 10) -> Trajectories:
    positions = np.random.default_rng(1).normal(size=(frames, len(NAMES), 3))
    return Trajectories(positions=positions, markers=NAMES, rate=60.0)


def repaired(recording: Trajectories, samples: list[tuple[int, int]], off: float) -> Trajectories:
    changed = np.zeros(recording.origin.shape, dtype=bool)
    changed[tuple(np.array(samples).T)] = True
    positions = recording.positions + np.where(changed, off, 0.0)[..., None] * [0.6, 0.0, 0.8]
    return recording.with_samples(positions, changed=changed, origin=Origin.REPAIRED)


def hits(*samples: tuple[int, int], frames: int = 10) -> Mask:
    hidden = np.zeros((frames, len(NAMES)), dtype=bool)
    for sample in samples:
        hidden[sample] = True
    return Mask(hidden=hidden, markers=NAMES)


def test_what_no_impulse_has_hit_is_reported() -> None:
    truth = clean()
    with pytest.warns(UserWarning, match="2 of 3 markers have no impulse"):
        table = impulses(truth, truth, hits((3, 0)), per="marker")
    assert list(info_of(table).notes) == [
        "2 of 3 markers have no impulse: no error, missed or recall."
    ]
    assert table["missed"].isna().tolist() == [False, True, True]
    with pytest.warns(UserWarning, match="no sample is hit by an impulse"):
        table = impulses(truth, truth, hits())
    assert table["rmse"].tolist() == [0.0]


def test_what_is_not_judged_is_reported() -> None:
    truth = repaired(clean(), [(2, 0)], 0.0)
    positions = truth.positions.copy()
    positions[4, 1] = np.nan
    estimate = replace(
        truth, positions=positions, origin=np.where(np.isnan(positions[..., 0]), 0, truth.origin)
    )
    with pytest.warns(UserWarning, match="not judged") as caught:
        table = impulses(estimate, truth, hits((2, 0), (6, 2)))
    assert [str(warning.message) for warning in caught] == [
        "1 samples that only the truth has are not judged (0 hit)",
        "1 samples called repaired in the truth already are not judged (1 hit)",
    ]
    assert table["samples"].tolist() == [28]
    assert table["hits"].tolist() == [1]


def test_a_row_that_there_is_not() -> None:
    with pytest.raises(ValueError, match="take or marker, got 'frame'"):
        impulses(clean(), clean(), hits(), per="frame")  # type: ignore[arg-type]
