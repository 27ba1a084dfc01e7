"""Principal components against plain statements of what they are."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_score.components import by_chance, explained, movement, principal


def test_components_are_eigenvectors_of_the_covariance() -> None:
    rng = np.random.default_rng(1)
    positions = rng.normal(0.0, 3.0, (50, 4, 3)) * np.arange(1.0, 5.0)[:, None] + 100.0
    components = principal(positions)
    flat = positions.reshape(50, 12)
    values = np.sort(np.linalg.eigvalsh(np.cov(flat.T, bias=True)))[::-1]
    np.testing.assert_allclose(components.sd**2, values, rtol=1e-9)
    np.testing.assert_allclose(components.shares, values / values.sum(), rtol=1e-9)
    rebuilt = (components.scores * components.sd * np.sqrt(50)) @ components.directions + flat.mean(
        axis=0
    )
    np.testing.assert_allclose(rebuilt, flat, atol=1e-9)


def test_rounding_is_no_component() -> None:
    face = np.random.default_rng(0).normal(0.0, 40.0, (6, 3)) + 1500.0
    along = np.sin(np.arange(30))[:, None, None] * np.array([1.0, 0.0, 0.0])
    assert len(principal(face + along).sd) == 1
    assert not len(principal(np.tile(face / 3.0, (30, 1, 1))).sd)


@pytest.mark.parametrize("shape", [(0, 5, 3), (1, 5, 3), (4, 0, 3)])
def test_nothing_has_no_components(shape: tuple[int, ...]) -> None:
    assert not len(principal(np.ones(shape)).sd)


def test_the_shares_of_two_parts_add_up_to_one() -> None:
    rng = np.random.default_rng(4)
    first, second = rng.normal(0.0, 2.0, (40, 5, 3)), rng.normal(0.0, 1.0, (40, 5, 3))
    components = principal(first + second)
    np.testing.assert_allclose(components.part_of(first) + components.part_of(second), 1.0)
    # by hand: the covariance of a component's scores with the part's, over the scores' variance
    flat = (first + second).reshape(40, 15)
    scores = (flat - flat.mean(axis=0)) @ components.directions[0]
    part = first.reshape(40, 15) @ components.directions[0]
    assert components.part_of(first)[0] == pytest.approx(
        np.cov(scores, part, bias=True)[0, 1] / np.var(scores)
    )


def test_r_squared_is_that_of_a_regression() -> None:
    rng = np.random.default_rng(2)
    numbers = rng.normal(0.0, 1.0, (60, 6)) * [1.0, 100.0, 1e-3, 1.0, 5.0, 2.0] + 7.0
    scores = rng.normal(0.0, 1.0, (60, 2)) + numbers[:, :2] * [1.0, 0.02]
    scores -= scores.mean(axis=0)
    unit = scores / np.linalg.norm(scores, axis=0)
    design = np.column_stack([np.ones(60), numbers])
    fit = design @ np.linalg.lstsq(design, scores, rcond=None)[0]
    expected = 1.0 - np.var(scores - fit, axis=0) / np.var(scores, axis=0)
    np.testing.assert_allclose(explained(unit, movement(numbers)), expected, rtol=1e-9)


def test_by_chance_is_every_shift_around_the_end() -> None:
    rng = np.random.default_rng(3)
    numbers, scores = rng.normal(size=(40, 6)), rng.normal(size=(40, 3))
    scores -= scores.mean(axis=0)
    scores /= np.linalg.norm(scores, axis=0)
    expected = [
        explained(scores, movement(np.roll(numbers, -shift, axis=0))) for shift in range(4, 37)
    ]
    actual = by_chance(scores, movement(numbers))
    # a shift one way and the same shift the other way are both there
    np.testing.assert_allclose(np.sort(actual, axis=0), np.sort(expected, axis=0), atol=1e-9)


def test_what_does_not_move_is_left_out() -> None:
    numbers = np.random.default_rng(5).normal(size=(30, 6))
    numbers[:, [0, 4]] = 3.0
    numbers[:, 5] = 2.0 * numbers[:, 1]
    actual = movement(numbers)
    assert actual.columns.tolist() == [1, 2, 3, 5]
    assert actual.basis.shape == (30, 3)
    assert actual.conclusive
    assert not movement(np.full((30, 6), 1e4 / 3.0)).conclusive


def test_as_many_numbers_as_frames_say_nothing() -> None:
    numbers = np.random.default_rng(6).normal(size=(8, 6))
    assert movement(numbers).conclusive
    assert not movement(numbers[:7]).conclusive
    assert not movement(numbers[:0]).conclusive
