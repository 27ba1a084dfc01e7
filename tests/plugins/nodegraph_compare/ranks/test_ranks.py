from __future__ import annotations

import io
import re
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from scipy.stats import friedmanchisquare

from nodegraph import Absent, Across
from nodegraph.node.decorator import node_of
from nodegraph_compare.ranks.node import Ranked
from nodegraph_compare.ranks.node import ranks as ranks_of
from nodegraph_compare.table.node import table
from nodegraph_mocap import Table
from nodegraph_tables import TableInfo, info_of, with_info
from nodegraph_tables.style import BEST, BLACK, REST
from tests.plugins.nodegraph_compare.scores import scored

NAN = np.nan
NAMES = ("lin", "cubic", "akima", "muscle")


def study(
    methods: tuple[str, ...] = NAMES, *, trials: int = 6, apart: float = 0.5
) -> Across[Table]:
    random = np.random.default_rng(0)
    entries = []
    for trial in range(trials):
        for length in (5, 45):
            base = random.lognormal(size=5)
            for place, fill in enumerate(methods):
                rmse = base * random.uniform(1, 2, size=5) + apart * place
                labels = {"trial": trial, "length": length, "fill": fill}
                entries.append((labels, pd.DataFrame({"gap": range(5), "rmse": rmse})))
    return Across(("trial", "length", "fill"), tuple(entries))


def ranks(scores: Across[Table], **settings: Any) -> Ranked:
    """Rank where every trial and block is a cluster."""
    trials = tuple(axis for axis in scores.axes if axis == "trial")
    clusters = settings.pop("clusters", (*trials, "gap"))
    return ranks_of(scores, clusters=clusters, **settings)


def texts(result: Ranked) -> list[str]:
    return [text.get_text() for axis in result.figure.axes for text in axis.texts]


def test_methods_stand_by_their_mean_rank() -> None:
    result = ranks(study(), within=("length",))
    assert list(result.table.columns) == ["length", "fill", "blocks", "mean rank", "mean"]
    for _, rows in result.table.groupby("length"):
        assert rows["mean rank"].is_monotonic_increasing
        assert rows["fill"].iloc[0] == "lin"
        assert rows["mean rank"].sum() == pytest.approx(1 + 2 + 3 + 4)
        assert rows["blocks"].tolist() == [30] * 4


def test_the_overall_test_is_scipys_on_the_blocks() -> None:
    scores = study()
    result = ranks(scores, clusters=("trial", "length", "gap"))
    columns = [
        np.concatenate([table["rmse"] for at, table in scores if at["fill"] == name])
        for name in NAMES
    ]
    (row,) = result.overall.to_dict("records")
    peer = friedmanchisquare(*columns)
    assert (row["methods"], row["units"]) == (4, 60)
    assert (row["chi2"], row["p"]) == (pytest.approx(peer.statistic), pytest.approx(peer.pvalue))


def test_every_pair_has_a_row() -> None:
    result = ranks(study(), within=("length",), test="wilcoxon_holm")
    assert len(result.pairs) == 2 * 6
    first = result.pairs.iloc[0]
    assert (first["length"], first["first"], first["second"]) == (5, "lin", "cubic")
    by_name = result.table[result.table["length"] == 5].set_index("fill")["mean rank"]
    assert first["rank difference"] == pytest.approx(by_name["lin"] - by_name["cubic"])
    assert result.pairs["p"].between(0, 1).all()
    assert first["effect"] > 0


def test_the_answer_says_who_ranks_first_and_who_is_not_apart() -> None:
    sentence, scope, card = info_of(ranks(study(apart=0.8)).table).answer.lines
    assert sentence == "lin has the lowest mean rank."
    assert scope.startswith("Scope: over 30 combinations of trial and gap. Mean ranks of rmse")
    assert re.match(
        r"rmse: lin, mean rank 1\.\d\d of 4; "
        r"test: Friedman's, F = [\d.]+, p < 0\.0001, Kendall's W = 0\.\d\d; "
        r"pairs by Nemenyi's test\.$",
        card,
    )


def test_the_answer_says_who_leaves_few_blocks_to_all() -> None:
    whole = {name: scored(*(place + at for at in range(8))) for place, name in enumerate("abc")}
    shy = scored(*[float("nan")] * 3, *range(5))
    with pytest.warns(UserWarning, match="3 of 8 blocks left out"):
        card = info_of(ranks(Across.of({**whole, "shy": shy}, axis="f")).table).answer.lines[-1]
    assert "blocks: 5 of 8 gaps, the rest left out: shy lacks 3" in card


