"""Scores of two recordings match by name, refuse what does not fit, and note what they warn of."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from pandas.testing import assert_frame_equal

from nodegraph import Across
from nodegraph_mocap import HeadMotion, Mask, Origin, Selection, Table, Trajectories, Weights
from nodegraph_score.calibration import calibration
from nodegraph_score.distance import distance
from nodegraph_score.gaps import gaps
from nodegraph_score.head_motion import head_motion
from nodegraph_score.impulses import impulses
from nodegraph_score.smoothness import smoothness
from nodegraph_score.steps import steps
from nodegraph_score.tracking import tracking
from nodegraph_score.unselected import unselected
from nodegraph_score.weights_mse import weights_mse
from nodegraph_tables import info_of
from tests.plugins.recordings import quietly

NAMES = ("brow", "cheek", "chin", "nose")
CHOSEN = Selection(chosen=("chin", "brow"))
MASK = Mask(hidden=np.random.default_rng(5).random((40, 4)) < 0.2, markers=NAMES)
TURNED = Mask(hidden=MASK.hidden[:, ::-1], markers=NAMES[::-1])

Score = Callable[[Trajectories, Trajectories, Mask], Table]
SCORES: dict[str, Score] = {
    "calibration": lambda estimate, truth, mask: calibration(estimate, truth, mask).table,
    "distance": lambda estimate, truth, _: distance(estimate, truth),
    "gaps": gaps,
    "impulses": lambda *inputs: impulses(*inputs, per="marker"),
    "smoothness": lambda estimate, truth, _: smoothness(estimate, truth),
    "steps": lambda estimate, truth, _: steps(
        Across.of({"start": truth, "end": estimate}, axis="stage"), truth
    ),
    "tracking": lambda estimate, truth, _: tracking(estimate, truth),
    "unselected": lambda estimate, truth, _: unselected(estimate, truth, CHOSEN),
}


def recording(seed: int = 0, frames: int = 40) -> Trajectories:
    random = np.random.default_rng(seed)
    origin = random.choice([Origin.MEASURED, Origin.REPAIRED], (frames, 4)).astype(np.uint8)
    return Trajectories(
        positions=random.normal(0, 20, (frames, 4, 3)),
        markers=NAMES,
        rate=60.0,
        origin=origin,
        sigma=random.uniform(0.5, 30, (frames, 4)),
    )


TRUTH = replace(recording(1), origin=np.full((40, 4), Origin.MEASURED, np.uint8))


def gappy(take: Trajectories) -> Trajectories:
    missing = np.zeros((40, 4), bool)
    missing[3:9, 1] = missing[:, 3] = True
    positions = np.where(missing[..., None], np.nan, take.positions)
    return take.with_samples(positions, changed=missing, origin=Origin.MISSING)


@pytest.mark.parametrize("name", sorted(set(SCORES) - {"tracking"}))
def test_markers_are_matched_by_name(name: str) -> None:
    score, estimate = SCORES[name], gappy(recording())
    expected = quietly(score, estimate, TRUTH, MASK)
    assert_frame_equal(quietly(score, estimate.keep(NAMES[::-1]), TRUTH, TURNED), expected)


@pytest.mark.parametrize("name", SCORES)
def test_what_is_warned_of_is_noted(name: str) -> None:
    with pytest.warns(UserWarning, match="[0-9]") as caught:
        table = SCORES[name](gappy(recording()), TRUTH, MASK)
    assert {f"{warning.message}." for warning in caught} <= set(info_of(table).notes)
    assert {warning.filename for warning in caught} == {__file__}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert not SCORES[name](TRUTH, TRUTH, MASK).empty


def weights(frames: int = 9, names: str = "ab") -> Weights:
    return Weights(values=np.zeros((frames, len(names))), names=tuple(names), rate=60.0)


OTHER = replace(TRUTH, markers=("w", "x", "y", "z"))
SHORT_MASK = Mask(hidden=MASK.hidden[:39], markers=NAMES)
PAIRED = ("gaps", "impulses", "smoothness", "calibration")
UNFIT = [
    *(
        (name, recording(0, 39), MASK, "has 39 frames, the (truth has|reference) 40")
        for name in SCORES
    ),
    *(
        (name, replace(TRUTH, rate=50.0), MASK, "50 Hz, the truth has 60")
        for name in ("smoothness", "steps")
    ),
    *(
        (
            name,
            replace(TRUTH, markers=("ear", *NAMES[1:])),
            MASK,
            "estimate lacks brow; has besides ear",
        )
        for name in PAIRED
    ),
    *(
        (name, OTHER, MASK, "no marker (is in both: estimate has|of the truth: it has) w, x, y, z")
        for name in ("distance", "unselected", "steps")
    ),
    *(
        (name, TRUTH, SHORT_MASK, "has 39 frames, the truth has 40")
        for name in ("gaps", "impulses", "calibration")
    ),
    *(
        (name, TRUTH, replace(MASK, markers=OTHER.markers), "lacks brow, ch.*; has besides w")
        for name in ("gaps", "impulses", "calibration")
    ),
]


@pytest.mark.parametrize(("name", "estimate", "mask", "message"), UNFIT)
def test_recordings_that_do_not_fit_are_refused(
    name: str, estimate: Trajectories, mask: Mask, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        SCORES[name](estimate, TRUTH, mask)


def test_weights_and_head_motions_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match="estimate has 9 frames, the reference 8"):
        weights_mse(weights(), weights(8))
    with pytest.raises(ValueError, match="no shape is in both: estimate has a, b, reference x, y"):
        weights_mse(weights(), weights(9, "xy"))
    with pytest.raises(ValueError, match="estimate has 9 frames, the truth has 10"):
        head_motion(HeadMotion.still(9), HeadMotion.still(10))
