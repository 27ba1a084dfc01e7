from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from pandas.testing import assert_frame_equal

from nodegraph import Across, Label
from nodegraph_compare.curve.node import curve
from nodegraph_compare.ranks.node import ranks
from nodegraph_compare.table.node import table
from nodegraph_compare.ties import ROUNDING, apart, at_most, settled, tied
from nodegraph_mocap import Table
from nodegraph_tables import info_of

pytestmark = pytest.mark.usefixtures("without_pictures")

NAN = np.nan
NOISE = (1e-15, -1e-15, 1e-12, -1e-12)
MAGNITUDES = st.floats(1e-3, 1e3)


def study(noise: float, *, names: str = "abcd") -> Across[Table]:
    """Twelve trials: b is a but for rounding, c and d are behind both, in the order of `names`."""
    a = np.random.default_rng(0).gamma(2, size=(12, 3)) + 0.1
    values = {"a": a, "b": a * (1 + noise), "c": a + 0.5, "d": a + 0.7}
    entries: list[tuple[dict[str, Label], Table]] = [
        ({"trial": trial, "fill": name}, pd.DataFrame({"gap": range(3), "rmse": row}))
        for trial in range(12)
        for name in names
        for row in [values[name][trial]]
    ]
    return Across(("trial", "fill"), tuple(entries))


@pytest.mark.parametrize("noise", NOISE)
@pytest.mark.parametrize("baseline", ["a", "b", "d"])
def test_a_table_of_methods_that_rounding_distinguishes_is_that_of_equal_ones(
    noise: float, baseline: str
) -> None:
    for better in ("lower", "higher"):
        result, peer = (
            table(study(noise), baseline=baseline, better=better).table for noise in (noise, 0.0)
        )
        assert_frame_equal(result, peer, check_exact=True)
        assert info_of(result) == info_of(peer)
        assert len(info_of(result).answer.lines) == 4


@pytest.mark.parametrize("noise", [0.0, *NOISE])
@pytest.mark.parametrize("names", ["abcd", "cbad"])
def test_methods_that_rounding_distinguishes_share_what_is_best(noise: float, names: str) -> None:
    frame = table(study(noise, names=names), baseline="c").table
    first = " and ".join(value for value in names if value in "ab")
    sentence = info_of(frame).answer.lines[0]
    assert sentence.startswith(f"{first} are best (")
    assert "; every other is clearly behind, by 24\N{NO-BREAK SPACE}% or more." in sentence
    assert info_of(frame).best == {"mean": (0, 1)}
    first_two = frame.set_index("fill").loc[["a", "b"]].to_numpy()
    assert np.array_equal(first_two[0], first_two[1])
    against = table(study(noise, names=names), baseline="a").table.set_index("fill")
    assert list(against.loc["b", ["ratio", "p", "g", "wins"]]) == [1, 1, 0, "0/12"]


@pytest.mark.parametrize("noise", NOISE)
@pytest.mark.parametrize("test", ["nemenyi", "wilcoxon_holm"])
@pytest.mark.parametrize("names", ["abcd", "cbad"])
def test_methods_that_rounding_distinguishes_rank_alike(
    noise: float, test: Any, names: str
) -> None:
    result, peer = (ranks(study(noise, names=names), test=test) for noise in (noise, 0.0))
    assert result.table["mean rank"].tolist() == [1.5, 1.5, 3.0, 4.0]
    assert result.table["fill"].tolist() == peer.table["fill"].tolist()
    assert_frame_equal(result.pairs, peer.pairs, check_exact=True)
    assert_frame_equal(result.overall, peer.overall, check_exact=True)
    assert info_of(result.table).answer.lines == info_of(peer.table).answer.lines


@pytest.mark.parametrize("sign", [1, -1])
def test_what_is_a_millionth_apart_counts(sign: int) -> None:
    result = ranks(study(sign * 1e-6))
    assert result.table["mean rank"].tolist() == [1.0, 2.0, 3.0, 4.0]
    first = "b" if sign < 0 else "a"
    assert info_of(table(study(sign * 1e-6)).table).answer.lines[0].startswith(f"{first} ")


def sweep(*values: float) -> Across[Table]:
    frame = pd.DataFrame({"markers": np.arange(len(values)), "mse": np.array(values)})
    return Across.of({"ME": frame}, axis="actor")


@pytest.mark.parametrize("noise", [0.0, *NOISE])
def test_rounding_makes_no_minimum_no_knee_and_reaches_the_floor(noise: float) -> None:
    level = Across.of({"ME": pd.DataFrame({"mse": [0.3 * (1 - noise)]})}, axis="actor")
    values = (0.9, 0.5 * (1 + noise), 0.5, 0.5, 0.3 * (1 + noise), 0.4)
    frame = curve(sweep(*values), level, x="markers", metric="mse", mark="minimum").table
    assert frame["local minimum"].tolist() == [False] * 4 + [True, False]
    assert frame["below floor"].tolist() == [False] * 4 + [True, False]
    assert "not reached)." in info_of(frame).answer.lines[-1]  # more markers are above it again
    falling = sweep(0.9, 0.5 * (1 + noise), 0.5, 0.3 * (1 + noise))
    reaching = curve(falling, level, x="markers", metric="mse", mark="minimum").table
    assert "reached at 3)." in info_of(reaching).answer.lines[-1]
    flat = curve(
        sweep(0.3, 0.2 * (1 + noise), 0.1), x="markers", metric="mse", mark="minimum"
    ).table
    assert flat["marked"].tolist() == [""] * 3