def test_no_claim_where_friedman_makes_none() -> None:
    same = {
        name: scored(*np.random.default_rng(place).normal(size=8))
        for place, name in enumerate("abcd")
    }
    sentence, _, card = info_of(ranks(Across.of(same, axis="fill")).table).answer.lines
    assert sentence == "Ranks do not tell the methods apart."
    assert re.match(r"rmse: no verdict; [a-d] \d\.\d\d; why: ", card)
    assert "why: Friedman's test does not tell the methods apart" in card


def test_methods_of_one_mean_rank_share_it() -> None:
    worse = {name: scored(*range(place, place + 8)) for place, name in enumerate("cdef", start=3)}
    tied = {"a": scored(*range(8)), "b": scored(*range(8)), **worse}
    sentence, _, card = info_of(ranks(Across.of(tied, axis="fill")).table).answer.lines
    assert sentence == "a and b share the lowest mean rank."
    assert card.startswith(
        "rmse: a and b, mean rank 1.50 of 6; c 3.00, may be as good; d 4.00, may be as good; test: "
    )
    two = Across.of({name: tied[name] for name in "ab"}, axis="fill")
    assert "Wilcoxon's signed ranks, p = 1.0000" in info_of(ranks(two).table).answer.lines[-1]


def test_of_many_groups_each_of_equal_methods_counts() -> None:
    tables = {
        name: pd.DataFrame({"take": range(20), "gap": range(20), "rmse": np.full(20, value)})
        for name, value in {"a": 0.3, "b": 0.1 + 0.2, "c": 0.5}.items()
    }
    scores = Across.of(tables, axis="fill")
    cards = info_of(ranks(scores, within=("take",)).table).answer.cards
    assert {card.line.partition(": ")[2][:31] for card in cards} == {
        "no verdict; a 1.50; b 1.50; why"
    }
    sentence = info_of(table(scores, within=("take",)).table).answer.lines[0]
    assert "Lowest mean rmse in all 20 groups: a and b (0.300)." in sentence


def test_two_methods_one_method_one_block() -> None:
    two = Across.of({"a": scored(1, 2, 3, 4, 5, 6, 7), "b": scored(2, 3, 4, 5, 6, 7, 9)}, axis="f")
    card = info_of(ranks(two).table).answer.lines[-1]
    assert "test: Wilcoxon's signed ranks, p = 0.0156" in card
    assert card.endswith("caution: provisional, as of 7 gaps.")
    axis = ranks(Across.of({"a": scored(1, 2)}, axis="f"))
    assert list(info_of(axis.table).answer.lines) == [
        "There is nothing to rank.",
        "rmse: only a has numbers.",
    ]
    assert axis.table["mean rank"].tolist() == [1.0]
    assert len(axis.pairs) == 0
    single = Across.of({name: scored(place) for place, name in enumerate("abc")}, axis="f")
    assert "why: one repetition where 3" in info_of(ranks_of(single).table).answer.lines[-1]


def test_a_method_without_any_number_is_in_the_answer() -> None:
    nothing = float("nan")
    scores = Across.of(
        {"a": scored(1, 2, 4), "b": scored(2, 3, 5), "c": scored(nothing, nothing, nothing)},
        axis="f",
    )
    with pytest.warns(UserWarning, match="without any number"):
        result = ranks(scores)
    assert "without any number, not compared: c" in info_of(result.table).answer.lines[-1]


def test_higher_is_better_where_the_score_declares_it() -> None:
    higher = TableInfo(better={"rmse": "higher"})
    tables = {
        "a": with_info(scored(0.9, 0.8, 0.7), higher),
        "b": with_info(scored(0.5, 0.4, 0.6), higher),
    }
    scores = Across.of(tables, axis="fill")
    assert ranks(scores).table["fill"].tolist() == ["a", "b"]
    assert ranks(scores, better="lower").table["fill"].tolist() == ["b", "a"]
    assert any(
        "the lowest value" in note for note in info_of(ranks(scores, better="none").table).notes
    )


def test_what_is_left_out_is_reported_and_listed() -> None:
    entries = (
        ({"fill": "a"}, scored(1, 2, 3, 4)),
        ({"fill": "b"}, scored(2, 1, NAN, 6)),
        ({"fill": "c"}, scored(NAN, NAN, NAN, np.inf)),
        ({"fill": "e"}, scored(3, 3, 3, 3)),
    )
    scores = Across(("fill",), entries, (Absent({"fill": "d"}, "refused", "too short"),))
    with pytest.warns(UserWarning, match=r"1 of 4 blocks left out \(b lacks 1\).*compared: c"):
        result = ranks(scores)
    assert result.table["fill"].tolist() == ["a", "b", "e", "c", "d"]
    assert result.table["blocks"].tolist() == [3, 3, 3, 0, 0]
    assert result.table["mean rank"].isna().tolist() == [False, False, False, True, True]
    assert any(
        "d: 1 combination refused (too short)" in note for note in info_of(result.table).notes
    )


