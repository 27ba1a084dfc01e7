from __future__ import annotations

import re
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import wilcoxon

import nodegraph_compare
from nodegraph import Absent, Across
from nodegraph.node.decorator import node_of
from nodegraph_compare.table.node import table
from nodegraph_tables import BetterEnd, TableInfo, info_of, with_info

NAN = np.nan


def scored(values: Any) -> pd.DataFrame:
    frame = pd.DataFrame({"gap": np.arange(len(values)), "rmse": np.asarray(values, dtype=float)})
    frame = with_info(frame, TableInfo(units={"rmse": "mm"}))
    return frame


def trials(count: int = 6, gaps: int = 5, lengths: tuple[int, ...] = (5, 45)) -> Any:
    """Three methods of known order: `near` lowest, then `far`; `twin` equals `near`."""
    random = np.random.default_rng(0)
    entries: list[Any] = []
    for trial in range(count):
        for length in lengths:
            near = random.lognormal(size=gaps) * length
            spread = {"far": near * random.uniform(1.5, 3, size=gaps), "near": near, "twin": near}
            labels = {"trial": trial, "length": length}
            entries += [({**labels, "fill": name}, scored(entry)) for name, entry in spread.items()]
    return Across(("trial", "length", "fill"), tuple(entries))


def plainly(scores: Any, length: int, fill: str) -> Any:
    return np.concatenate(
        [value["rmse"] for at, value in scores if at["length"] == length and at["fill"] == fill]
    )


def test_rows_are_the_statistics_of_the_blocks() -> None:
    scores = trials()
    frame = table(scores, within=("length",), blocks=("trial", "gap"), baseline="near").table
    assert list(zip(frame["length"], frame["fill"], strict=True)) == [
        (length, fill) for length in (5, 45) for fill in ("near", "twin", "far")
    ]
    for row in frame.to_dict("records"):
        values = plainly(scores, row["length"], row["fill"])
        assert row["blocks"] == 30
        assert row["mean"] == pytest.approx(values.mean())
        assert row["rms"] == pytest.approx(np.sqrt((values**2).mean()))
        assert row["median"] == pytest.approx(np.median(values))
        assert row["sd"] == pytest.approx(values.std(ddof=1))
        assert row["low"] < row["mean"] < row["high"]
        assert row["refused"] == row["left missing"] == 0
    near, twin, far = frame.iloc[:3].to_dict("records")
    paired = plainly(scores, 5, "far") - plainly(scores, 5, "near")
    assert far["difference"] == pytest.approx(paired.mean())
    assert 0 < far["difference low"] < paired.mean() < far["difference high"]
    assert far["p"] == pytest.approx(min(1.0, 2 * wilcoxon(paired).pvalue))
    assert far["better in"] == 0
    assert all(np.isnan(near[name]) for name in ("difference", "difference low", "p", "better in"))
    assert [twin[name] for name in ("difference", "p", "better in")] == [0, 1, 0]


def test_the_answer_names_the_lowest_and_those_that_are_not_apart() -> None:
    number = Across(trials().axes, tuple(entry for entry in trials() if entry[0]["length"] == 5))
    (sentence,) = info_of(table(number, within=("length",)).table).answer
    assert re.match(
        r"length 5: near, twin share the lowest mean rmse \([\d.]+ mm, interval [\d.]+ to [\d.]+, "
        r"30 blocks\); every other method is clearly behind\.$",
        sentence,
    )


def test_the_answer_names_who_is_not_clearly_behind() -> None:
    near = [1.0, 1.2, 0.9, 1.1]
    tables = {"a": near, "b": [1.3, 1.0, 0.9, 1.2], "far": [9.0, 9.1, 9.2, 9.0], "a2": near}
    scores = {name: scored(values) for name, values in tables.items()}
    (sentence,) = info_of(table(Across.of(scores, axis="fill")).table).answer
    assert sentence.endswith("; not clearly apart from them: b; the other clearly behind.")
    del scores["a2"]
    (sentence,) = info_of(table(Across.of(scores, axis="fill")).table).answer
    assert sentence.endswith("; not clearly apart from it: b; the other clearly behind.")