def test_errors_of_rounding_alone_are_one_beside_others() -> None:
    frame = curve(sweep(30.0, 1.0, 2e-31, 0.0, 5e-31, 1e-30), x="markers", metric="mse").table
    assert not frame["local minimum"].any()


def test_equal_numbers_become_the_first_and_others_stay_as_they_are() -> None:
    values = np.array([[0.1 + 0.2, 0.3, 7.0], [1 / 3, NAN, 1 / 3 + 1e-16], [2.0, 2.0 + 1e-8, 2.0]])
    assert tied(values)[0].tolist() == [0.1 + 0.2, 0.1 + 0.2, 7.0]
    assert tied(values)[1] == pytest.approx([1 / 3, NAN, 1 / 3], abs=0, nan_ok=True)
    assert tied(values)[2].tolist() == [2.0, 2.0 + 1e-8, 2.0]


def test_a_failure_in_one_block_makes_no_others_equal() -> None:
    values = np.array([[1.0, 1.001, 1e15], [1.0, 1.1, 3.0], [2.0, 2.5, 3.0]])
    assert np.array_equal(tied(values), values)


def test_numbers_of_rounding_alone_equal_nothing_beside_usual_ones() -> None:
    values = np.array([[0.0, 1e-31, 30.0], [1e-13, 0.0, 20.0], [0.0, 1e-3, 25.0]])
    assert tied(values).tolist() == [[0.0, 0.0, 30.0], [1e-13, 1e-13, 20.0], [0.0, 1e-3, 25.0]]


@pytest.mark.parametrize("values", [np.empty((0, 3)), np.empty((2, 0)), np.full((2, 3), NAN)])
def test_nothing_to_compare_stays_nothing(values: NDArray[np.float64]) -> None:
    assert np.array_equal(tied(values), values, equal_nan=True)
    assert np.array_equal(apart(values, values), values, equal_nan=True)


@given(
    arrays(np.float64, st.tuples(st.integers(1, 4), st.integers(1, 6)), elements=MAGNITUDES),
    st.data(),
)
def test_noise_changes_no_order_wherever_the_values_lie(
    values: NDArray[np.float64], data: st.DataObject
) -> None:
    """Also on numbers on which a grid would have its borders."""
    eps = data.draw(arrays(np.float64, values.shape, elements=st.sampled_from([-1e-12, 0, 1e-12])))
    twice = np.concatenate([values, values * (1 + eps)], axis=1)
    result = tied(twice)
    count = values.shape[1]
    assert np.array_equal(result[:, :count], result[:, count:])
    assert np.abs(result - twice).max() <= ROUNDING * 1e3


@given(
    arrays(
        np.float64, st.integers(1, 200), elements=st.integers(0, 300).map(lambda at: 1 + at / 3e10)
    )
)
def test_many_close_values_do_not_run_into_one(values: NDArray[np.float64]) -> None:
    result = settled(values, values)
    assert np.abs(result - values).max() <= 1.01 * ROUNDING
    order = np.argsort(values, kind="stable")
    assert (np.diff(result[order])[np.diff(values[order]) == 0] == 0).all()


def test_a_set_of_values_is_settled_alike_whole_and_in_parts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    values = np.random.default_rng(0).integers(1, 5, size=(50, 4)) / 3.0
    whole = tied(values * (1 + 1e-15))
    monkeypatch.setattr("nodegraph_compare.ties._AT_ONCE", 7)
    assert np.array_equal(tied(values * (1 + 1e-15)), whole)


def test_equal_differences_have_one_size() -> None:
    first, second = np.array([0.3, 0.2, 0.6, 1.0, 2.0]), np.array([0.2, 0.1, 0.7, 1 + 1e-13, 2.1])
    differences = apart(first, second)
    assert len(set(np.abs(differences))) == 2
    assert np.sign(differences).tolist() == [1, 1, -1, 0, -1]
    assert differences == pytest.approx(first - second, abs=1e-12)


def test_differences_are_measured_by_what_they_are_differences_of() -> None:
    # 1e-5 beside a thousand is not a rounding; beside it, the differences of small values count too
    first = np.array([1000.0, 1e-3, 5.0])
    differences = apart(first, first - np.array([1e-5, 1e-9, 1e-7]))
    assert (differences > 0).all()
    assert len(set(differences)) == 3


def test_a_level_is_reached_up_to_rounding() -> None:
    values = np.array([0.1 + 0.2, 0.3, 0.3 + 1e-8, NAN])
    assert at_most(values, 0.3).tolist() == [True, True, False, False]
    assert not at_most(values, NAN).any()