@pytest.mark.parametrize("values", [(), (NAN, NAN)])
def test_nothing_to_rank(values: tuple[float, ...]) -> None:
    with pytest.warns(UserWarning, match="no rows|not compared: a, b"):
        result = ranks(Across.of({"a": scored(*values), "b": scored(*values)}, axis="fill"))
    assert result.table.get("mean rank", pd.Series(dtype=float)).isna().all()
    assert not result.figure.axes


def test_thousands_of_combinations_are_summed_up() -> None:
    random = np.random.default_rng(0)
    rows = {
        name: pd.DataFrame(
            {
                "gap": np.repeat(range(50), 6),
                "take": [*range(6)] * 50,
                "rmse": random.uniform(size=300),
            }
        )
        for name in "abc"
    }
    result = ranks(
        Across.of(rows, axis="fill"), within=("gap",), blocks=("take",), clusters=("take",)
    )
    assert len(result.overall) == 50
    assert len(info_of(result.table).answer.cards) == 50
    assert len(result.figure.axes) == 12
    assert "38 more groups are not drawn" in result.figure.get_supxlabel()


def test_the_diagram_names_every_method_once() -> None:
    result = ranks(study(), within=("length",))
    assert len(result.figure.axes) == 2
    shown = texts(result)
    for name in NAMES:
        assert sum(name in text for text in shown) == 2
    assert sum(text.strip().startswith("critical difference") for text in shown) == 2


def test_the_first_is_blue_and_what_is_apart_from_it_grey() -> None:
    result = ranks(study(apart=0.2))
    axis = result.figure.axes[0]
    marks = {
        float(np.asarray(line.get_xdata())[0]): to_hex(str(line.get_color()))
        for line in axis.lines
        if line.get_marker() == "o"
    }
    order = result.table.set_index("fill")["mean rank"]
    first = str(order.idxmin())
    named = (result.pairs["first"] == first) | (result.pairs["second"] == first)
    pairs = result.pairs[named]
    near = {*pairs[pairs["p"] >= 0.05][["first", "second"]].to_numpy().ravel()}
    assert near
    assert {*order.index} - near
    assert {name: marks[rank] for name, rank in order.items()} == {
        name: BEST if name == first else BLACK if name in near else REST for name in order.index
    }


def test_markers_stand_at_the_mean_ranks_and_bars_over_what_is_not_apart() -> None:
    result = ranks(study(apart=0.4))
    axis = result.figure.axes[0]
    at = sorted(
        float(np.asarray(line.get_xdata())[0])
        for line in axis.lines
        if line.get_marker() not in ("None", "")
    )
    assert at == pytest.approx(sorted(result.table["mean rank"]))
    bars = [np.asarray(line.get_xdata()) for line in axis.lines if line.get_linewidth() == 3]
    apart = result.pairs[result.pairs["p"] >= 0.05]
    place = result.table.set_index("fill")["mean rank"]
    for value, other in zip(apart["first"], apart["second"], strict=True):
        assert any(
            bar[0] <= min(place[value], place[other]) and max(place[value], place[other]) <= bar[1]
            for bar in bars
        )


def test_wilcoxon_has_no_critical_difference() -> None:
    assert not any("critical" in text for text in texts(ranks(study(), test="wilcoxon_holm")))


@pytest.mark.parametrize("count", [2, 3, 70])
def test_any_number_of_methods_can_be_drawn(count: int) -> None:
    result = ranks(study(tuple(f"m{place}" for place in range(count)), trials=2))
    result.figure.savefig(io.BytesIO(), format="svg")
    named = sum(bool(re.search(r"\bm\d+\b", text)) for text in texts(result))
    assert named == min(count, 60)
    assert any("10 more methods are not named" in text for text in texts(result)) == (count == 70)


def test_labels_with_markup_and_long_ones_are_drawn_as_they_are() -> None:
    names = (
        "a $x^2$",
        "_under",
        "<b>&amp;",
        "an enormously long name of a method, much too long to draw",
    )
    result = ranks(study(names))
    buffer = io.BytesIO()
    result.figure.savefig(buffer, format="svg")
    assert any(text.startswith(r"a \$x^2\$") for text in texts(result))
    assert result.table["fill"].tolist() == list(names)
    assert all(len(text) < 60 for text in texts(result))


def test_the_outputs_have_their_names() -> None:
    described = node_of(ranks_of)
    assert described is not None
    assert [str(port) for port in described.outputs] == [
        "table: Table", "figure: Figure", "pairs: Table", "overall: Table",
    ]  # fmt: skip