def test_groups_with_one_answer_share_a_sentence() -> None:
    frame = table(trials(), within=("length",)).table
    (sentence,) = info_of(frame).answer
    bests = sorted(frame[frame["fill"] == "near"]["mean"])
    start = "length 5, 45: near, twin share the lowest mean rmse "
    assert sentence.startswith(f"{start}({bests[0]:.3g} to {bests[1]:.3g} mm, 30 blocks each); ")


def test_shares_are_told_in_percent_and_powers_as_they_are_printed() -> None:
    for unit, text in (("share", "(20 %,"), ("mm^2", "(0.2 mm²,")):
        tables = {"a": scored([0.2, 0.1, 0.3, 0.2]), "b": scored([0.4, 0.5, 0.6, 0.5])}
        info = TableInfo(units={"rmse": unit})
        tables = {name: with_info(scores, info) for name, scores in tables.items()}
        result = table(Across.of(tables, axis="fill"))
        assert text in info_of(result.table).answer[0]
        assert "mm^2" not in result.figure.axes[0].get_ylabel()


def test_an_answer_when_all_others_are_behind() -> None:
    scores = Across.of({"a": scored([2, 3, 4.5]), "b": scored([1, 2, 3])}, axis="fill")
    (sentence,) = info_of(table(scores).table).answer
    assert sentence.startswith("b has the lowest mean rmse (2 mm, ")
    assert "every other method is clearly behind" in sentence


def test_the_draw_does_not_depend_on_anything_but_the_seed() -> None:
    first, again, other = (table(trials(), seed=seed).table for seed in (1, 1, 2))
    assert first.equals(again)
    assert not first.equals(other)
    assert first["mean"].equals(other["mean"])


def test_incomplete_blocks_are_dropped_for_all_and_told() -> None:
    scores = Across.of(
        {"a": scored([1, 2, 3, 4]), "b": scored([1, NAN, 5, 6]), "c": scored([0, 9, 1])},
        axis="fill",
    )
    with pytest.warns(UserWarning, match=r"2 of 4 blocks left out \(b lacks 1, c lacks 1\)"):
        frame = table(scores).table
    assert frame["blocks"].tolist() == [2, 2, 2]
    assert dict(zip(frame["fill"], frame["mean"], strict=True)) == {"c": 0.5, "a": 2.0, "b": 3.0}
    assert frame["left missing"].tolist() == [0, 0, 0.25]
    assert any("2 of 4 blocks" in note for note in info_of(frame).notes)


def test_a_method_without_any_number_leaves_the_others_their_blocks() -> None:
    scores = Across.of(
        {"a": scored([1, 2]), "b": scored([NAN, NAN]), "c": scored([2, 4])}, axis="f"
    )
    with pytest.warns(UserWarning, match="without any number, not compared: b"):
        frame = table(scores, baseline="a").table
    assert frame["f"].tolist() == ["a", "c", "b"]
    assert info_of(frame).answer[0].endswith("; without any number, not compared: b.")
    assert frame["blocks"].tolist() == [2, 2, 0]
    assert frame.loc[2, ["mean", "sd", "low", "difference", "p", "better in"]].isna().all()
    assert frame.loc[1, "difference"] == 1.5
    assert frame.loc[1, "p"] == wilcoxon([1, 2]).pvalue


def test_a_baseline_without_any_number_gives_no_differences() -> None:
    scores = Across.of({"a": scored([1, 2]), "b": scored([NAN, NAN])}, axis="fill")
    with pytest.warns(UserWarning, match="not compared: b"):
        frame = table(scores, baseline="b").table
    assert frame[["difference", "difference low", "p", "better in"]].isna().all(axis=None)


