from __future__ import annotations

import io
import re

import numpy as np
import pandas as pd
import pytest

from nodegraph import Across
from nodegraph_compare.agreement.node import agreement
from nodegraph_mocap import Table
from nodegraph_tables import TableInfo, info_of, with_info

NAN = np.nan


def study(count: int = 3, blocks: int = 20, unit: str = "mm") -> Across[Table]:
    random = np.random.default_rng(0)
    truth = random.uniform(1, 5, size=blocks)
    tables = {}
    for place in range(count):
        rmse = truth + place + random.normal(scale=0.2, size=blocks)
        table = pd.DataFrame({"gap": range(blocks), "rmse": rmse})
        tables[f"m{place}"] = with_info(table, TableInfo(units={"rmse": unit}))
    return Across.of(tables, axis="fill")


def scored(*values: float) -> pd.DataFrame:
    return pd.DataFrame({"gap": range(len(values)), "rmse": np.array(values, dtype=float)})


def test_every_pair_has_a_row_with_its_bias() -> None:
    frame = agreement(study()).table
    assert list(zip(frame["first"], frame["second"], strict=True)) == [
        ("m0", "m1"), ("m0", "m2"), ("m1", "m2"),
    ]  # fmt: skip
    assert frame["bias"].tolist() == pytest.approx([-1, -2, -1], abs=0.2)
    assert (frame["bias low"] < frame["bias"]).all()
    assert (frame["lower low"] < frame["lower"]).all()
    assert (frame["upper"] < frame["upper high"]).all()
    assert frame["blocks"].tolist() == [20] * 3
    assert info_of(frame).units["upper high"] == "mm"
    assert "slope" not in info_of(frame).units


def test_a_baseline_is_the_second_of_every_pair() -> None:
    frame = agreement(study(), baseline="m1").table
    assert frame["first"].tolist() == ["m0", "m2"]
    assert frame["second"].tolist() == ["m1", "m1"]
    with pytest.raises(ValueError, match="no baseline 'x'; compared are: m0, m1, m2"):
        agreement(study(), baseline="x")


def test_the_answer_says_which_is_above_and_by_how_much() -> None:
    (sentence,) = info_of(agreement(study(2)).table).answer
    assert re.match(
        r"m0 is below m1 on average \(bias -[\d.]+ mm, interval -[\d.]+ to -[\d.]+\); 95 % of "
        r"differences are expected between -[\d.]+ and -?[\d.]+ mm \(20 blocks\)\.$",
        sentence,
    )


def test_a_difference_that_grows_is_reported() -> None:
    values = np.arange(1.0, 11.0)
    noise = 0.01 * np.sin(np.arange(10.0))
    scores = Across.of({"a": scored(*(1.5 * values + noise)), "b": scored(*values)}, axis="f")
    result = agreement(scores)
    assert result.table["slope"].tolist() == pytest.approx([0.4], abs=0.01)
    assert info_of(result.table).answer[0].endswith("the difference changes with the value.")


def test_a_pair_has_its_own_blocks() -> None:
    scores = Across.of(
        {"a": scored(1, 2, 3), "b": scored(2, NAN, 4), "c": scored(NAN, np.inf, NAN)}, axis="f"
    )
    with pytest.warns(UserWarning, match="without any number, not compared: c"):
        result = agreement(scores)
    assert result.table["blocks"].tolist() == [2, 0, 0]
    assert result.table["bias"].tolist()[0] == -1
    assert "a and c share no blocks; nothing can be said." in info_of(result.table).answer
    assert any(
        "1 of 3 blocks are not in every pair (b lacks 1)" in note
        for note in info_of(result.table).notes
    )


def test_one_method_has_nothing_to_agree_with() -> None:
    result = agreement(Across.of({"a": scored(1, 2)}, axis="f"))
    assert list(info_of(result.table).answer) == ["there are no two labels to compare."]
    assert len(result.table) == 0
    assert not result.figure.axes


def test_shares_are_in_percent() -> None:
    result = agreement(study(2, unit="share"))
    bias = f"bias {100 * result.table['bias'].iloc[0]:.3g}"
    assert f"({bias} %, interval" in info_of(result.table).answer[0]
    (axis,) = result.figure.axes
    assert bias in [text.get_text() for text in axis.texts]
    assert axis.yaxis.get_major_formatter()(-0.07) == "-7"
    assert result.figure.get_supylabel() == "difference (%)"


def test_panels_show_differences_over_means_with_bias_and_limits() -> None:
    result = agreement(study(2))
    (axis,) = result.figure.axes
    (row,) = result.table.to_dict("records")
    heights = [float(np.asarray(line.get_ydata())[0]) for line in axis.lines]
    for name in ("bias", "lower", "upper"):
        assert any(height == pytest.approx(row[name]) for height in heights)
    points = np.asarray(axis.collections[0].get_offsets())
    assert len(points) == 20
    assert points[:, 1].mean() == pytest.approx(row["bias"])
    assert axis.get_title() == "m0 \N{MINUS SIGN} m1"


@pytest.mark.parametrize("count", [2, 3, 9])
def test_at_most_twelve_pairs_are_drawn(count: int) -> None:
    result = agreement(study(count))
    pairs = count * (count - 1) // 2
    assert len(result.figure.axes) == min(pairs, 12)
    assert len(result.table) == pairs
    result.figure.savefig(io.BytesIO(), format="svg")


def test_groups_and_labels_with_markup() -> None:
    table = pd.DataFrame({"side": ["l", "r"] * 5, "gap": np.repeat(range(5), 2), "rmse": range(10)})
    scores = Across.of({"$a$ <b>": table, "_b": table.assign(rmse=table["rmse"] + 1.0)}, axis="f")
    result = agreement(scores, metric="rmse", within=("side",), blocks=("gap",))
    assert result.table["side"].tolist() == ["l", "r"]
    assert result.table["bias"].tolist() == [-1, -1]
    assert result.table["sd"].tolist() == [0, 0]
    assert result.figure.axes[0].get_title().startswith("side l\n" + r"\$a\$ <b>")
    result.figure.savefig(io.BytesIO(), format="svg")
