"""The steps of the analysis, the head motion that they undo, and what cannot be aligned."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from nodegraph import Refusal
from nodegraph_align.poses import Scale
from nodegraph_align.procrustes import STEPS, Step, procrustes
from nodegraph_mocap import HeadMotion, Trajectories
from tests.plugins.nodegraph_align.heads import make_head, make_recording, run_moved
from tests.plugins.recordings import quietly

Array = NDArray[np.float64]
X = [[1.0, 1.0, 0.0], [1.0, 2.0, 0.0], [3.0, 2.0, 0.0]]
Y = [[-3.0, -2.0, 0.0], [-3.0, -4.0, 0.0], [-7.0, -4.0, 0.0]]
PREFIXES = [STEPS[:count] for count in range(4)]
SCALES = get_args(Scale)


def restored(aligned: Trajectories, motion: HeadMotion) -> Array:
    """``s R aligned + t``, plainly."""
    turned = np.einsum("tij,tmj->tmi", motion.rotations, aligned.positions)
    return np.asarray(motion.scales[:, None, None] * turned + motion.translations[:, None])


@pytest.mark.parametrize(
    ("steps", "expected"), [*zip(PREFIXES, [213.0, 30.0, 12.0, 0.0], strict=True)]
)
def test_worked_example(steps: tuple[Step, ...], expected: float) -> None:
    aligned = procrustes(
        make_recording([Y]), make_recording([X], stable=3), steps=steps, scale="rms", restore=False,
        landmarks=("m0", "m1", "m2"),
    )  # fmt: skip
    squared = ((aligned.aligned.positions - aligned.reference.positions) ** 2).sum()
    assert squared == pytest.approx(expected, abs=1e-12)


@given(
    steps=st.sampled_from(PREFIXES),
    scale=st.sampled_from(SCALES),
    restore=st.booleans(),
    seed=st.integers(0, 2**32 - 1),
)
def test_captured_is_what_head_motion_makes_of_aligned(
    steps: tuple[Step, ...], scale: Scale, restore: bool, seed: int
) -> None:
    random = np.random.default_rng(seed)
    rest, motion = make_head(frames=12, seed=seed % 1000)
    motion = replace(motion, scales=random.uniform(0.3, 3.0, 12))
    positions = run_moved(rest, motion).positions + random.normal(0, 3, (12, 12, 3))
    positions[random.random((12, 12)) < 0.3] = np.nan
    take = make_recording(positions)
    aligned = quietly(procrustes, take, rest, steps=steps, scale=scale, restore=restore)
    np.testing.assert_allclose(restored(aligned.aligned, aligned.head_motion), positions, atol=1e-9)
    np.testing.assert_array_equal(aligned.aligned.origin, take.origin)


@pytest.mark.parametrize("scale", ["rms", "least_squares"])
def test_a_rigid_head_is_brought_home_and_its_motion_found(scale: Scale) -> None:
    rest, motion = make_head(frames=40)
    for scales, how in ((np.ones(40), "none"), (np.linspace(0.5, 2.0, 40), scale)):
        message = replace(motion, scales=scales)
        aligned = procrustes(run_moved(rest, message), rest, scale=how)
        home = np.repeat(rest.positions, 40, axis=0)
        np.testing.assert_allclose(aligned.aligned.positions, home, atol=1e-9)
        np.testing.assert_allclose(aligned.head_motion.rotations, message.rotations, atol=1e-12)
        np.testing.assert_allclose(
            aligned.head_motion.translations, message.translations, atol=1e-8
        )
        np.testing.assert_allclose(aligned.head_motion.scales, scales, rtol=1e-12)
        np.testing.assert_array_equal(aligned.reference.positions, rest.positions)


def test_only_landmarks_decide_and_all_points_are_moved() -> None:
    rest, motion = make_head(frames=15)
    take = run_moved(rest, motion)
    positions = take.positions + np.where(
        np.arange(12)[:, None] < 6, 0.0, np.random.default_rng(0).normal(0, 20, (15, 12, 3))
    )
    aligned = procrustes(replace(take, positions=positions), rest)
    expected = np.einsum("tji,tmj->tmi", motion.rotations, positions - motion.translations[:, None])
    np.testing.assert_allclose(aligned.aligned.positions, expected, atol=1e-9)


def test_each_step_does_what_it_says() -> None:
    random = np.random.default_rng(3)
    take = make_recording(random.normal(0, 50, (4, 8, 3)) + 300.0, stable=5)
    rest = make_recording(random.normal(0, 50, (1, 8, 3)), stable=5)

    def stage(count: int, **more: Any) -> Array:
        return procrustes(take, rest, steps=STEPS[:count], **more).aligned.positions

    x, y = take.positions, rest.positions[0]
    middles, goal = x[:, :5].mean(axis=1, keepdims=True), y[:5].mean(axis=0)
    np.testing.assert_array_equal(stage(0), x)
    np.testing.assert_allclose(stage(1), x - middles + goal, atol=1e-10)
    np.testing.assert_allclose(stage(1, restore=False), x - middles, atol=1e-10)
    sizes = np.sqrt(((x - middles)[:, :5] ** 2).sum(axis=(1, 2)) / 5)[:, None, None]
    size = np.sqrt(((y[:5] - goal) ** 2).sum() / 5)
    unit = stage(2, scale="rms", restore=False)
    np.testing.assert_allclose(unit, (x - middles) / sizes, atol=1e-12)
    np.testing.assert_allclose(stage(2, scale="rms"), unit * size + goal, atol=1e-10)
    np.testing.assert_allclose(stage(2), stage(1), atol=1e-10)
    np.testing.assert_allclose(
        stage(2, scale="least_squares") - goal,
        (stage(1) - goal)
        / procrustes(take, rest, scale="least_squares").head_motion.scales[:, None, None],
        atol=1e-10,
    )


@pytest.mark.parametrize(
    ("steps", "scale", "unit"),
    [((), "rms", None), (STEPS[:1], "rms", 1.0), (STEPS, "none", 1.0), (STEPS, "rms", 0.0)],
)
def test_reference_goes_through_the_same(
    steps: tuple[Step, ...], scale: Scale, unit: float | None
) -> None:
    random = np.random.default_rng(4)
    positions = random.normal(100, 50, (1, 8, 3))
    rest = make_recording(positions, stable=5, sigma=np.full((1, 8), 0.5))
    aligned = procrustes(rest, rest, steps=steps, scale=scale, restore=False).reference
    middle = positions[0, :5].mean(axis=0)
    size = unit or np.sqrt(((positions[0, :5] - middle) ** 2).sum(axis=1).mean())
    expected = positions if unit is None else (positions - middle) / size
    np.testing.assert_allclose(aligned.positions, expected, atol=1e-12)
    assert aligned.sigma is not None
    np.testing.assert_allclose(aligned.sigma, 0.5 if unit is None else 0.5 / size)


def test_markers_are_matched_by_name() -> None:
    rest, motion = make_head(frames=8)
    take = run_moved(rest, motion)
    expected = procrustes(take, rest).aligned
    other = procrustes(take, rest.keep(rest.markers[::-1])).aligned
    np.testing.assert_allclose(other.positions, expected.positions, atol=1e-10)
    shuffled = procrustes(take.keep(("m5", "m9", "m3", "m0", "m1", "m2", "m4")), rest).aligned
    np.testing.assert_allclose(
        shuffled.positions, expected.keep(shuffled.markers).positions, atol=1e-10
    )


def test_missing_landmarks() -> None:
    rest, motion = make_head(frames=4)
    positions = run_moved(rest, motion).positions.copy()
    positions[1, [0, 4]] = positions[2, :4] = positions[3] = np.nan
    take = make_recording(positions)
    with pytest.warns(UserWarning, match=r"1 of 4 frames [(]first 1[)] aligned by fewer .* 2 of 4"):
        aligned = procrustes(take, rest)
    home = np.where(np.isnan(positions), np.nan, rest.positions)
    np.testing.assert_allclose(aligned.aligned.positions[:2], home[:2], atol=1e-9)
    np.testing.assert_array_equal(aligned.aligned.positions[2:], positions[2:])
    np.testing.assert_array_equal(aligned.head_motion.rotations[2:], [np.eye(3)] * 2)


def test_a_missing_landmark_does_not_shift_the_face() -> None:
    rest, motion = make_head(frames=2)
    positions = run_moved(rest, motion).positions.copy()
    positions[1, 0] = np.nan
    take = make_recording(positions)
    for steps in PREFIXES[1:]:
        with pytest.warns(UserWarning, match="aligned by fewer"):
            aligned = procrustes(take, rest, steps=steps, restore=False, scale="rms")
        if steps == STEPS:
            apart = aligned.aligned.positions[:, 1:] - aligned.reference.positions[:, 1:]
            np.testing.assert_allclose(apart, 0.0, atol=1e-11)


@pytest.mark.parametrize("reflection", [False, True])
def test_mirrored_landmarks(reflection: bool) -> None:
    rest, motion = make_head(frames=3)
    take = run_moved(rest, motion)
    take = replace(take, positions=take.positions * [-1.0, 1.0, 1.0])
    if reflection:
        aligned = procrustes(take, rest, reflection=True)
        home = np.repeat(rest.positions, 3, axis=0)
        np.testing.assert_allclose(aligned.aligned.positions, home, atol=1e-9)
    else:
        with pytest.warns(UserWarning, match="3 of 3 frames .* have left and right changed places"):
            aligned = procrustes(take, rest)
    sign = -1.0 if reflection else 1.0
    np.testing.assert_allclose(np.linalg.det(aligned.head_motion.rotations), sign)


def test_whatever_cannot_be_aligned_says_so() -> None:
    random = np.random.default_rng(5)
    good = make_recording(random.normal(0, 50, (1, 6, 3)))
    nowhere = make_recording(np.full((3, 6, 3), np.nan))
    for bad in (
        nowhere,
        make_recording(np.full((3, 6, 3), 7.0)),
        make_recording(np.empty((0, 6, 3))),
    ):
        for scale in SCALES:
            with pytest.raises(Refusal):
                procrustes(bad, good, scale=scale)
            with pytest.raises(Refusal):
                procrustes(good, bad, scale=scale)
            with pytest.raises(Refusal):
                procrustes(bad, scale=scale)


@pytest.mark.parametrize("steps", [("rotate",), ("scale", "translate"), (*STEPS, "translate")])
def test_steps_that_are_no_prefix(steps: tuple[Step, ...]) -> None:
    with pytest.raises(ValueError, match="steps must be the first ones of translate, scale, rot"):
        procrustes(make_recording(np.zeros((1, 6, 3))), steps=steps)
