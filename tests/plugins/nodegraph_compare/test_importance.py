from __future__ import annotations

import io
from typing import Any

import numpy as np
import pandas as pd
import pytest

from nodegraph import Absent, Across
from nodegraph_compare.importance import HIGHER, importance
from nodegraph_tables import info_of

NAN = np.nan


def study(make: Any, trials: int = 4, lengths: tuple[int, ...] = (5, 45)) -> Any:
    entries = [
        (
            {"trial": trial, "length": length, "fill": fill},
            pd.DataFrame({"gap": [0, 1], "rmse": make(trial, length, fill) + np.array([0.0, 2.0])}),
        )
        for trial in range(trials)
        for length in lengths
        for fill in ("lin", "cubic", "akima")
    ]
    return Across(("trial", "length", "fill"), tuple(entries))


def by_source(result: Any) -> Any:
    return result.table.set_index("source")


def test_an_axis_that_does_everything_explains_everything() -> None:
    sources = by_source(importance(study(lambda trial, length, fill: float(length))))
    assert sources.loc["length", "eta squared"] == pytest.approx(1.0)
    assert sources.loc["length", "partial eta squared"] == pytest.approx(1.0)
    assert sources.loc["length", "variance"] == pytest.approx(400.0)
    assert sources.drop("length")["eta squared"].to_numpy() == pytest.approx(0.0)
    assert sources.index.tolist() == [
        "trial", "length", "fill", "trial x length", "trial x fill", "length x fill", HIGHER,
    ]  # fmt: skip


def test_shares_add_up_and_the_rest_has_no_partial_share() -> None:
    random = np.random.default_rng(0)
    result = importance(study(lambda trial, length, fill: random.gamma(2)))
    sources = by_source(result)
    assert sources["eta squared"].sum() == pytest.approx(1.0)
    assert np.isnan(sources.loc[HIGHER, "partial eta squared"])
    rest = sources.loc[HIGHER, "variance"]
    alone = sources.loc["fill", "variance"]
    assert sources.loc["fill", "partial eta squared"] == pytest.approx(alone / (alone + rest))
    assert info_of(result.table).answer[0].startswith("Share of the variance of rmse: ")


def test_winners_change_with_what_turns_them() -> None:
    def rmse(trial: int, length: int, fill: str) -> float:
        if length == 5:
            return {"cubic": 1.0, "lin": 2.0, "akima": 3.0}[fill]
        return {"cubic": 9.0, "lin": 8.0, "akima": 8.5}[fill] + trial

    result = importance(study(rmse))
    sources = by_source(result)
    assert sources.loc["length", "winner changes"] == 1.0
    assert sources.loc["trial", "winner changes"] == 0.0
    assert np.isnan(sources.loc["fill", "winner changes"])
    assert info_of(result.table).answer[1] == (
        "From one label to another, the best fill changes 0 % of the time with trial, 100 % of the "
        "time with length."
    )
    higher = by_source(importance(study(rmse), better="higher"))
    assert higher.loc["length", "winner changes"] == 1.0
    nobody = by_source(importance(study(rmse), better="none"))
    assert nobody["winner changes"].isna().all()


def test_two_factors_leave_their_interaction_as_the_rest() -> None:
    random = np.random.default_rng(1)
    result = importance(
        study(lambda trial, length, fill: random.gamma(2)), factors=("length", "fill")
    )
    sources = by_source(result)
    assert sources.index.tolist() == ["length", "fill", "length x fill"]
    assert np.isnan(sources.loc["length x fill", "partial eta squared"])
    assert sources["eta squared"].sum() == pytest.approx(1.0)


def test_one_axis_takes_the_unit_of_the_rows_as_the_other_factor() -> None:
    tables = {
        name: pd.DataFrame({"gap": [0, 1], "rmse": [place, place + 2.0]})
        for place, name in enumerate("ab")
    }
    sources = by_source(importance(Across.of(tables, axis="fill")))
    assert sources.index.tolist() == ["gap", "fill", "gap x fill"]
    assert sources["variance"].tolist() == [1.0, 0.25, 0.0]


def test_missing_cells_cost_labels_and_are_reported() -> None:
    whole = study(lambda trial, length, fill: trial + length + len(fill))
    entries = tuple(
        entry for entry in whole.entries if entry[0]["fill"] != "akima" or entry[0]["length"] == 45
    )
    absent = (Absent({"trial": 0, "length": 5, "fill": "akima"}, "refused", "too short"),)
    with pytest.warns(UserWarning, match=r"4 of 24 cells have no number; fill: left out akima"):
        result = importance(Across(whole.axes, entries, absent))
    assert by_source(result).loc["fill", "labels"] == 2
    assert any("too short" in note for note in info_of(result.table).notes)


def test_a_row_without_a_number_makes_its_cell_missing() -> None:
    scores = study(lambda trial, length, fill: NAN if trial == 2 and fill == "lin" else trial)
    with pytest.warns(UserWarning, match=r"2 of 24 cells have no number; trial: left out 2"):
        result = importance(scores)
    assert by_source(result).loc["trial", "labels"] == 3


def test_a_constant_metric_explains_nothing() -> None:
    result = importance(study(lambda trial, length, fill: 1.0))
    assert "the same in all combinations" in info_of(result.table).answer[0]
    assert result.table["eta squared"].isna().all()
    assert by_source(result).loc["length", "winner changes"] == 0.0


@pytest.mark.parametrize("values", [[], [NAN, NAN]])
def test_nothing_is_left(values: list[float]) -> None:
    table = pd.DataFrame({"gap": range(len(values)), "rmse": np.array(values, dtype=float)})
    scores = Across.of({"a": table, "b": table}, axis="fill")
    if values:
        with pytest.warns(UserWarning, match="cells have no number"):
            result = importance(scores)
    else:
        result = importance(scores)
    assert list(info_of(result.table).answer) == [
        "no full table of combinations is left; nothing can be said."
    ]
    result.figure.savefig(io.BytesIO(), format="svg")


def test_bars_are_the_shares_the_largest_on_top() -> None:
    random = np.random.default_rng(2)
    result = importance(study(lambda trial, length, fill: length / 10 + random.gamma(2)))
    (axis,) = result.figure.axes
    shares = sorted(result.table["eta squared"], reverse=True)
    assert [bar.get_width() for bar in axis.patches] == pytest.approx(shares)  # type: ignore[attr-defined]
    assert axis.get_yticklabels()[0].get_text() == "length"
    assert axis.yaxis.get_inverted()


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            {"compare": "length", "factors": ("fill", "trial")},
            "'length' is not a factor; factors are",
        ),
        ({"factors": ("fill", "fill")}, "twice: fill, fill"),
        ({"factors": ("fill", "name")}, "no axis or column 'name'"),
    ],
)
def test_mistakes_are_named(settings: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        importance(study(lambda trial, length, fill: 1.0), **settings)


def test_too_many_cells_are_refused() -> None:
    table = pd.DataFrame({name: np.arange(300.0) for name in ("a", "b", "c", "rmse")})
    with pytest.raises(ValueError, match=r"cells are more than .*; labels: a 300, b 300, c 300"):
        importance(Across.of({"x": table}, axis="f"), metric="rmse", factors=("a", "b", "c"))