def test_refused_combinations_are_counted_and_listed_with_their_reasons() -> None:
    whole = trials(2)
    entries = tuple(
        entry for entry in whole if entry[0]["fill"] != "twin" or entry[0]["length"] == 45
    )
    absent = tuple(
        Absent({"trial": trial, "length": 5, "fill": "twin"}, "refused", "needs a complete frame")
        for trial in range(2)
    )
    scores = Across(whole.axes, entries, absent)
    message = r"twin: 2 combinations refused \(needs a complete frame\)"
    with pytest.warns(UserWarning, match=message):
        frame = table(scores, within=("length",)).table
    assert frame["fill"].tolist() == ["near", "far", "twin", "near", "twin", "far"]
    assert frame["refused"].tolist() == [0, 0, 1, 0, 0, 0]
    assert frame["blocks"].tolist() == [10, 10, 0, 10, 10, 10]
    assert any(re.search(message, note) for note in info_of(frame).notes)


def test_skipped_combinations_are_a_note_and_no_warning() -> None:
    whole = trials(2)
    scores = Across(
        whole.axes,
        whole.entries,
        (Absent({"trial": 0, "length": 99, "fill": "far"}, "skipped", ""),),
    )
    frame = table(scores, within=("length",)).table
    assert frame["length"].tolist() == [5] * 3 + [45] * 3
    assert "far: 1 combination skipped" in info_of(frame).notes


def test_one_method_has_a_mean_and_no_rival() -> None:
    frame = table(Across.of({"only": scored([1, 2, 3])}, axis="fill")).table
    assert frame["mean"].tolist() == [2.0]
    assert info_of(frame).answer[0].startswith("only only has a mean rmse (2 mm, ")
    assert info_of(frame).best == {"mean": ()}


def test_one_block_has_no_spread() -> None:
    scores = Across.of({"a": scored([1]), "b": scored([2])}, axis="fill")
    frame = table(scores, baseline="a").table
    assert frame["mean"].tolist() == [1, 2]
    assert frame[["sd", "low", "high", "difference low"]].isna().all(axis=None)
    assert "one block says nothing" in info_of(frame).answer[0]


def test_no_common_block_says_nothing() -> None:
    scores = Across.of({"a": scored([1, NAN]), "b": scored([NAN, 2])}, axis="fill")
    with pytest.warns(UserWarning, match=r"2 of 2 blocks left out"):
        result = table(scores, baseline="a")
    assert result.table["blocks"].tolist() == [0, 0]
    assert result.table[["mean", "p", "difference"]].isna().all(axis=None)
    assert "nothing can be said" in info_of(result.table).answer[0]


def test_tables_without_rows_are_told() -> None:
    empty = Across.of({"a": scored([])}, axis="fill")
    with pytest.warns(UserWarning, match="the tables have no rows"):
        result = table(empty)
    assert len(result.table) == 0
    assert result.figure.axes


def test_numbers_label_methods_as_well() -> None:
    scores = Across.of({3: scored([1, 2]), 5: scored([2, 4])}, axis="order")
    frame = table(scores, baseline="3").table
    assert frame["order"].tolist() == [3, 5]
    assert frame["difference"].tolist()[1] == 1.5
    with pytest.raises(ValueError, match="no baseline '4'; compared are: 3, 5"):
        table(scores, baseline="4")


def declared(end: BetterEnd) -> Any:
    tables = {"a": scored([0.9, 0.8, 0.95, 0.9]), "b": scored([0.5, 0.4, 0.6, 0.5])}
    info = TableInfo(units={"rmse": "mm"}, better={"rmse": end})
    return Across.of({name: with_info(table, info) for name, table in tables.items()}, axis="fill")


def test_the_best_is_at_the_end_that_the_scores_declare() -> None:
    frame = table(declared("higher"), baseline="b").table
    assert info_of(frame).best == {"mean": (0,)}
    assert frame["better in"].tolist()[0] == 1.0
    assert info_of(frame).answer[0].startswith("a has the highest mean rmse (0.8")
    assert any("Higher is better." in note for note in info_of(frame).notes)
    assert table(declared("higher"), better="lower").table["fill"].tolist() == ["b", "a"]


