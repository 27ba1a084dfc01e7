from __future__ import annotations

from importlib import import_module
from itertools import combinations, product
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from pandas import DataFrame

from nodegraph_compare.importance import effects, whole, winner_changes

NAN = np.nan


def table(*shape: int) -> Any:
    return np.random.default_rng(len(shape)).gamma(2, size=shape)


def test_each_effect_is_its_sum_of_squares_cell_by_cell() -> None:
    values = table(3, 4, 2)
    variances = effects(values)
    mean = values.mean()
    main = {axis: values.mean(axis=tuple({0, 1, 2} - {axis})) for axis in range(3)}
    for axis in range(3):
        assert variances[axis,] == pytest.approx(np.mean((main[axis] - mean) ** 2))
    for number, other in combinations(range(3), 2):
        (third,) = {0, 1, 2} - {number, other}
        both = values.mean(axis=third)
        message = [
            (both[i, j] - main[number][i] - main[other][j] + mean) ** 2
            for i, j in product(*map(range, both.shape))
        ]
        assert variances[number, other] == pytest.approx(np.mean(message))


def test_the_sums_of_squares_are_those_of_statsmodels() -> None:
    ols = import_module("statsmodels.formula.api").ols
    anova = import_module("statsmodels.stats.anova").anova_lm
    values = table(3, 4, 2)
    cells = [(f"a{i}", f"b{j}", f"c{k}", values[i, j, k]) for i, j, k in np.ndindex(3, 4, 2)]
    frame = DataFrame(cells, columns=["a", "b", "c", "y"])
    peer = anova(ols("y ~ a + b + c + a:b + a:c + b:c", frame).fit())["sum_sq"] / values.size
    variances = effects(values)
    expected = {"a": (0,), "b": (1,), "c": (2,), "a:b": (0, 1), "a:c": (0, 2), "b:c": (1, 2)}
    for name, sources in expected.items():
        assert variances[sources] == pytest.approx(peer[name])
    assert variances[()] == pytest.approx(peer["Residual"])


@given(
    arrays(np.float64, st.tuples(*[st.integers(1, 4)] * 3), elements=st.floats(-100, 100)),
)
def test_the_parts_add_up_to_the_variance(values: Any) -> None:
    variances = effects(values)
    assert min(variances.values()) >= 0
    assert sum(variances.values()) == pytest.approx(values.var(), abs=1e-8)


def test_an_axis_alone_explains_what_only_it_does() -> None:
    values = np.zeros((3, 4, 5)) + np.arange(4.0)[:, np.newaxis]
    variances = effects(values)
    assert variances[1,] == pytest.approx(1.25)
    assert sum(variances.values()) == pytest.approx(1.25)
    # neither does anything alone
    only_together = effects(np.array([[1.0, -1.0], [-1.0, 1.0]]))
    assert (only_together[0,], only_together[1,], only_together[0, 1]) == (0, 0, 1)
    assert effects(np.array([1.0, 3.0])) == {(0,): 1.0, (): 0.0}


def test_a_full_table_is_kept_whole() -> None:
    assert [value.tolist() for value in whole(table(2, 3))] == [[0, 1], [0, 1, 2]]


def test_what_is_missing_altogether_goes_first() -> None:
    values = table(4, 3, 2)
    values[:, 1] = NAN
    values[2] = NAN
    places = whole(values)
    assert [value.tolist() for value in places] == [[0, 1, 3], [0, 2], [0, 1]]


def test_the_label_with_the_largest_share_missing_goes() -> None:
    values = table(20, 3)
    values[[2, 5, 7], 1] = NAN
    values[9, 0] = NAN
    # a trial lacks a third of its cells, a method three of twenty
    assert [len(value) for value in whole(values)] == [16, 3]
    values[:12, 1] = NAN
    assert [len(value) for value in whole(values)] == [19, 2]


def test_nothing_at_all_leaves_nothing() -> None:
    assert 0 in [len(value) for value in whole(np.full((2, 3), NAN))]


@given(
    arrays(
        np.float64,
        st.tuples(*[st.integers(1, 5)] * 2),
        elements=st.sampled_from([1.0, 2.0, NAN]),
    )
)
def test_what_is_kept_is_never_missing(values: Any) -> None:
    places = whole(values)
    assert not np.isnan(values[np.ix_(*places)]).any()


def test_winner_changes_are_counted_pair_by_pair() -> None:
    values = table(4, 3, 5)
    winners = values.argmin(axis=0)
    pairs = [winners[i, k] != winners[j, k] for k in range(5) for i, j in combinations(range(3), 2)]
    assert winner_changes(values, 0, 1) == pytest.approx(np.mean(pairs))
    turned = np.moveaxis(values, 0, -1)
    assert winner_changes(turned, 2, 0) == pytest.approx(np.mean(pairs))


def test_one_label_changes_nothing_that_is_known() -> None:
    assert np.isnan(winner_changes(table(3, 1), 0, 1))