@pytest.mark.parametrize(
    ("better", "order"),
    [
        ("lower", ["c", "b", "b2", "a"]),
        ("higher", ["a", "b", "b2", "c"]),
        ("none", ["a", "b", "b2", "c"]),
    ],
)
def test_the_best_mean_stands_first_and_equal_ones_as_in_the_graph(
    better: Any, order: list[str]
) -> None:
    # 0.1 + 0.2 + 0.3 is more than 0.3 + 0.2 + 0.1: such errors do not decide which stands first
    values = {"a": [4, 4, 4], "b": [0.1, 0.2, 0.3], "b2": [0.3, 0.2, 0.1], "c": [0, 0.1, 0]}
    scores = Across.of({name: scored(value) for name, value in values.items()}, axis="fill")
    assert table(scores, better=better).table["fill"].tolist() == order


def test_a_metric_without_a_better_end_has_no_best() -> None:
    frame = table(declared("none"), baseline="b").table
    assert info_of(frame).best == {"mean": ()}
    assert "better in" not in frame
    assert info_of(frame).answer[0].startswith("the mean rmse is lowest for b (0.5 mm, ")
    assert "and highest for a (0.888 mm, " in info_of(frame).answer[0]


@pytest.mark.parametrize("test", ["wilcoxon", "t", "sign"])
def test_the_baseline_is_told_who_differs(test: Any) -> None:
    frame = table(trials(), within=("length",), baseline="near", test=test).table
    sentence = info_of(frame).answer[1]
    assert (
        sentence
        == "length 5: against near, rmse is significantly higher: far (p < 0.05 after Holm)."
    )
    assert "p" in frame


def test_no_test_is_no_p() -> None:
    frame = table(trials(), baseline="near", test="none").table
    assert "p" not in frame
    assert frame["difference"].notna().any()
    assert len(info_of(frame).answer) == 1


def test_a_constant_metric_has_intervals_without_width_and_no_winner_ahead() -> None:
    scores = Across.of({"a": scored([0.1] * 7), "b": scored([0.1] * 7)}, axis="fill")
    frame = table(scores, baseline="a").table
    assert frame["low"].tolist() == pytest.approx([0.1, 0.1])
    assert frame["p"].tolist()[1] == 1.0
    assert info_of(frame).best == {"mean": (0, 1)}
    assert info_of(frame).answer[0].startswith("a, b share the lowest mean rmse (0.1")
    assert info_of(frame).answer[0].endswith("7 blocks).")


def test_blocks_that_differ_by_rounding_alone_have_no_deviation() -> None:
    nearly = [0.35, 0.35 + 6e-17, 0.35 - 6e-17, 0.35]
    scores = Across.of({"a": scored(nearly), "b": scored([1, 2, 3, 4])}, axis="fill")
    frame = table(scores).table
    assert frame["sd"].tolist() == [0.0, pytest.approx(np.std([1, 2, 3, 4], ddof=1))]
    assert frame[["low", "high"]].iloc[0].tolist() == [pytest.approx(0.35)] * 2


def test_infinite_scores_are_lacking() -> None:
    scores = Across.of({"a": scored([1, 2, 3]), "b": scored([1, np.inf, -np.inf])}, axis="fill")
    with pytest.warns(UserWarning, match="b lacks 2"):
        frame = table(scores).table
    assert frame["mean"].tolist() == [1.0, 1.0]


def test_many_groups_are_told_in_one_sentence() -> None:
    rows = pd.DataFrame({"marker": np.repeat(range(20), 3), "take": [0, 1, 2] * 20})
    tables = {
        "a": rows.assign(rmse=1.0),
        "b": rows.assign(rmse=np.where(rows["marker"] < 5, 0.5, 2.0)),
    }
    frame = table(Across.of(tables, axis="fill"), within=("marker",), blocks=("take",)).table
    assert list(info_of(frame).answer) == [
        "Of 20 groups (marker), a has the lowest mean rmse in 15, b in 5."
    ]


def narrow(lacking: int, *, unit: str = "gap") -> Any:
    """Twenty blocks, some of which `shy` lacks; `timid` lacks one of these."""
    values = np.linspace(1.0, 2.0, 20)
    shy, timid = values + 1.0, values + 2.0
    shy[:lacking] = NAN
    timid[:1] = NAN
    tables = {"bold": values, "timid": timid, "shy": shy}
    return Across.of(
        {name: scored(column).rename(columns={"gap": unit}) for name, column in tables.items()},
        axis="fill",
    )


@pytest.mark.filterwarnings("ignore:.*blocks left out")
def test_the_answer_says_who_leaves_few_blocks_to_all() -> None:
    (sentence,) = info_of(table(narrow(6)).table).answer
    assert sentence.endswith("clearly behind (14 of 20 gaps: shy lacks 6, timid lacks 1).")
    (sentence,) = info_of(
        table(narrow(20)).table
    ).answer  # it does not take part, and takes nothing
    assert "of 20" not in sentence
    (sentence,) = info_of(table(narrow(5)).table).answer
    assert "of 20" not in sentence


@pytest.mark.filterwarnings("ignore:.*blocks left out")
def test_blocks_have_their_name_where_one_column_tells_them() -> None:
    assert "14 of 20 markers: " in info_of(table(narrow(6, unit="marker")).table).answer[0]
    # a block is a take and a gap: neither tells which one it is
    scores = Across.of(
        {at["fill"]: value.assign(take=0) for at, value in narrow(6)},
        axis="fill",
    )
    (sentence,) = info_of(table(scores, blocks=("take", "gap")).table).answer
    assert "14 of 20 blocks: " in sentence


@pytest.mark.filterwarnings("ignore:.*blocks left out")
def test_groups_of_which_few_blocks_are_left_are_told_apart() -> None:
    both = [
        ({**at, "length": length}, value)
        for length, scores in ((5, narrow(1)), (45, narrow(15)))
        for at, value in scores
    ]
    frame = table(Across(("length", "fill"), tuple(both)), within=("length",)).table
    short, long = info_of(frame).answer
    assert short.startswith("length 5: bold ")
    assert "of 20" not in short
    assert long.startswith("length 45: bold ")
    assert "(5 of 20 gaps: shy lacks 15, timid lacks 1)" in long


@pytest.mark.filterwarnings("ignore:.*blocks left out")
def test_of_many_groups_it_is_told_in_how_many_blocks_are_few() -> None:
    both = [
        ({**at, "length": length}, value)
        for length in range(13)
        for at, value in narrow(15 if length > 10 else 1)
    ]
    frame = table(Across(("length", "fill"), tuple(both)), within=("length",)).table
    assert info_of(frame).answer[1] == (
        "In 2 of them more than a quarter of the gaps are left out, because not every method has "
        "them (5 of 20 gaps: shy lacks 15, timid lacks 1)."
    )


def test_units_follow_the_metric() -> None:
    units = info_of(table(trials(), baseline="far").table).units
    assert units["mean"] == units["high"] == units["difference low"] == "mm"
    assert units["refused"] == "share"
    assert "p" not in units


def test_gathered_tables_stay_as_they_are() -> None:
    scores = trials(2)
    before = [value.copy() for value in scores.values()]
    table(scores)
    assert all(value.equals(two) for value, two in zip(scores.values(), before, strict=True))


@settings(max_examples=30, deadline=None)
@given(
    st.lists(st.lists(st.floats(0.1, 100), min_size=4, max_size=4), min_size=2, max_size=4),
    st.floats(0.5, 2),
)
def test_scaling_the_metric_scales_the_table(rows: list[list[float]], factor: float) -> None:
    tables = {f"m{place}": scored(row) for place, row in enumerate(rows)}
    larger = {name: scored(table["rmse"] * factor) for name, table in tables.items()}
    value, two = (
        table(Across.of(each, axis="fill")).table.sort_values("fill") for each in (tables, larger)
    )
    for name in ("mean", "median", "sd", "low", "high"):
        assert two[name].to_numpy() == pytest.approx(value[name].to_numpy() * factor, abs=1e-9)


def test_the_node_and_its_citations() -> None:
    described = node_of(table)
    assert described is not None
    assert [str(port) for port in described.outputs] == ["table: Table", "figure: Figure"]
    assert described.inputs[0].across
    shipped = nodegraph_compare.nodegraph_bibtex()
    assert all(f"{{{key}," in shipped for key in described.cite)
