from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.stats import gmean, sem, t

from nodegraph import Absent, Across, Declared, Label
from nodegraph.node.decorator import node_of
from nodegraph_compare.answer import scope_words
from nodegraph_compare.question import margin_of
from nodegraph_compare.table.node import Compared
from nodegraph_compare.table.node import table as table_of
from nodegraph_mocap import Table
from nodegraph_tables import BetterEnd, TableInfo, Take, Word, info_of, with_info
from nodegraph_tables.numbers import span_text
from nodegraph_tables.rendering import render_table
from nodegraph_tables.text import html_of, plain

pytestmark = pytest.mark.usefixtures("without_pictures")

NAN = np.nan


def scored(values: Any) -> pd.DataFrame:
    frame = pd.DataFrame({"gap": np.arange(len(values)), "rmse": np.asarray(values, dtype=float)})
    frame = with_info(frame, TableInfo(units={"rmse": "mm"}))
    return frame


def trials(count: int = 6, gaps: int = 5, lengths: tuple[int, ...] = (5, 45)) -> Across[Table]:
    """Three methods of known order: `near` lowest, then `far`; `twin` equals `near`."""
    random = np.random.default_rng(0)
    entries: list[tuple[dict[str, Label], Table]] = []
    for trial in range(count):
        for length in lengths:
            near = random.lognormal(size=gaps) * length
            spread = {"far": near * random.uniform(1.5, 3, size=gaps), "near": near, "twin": near}
            labels = {"trial": trial, "length": length}
            entries += [({**labels, "fill": name}, scored(entry)) for name, entry in spread.items()]
    return Across(("trial", "length", "fill"), tuple(entries))


def plainly(scores: Across[Table], length: int, fill: str) -> NDArray[np.float64]:
    return np.concatenate(
        [value["rmse"] for at, value in scores if at["length"] == length and at["fill"] == fill]
    )


def table(scores: Across[Table], **settings: Any) -> Compared:
    """Compare where every gap is a cluster, unless trials are."""
    trials = tuple(axis for axis in scores.axes if axis == "trial")
    clusters = settings.pop("clusters", trials or ("gap",))
    return table_of(scores, clusters=clusters, **settings)


def test_rows_are_the_statistics_of_the_clusters() -> None:
    scores = trials(8)
    frame = table(scores, within=("length",), blocks=("trial", "gap"), baseline="near").table
    assert list(zip(frame["length"].fillna(0), frame["fill"], strict=True)) == [
        (length, fill) for length in (5, 45, 0) for fill in ("near", "twin", "far")
    ]
    assert frame["length"].dtype == "Int64"
    assert list(frame.columns[2:]) == [
        "blocks", "mean", "low", "high", "arithmetic mean", "median", "ratio", "ratio low",
        "ratio high", "difference", "difference low", "difference high", "p", "p of flips", "g",
        "margin", "wins",
    ]  # fmt: skip
    for row in frame[:6].to_dict("records"):
        values = plainly(scores, row["length"], row["fill"])
        assert row["blocks"] == 40
        means = values.reshape(8, 5).mean(axis=1)
        assert row["mean"] == pytest.approx(gmean(means))
        half = t.ppf(0.975, 7) * sem(np.log(means))
        assert row["low"] == pytest.approx(gmean(means) * np.exp(-half))
        assert row["arithmetic mean"] == pytest.approx(values.mean())
        assert row["median"] == pytest.approx(np.median(values))
    near, twin, far = frame.iloc[:3].to_dict("records")
    y = np.log([plainly(scores, 5, fill).reshape(8, 5).mean(axis=1) for fill in ("far", "near")])
    assert far["ratio"] == pytest.approx(np.exp((y[0] - y[1]).mean()))
    assert 1 < far["ratio low"] < far["ratio"] < far["ratio high"]
    assert far["p of flips"] == 2 / 2**8
    assert far["g"] == pytest.approx(
        (1 - 3 / 27) * (y[0] - y[1]).mean() / (y[0] - y[1]).std(ddof=1)
    )
    assert far["wins"] == "0/8"
    assert all(np.isnan(near[name]) for name in ("ratio", "ratio low", "p"))
    assert [twin[name] for name in ("ratio", "p", "wins")] == [1, 1, "0/8"]


def test_a_row_over_groups_averages_the_logarithms_of_the_means_of_units() -> None:
    scores = trials(8)
    frame = table(scores, within=("length",), blocks=("trial", "gap"), fallback="near").table
    logs = {
        fill: np.log(
            [plainly(scores, length, fill).reshape(8, 5).mean(axis=1) for length in (5, 45)]
        )
        for fill in ("far", "near")
    }
    d = (logs["far"] - logs["near"]).mean(axis=0)
    far = frame[frame["length"].isna() & (frame["fill"] == "far")].iloc[0]
    assert far["ratio"] == pytest.approx(np.exp(d.mean()))
    assert far["mean"] == pytest.approx(np.exp(logs["far"].mean()))
    assert far["p"] <= 0.05
    taken = "The best is clear in each group. "  # but it has a twin: none is the one to take
    assert words(frame)[2].startswith(taken)
    # too few units for any group have none over all of them, nor has a single group
    for few in (trials(2), trials(8, lengths=(5,))):
        assert table(few, within=("length",)).table["length"].notna().all()


def words(frame: pd.DataFrame) -> tuple[str, ...]:
    """Return the answer of a table in words."""
    return info_of(frame).answer.lines


def test_the_answer_names_the_best_and_the_scope() -> None:
    entries = tuple(entry for entry in trials(8) if entry[0]["length"] == 5)
    sentence, scope, certainty, card = words(
        table(Across(trials().axes, entries), within=("length",)).table
    )
    assert re.match(
        r"near and twin are best \([\d.]+\smm\); the other is clearly behind, by 133\s%\.$",
        sentence,
    )
    assert scope.startswith("8 trials: holds for further trials. Mean rmse (mm) of a typical trial")
    assert re.match(
        r"length 5: near and twin, [\d.]+\smm, 95 %: [\d.]+ to [\d.]+; clearly best; next, "
        r"far \+[\d.]+ \(2\.3 times\)\.$",
        card,
    )
    assert certainty == (
        "The best is clear. Clearly: p ≤ 0.05, paired tests over 8 trials, adjusted for 3 methods."
    )


@pytest.mark.parametrize(
    ("actors", "expected"),
    [
        (2, "Lowest mean rmse: near and twin"),
        (2, "The data cannot tell which is best: one repetition where 3 are needed"),
        (4, "The data cannot tell which is best: 4 trials describe the methods"),
        (5, "5 trials: holds for further trials. Provisional, as of 5 trials."),
        (8, "near and twin are best"),
    ],
)
def test_what_is_said_depends_on_the_number_of_clusters(actors: int, expected: str) -> None:
    frame = table(trials(actors, lengths=(5,)), blocks=("trial", "gap")).table
    sentences = [part for line in words(frame) for part in re.split(r"(?<=\.) (?=[A-Z])", line)]
    assert any(part.startswith(expected) for part in [*words(frame), *sentences])
    assert any("the other is clearly behind" in line for line in words(frame)) == (actors >= 5)
    assert ("p" in frame) == (actors >= 5)
    assert ("ratio" in frame) == (actors >= 3)
    assert ("p of flips" in frame) == (actors >= 6)


def test_blocks_of_several_clusters_are_never_averaged() -> None:
    scores = replace(trials(8), sources=("trial",))
    frame = table_of(scores, within=("length",), blocks=("gap",)).table
    assert frame["blocks"].tolist() == [40] * 6 + [80] * 3
    assert frame.equals(table_of(scores, within=("length",), blocks=("trial", "gap")).table)


def test_repetitions_on_one_recording_stand_for_further_ones_of_it() -> None:
    """A number is the mean over all blocks; three repetitions have a verdict on further ones."""
    for count, begins in (
        (2, "Lowest mean rmse in both"),
        (3, "near and twin"),
        (9, "near and twin"),
    ):
        scores = replace(trials(count), sources=())
        frame = table_of(scores, within=("length",)).table
        assert frame["mean"].iloc[2] == pytest.approx(plainly(scores, 5, "far").mean())
        sentence, scope, *_ = words(frame)
        assert sentence.startswith(begins)
        holds = "One recording: holds for further gaps in it, not for others."
        assert (holds in scope) == (count > 2)
    assert (
        '; ten trials are enough: --axis "trial={count: 10}"'
        in words(table_of(replace(trials(2), sources=()), within=("length",)).table)[0]
    )


@pytest.mark.parametrize(
    ("frames", "expected"),
    [
        (
            1000,
            "fewer than three repetitions, and 20 gaps leave one of 6 segments of time without any",
        ),
        (
            500,
            "fewer than three repetitions, and 500 frames where 900 are needed; an axis",
        ),
    ],
)
def test_a_recording_without_enough_segments_is_said_to_lack_what_it_lacks(
    frames: int, expected: str
) -> None:
    random = np.random.default_rng(0)
    scores = {
        name: scored(random.lognormal(size=20)).assign(start=np.arange(20) * 7, frames=5)
        for name in ("a", "b")
    }
    take = TableInfo(take=Take(frames, correlation=10.0))
    scores = {name: with_info(each, take) for name, each in scores.items()}
    sentence, scope, *_ = words(table_of(Across.of(scores, axis="fill")).table)
    assert expected in sentence
    assert "nothing is said for further gaps in it." in scope


def test_a_shortage_of_several_groups_is_said_once_by_the_largest() -> None:
    random = np.random.default_rng(0)
    entries = tuple(
        (
            {"length": length, "fill": name},
            with_info(
                scored(random.lognormal(size=20)).assign(start=np.arange(20) * 7, frames=length),
                TableInfo(take=Take(300, correlation=10.0)),
            ),
        )
        for length in (15, 20)
        for name in ("a", "b")
    )
    scores = Across(("length", "fill"), entries)
    sentence, _, *cards = words(table_of(scores, within=("length",)).table)
    assert sentence.count("fewer than three") == 1
    assert "300 frames where 1,440 are needed" in sentence
    assert "more reason" not in sentence
    assert not any("fewer than three" in card for card in cards)


def test_the_answer_names_who_is_not_clearly_behind() -> None:
    near = [1.0, 1.2, 0.9, 1.1, 1.2, 1.0, 0.9, 1.1]
    tables = {"a": near, "b": [1.3, 1.0, 0.9, 1.2] * 2, "far": [9.0, 9.1, 9.2, 9.0] * 2, "a2": near}
    scores = {name: scored(values) for name, values in tables.items()}
    for start in ("a and a2 share", "a has"):
        sentence = words(table(Across.of(scores, axis="fill")).table)[0]
        assert re.match(
            rf"{start} the lowest mean rmse \(1\.04\smm\); may be as good: b \+0\.0\d+\smm, "
            r"worse in \d( and equal in \d)? of 8 gaps, p = [\d.]+; the other clearly behind\.$",
            sentence,
        )
        scores.pop("a2", None)


@pytest.mark.parametrize(
    "tables",
    [
        {"a": 1.0, "b": (1.001, 1.002, 1.001, 1.003, 1.002, 1.4, 1.001, 1.002)},
        {"a": 1.0, "b": (1.01, 1.05, 1.02, 1.06, 1.01, 1.04, 1.09, 1.01),
         "c": (0.9, 1.2, 1.1, 1.0, 1.2, 0.9, 1.1, 1.0),
         "d": (1.2, 0.9, 1.0, 1.1, 0.9, 1.1, 1.2, 1.0)},
    ],
)  # fmt: skip
def test_what_is_worse_everywhere_and_not_certain_has_its_p(tables: dict[str, Any]) -> None:
    scores = {name: scored(np.ones(8) * values) for name, values in {**tables, "far": 9.0}.items()}
    frame = table(Across.of(scores, axis="fill")).table
    found = re.search(
        r"may be as good: b \+0\.0\d+\smm, worse in 8 of 8 gaps, p = (0\.\d+)[;.]", words(frame)[0]
    )
    assert found
    assert float(found[1]) == pytest.approx(frame.set_index("fill")["p"]["b"], rel=0.05)
    assert float(found[1]) > 0.05


def test_few_large_errors_that_decide_the_mean_are_in_the_notes() -> None:
    random = np.random.default_rng(0)
    wild = np.where(np.arange(80) % 10 == 0, 20.0, 0.5)
    tables = {"even": np.ones(80), "wild": wild}
    scores = {
        name: scored(values * random.uniform(0.99, 1.01, 80)).assign(actor=np.arange(80) // 10)
        for name, values in tables.items()
    }
    frame = table(Across.of(scores, axis="f"), blocks=("gap",), clusters=("actor",)).table
    assert words(frame)[0].startswith("even is best (1.00\N{NO-BREAK SPACE}mm); ")
    notes = " ".join(info_of(frame).notes)
    assert "wild is better than even in most gaps (90 %), so that few large errors decide" in notes


def test_the_number_shown_is_the_number_compared() -> None:
    tables = {"often": [1.0] * 7 + [20.0], "rarely": [1.2] * 7 + [9.0]}
    scores = Across.of({name: scored(values) for name, values in tables.items()}, axis="f")
    frame = table(scores).table
    assert frame["f"].tolist() == ["often", "rarely"]
    assert (frame["mean"].diff()[1:] > 0).all()
    assert (frame["arithmetic mean"].diff()[1:] < 0).all()
    assert frame["ratio"].iloc[1] == pytest.approx(frame["mean"].iloc[1] / frame["mean"].iloc[0])
    shown = render_table(frame, "")
    assert b"arithmetic mean" in shown.files[".csv"]
    for text in (shown.html.split("<template")[0], shown.text, shown.files[".tex"].decode()):
        assert "arithmetic mean" not in text


def test_what_is_equal_within_the_margin_is_in_the_answer() -> None:
    random = np.random.default_rng(0)
    base = random.lognormal(size=8)
    tables = {"a": base, "b": base * random.uniform(0.99, 1.03, 8), "c": base * 1.5}
    scores = Across.of({name: scored(values) for name, values in tables.items()}, axis="fill")
    card = words(table(scores, equivalent=1.1).table)[-1]
    assert "equal: to a within 1.1: b" in card
    card = words(table(scores, equivalent="0.001 mm").table)[-1]
    assert "none is shown to be equal to a within 0.001 mm (nearest: b within " in card
    with pytest.raises(ValueError, match=r"equivalent: 0\.1 cm is not in the unit of rmse, mm"):
        table(scores, equivalent="0.1 cm")


@pytest.mark.parametrize("value", [1, 0.9, -2.0, "0 mm", "-1 mm", "1.1", "mm", float("inf")])
def test_margins_that_mean_nothing_are_refused(value: Any) -> None:
    with pytest.raises(ValueError, match="above"):
        margin_of(value)


def test_means_of_zero_are_compared_by_differences() -> None:
    random = np.random.default_rng(0)
    missed = random.uniform(0.0, 0.1, 8)
    missed[2] = 0.0
    scores = Across.of({"a": scored(missed), "b": scored(missed + 0.2)}, axis="fill")
    frame = table(scores).table
    assert frame["difference"].tolist()[1] == pytest.approx(0.2)
    assert info_of(frame).units["margin"] == info_of(frame).units["difference low"] == "mm"
    with pytest.raises(ValueError, match="means of 0 or below, which have no ratio"):
        table(scores, equivalent=1.1)


def test_one_block_with_all_the_variance_decides_nothing() -> None:
    near = np.random.default_rng(3).lognormal(sigma=0.1, size=9)
    wild = near.copy()
    wild[4] *= 1e6
    result = table(Across.of({"a": scored(near), "wild": scored(wild)}, axis="fill"))
    assert "The data cannot tell which is best: no difference is clear." in words(result.table)[0]
    (verdict,) = result.overview.verdicts.groups
    assert not verdict.marks
    assert verdict.mean[1] / verdict.mean[0] == pytest.approx(1e6 ** (1 / 9))


def test_forty_methods_have_a_verdict() -> None:
    random = np.random.default_rng(3)
    near = random.lognormal(sigma=0.1, size=9)
    values = [near * random.uniform(0.97, 1.03, 9) for _ in range(30)]
    values += [near * random.uniform(5, 50, 9) for _ in range(10)]
    tables = {str(at): scored(each) for at, each in enumerate(values)}
    result = table(Across.of(tables, axis="fill"))
    (verdict,) = result.overview.verdicts.groups
    assert set(range(30, 40)) <= set(verdict.behind)
    assert re.search(r"; \d+ more; the other \d+ clearly behind", " ".join(words(result.table)[:2]))


def test_what_nothing_is_missing_for_has_no_columns_and_remarks_on_all_groups_stand_once() -> None:
    frame = table(trials(8), within=("length",), fallback="far").table
    assert {"mean, common blocks", "mean, worst of block"}.isdisjoint(frame)
    info = info_of(frame)
    assert sum("fewer than 10 blocks in some of the trials" in note for note in info.notes) == 1
    near, far = frame["mean"].iloc[0], frame["mean"].iloc[2]
    assert frame["difference"].tolist()[2] == pytest.approx(far - near)
    assert frame["difference low"].iloc[2] < far - near < frame["difference high"].iloc[2]
    assert info.units["difference"] == info.units["difference low"] == "mm"


def test_groups_with_one_answer_share_a_sentence() -> None:
    frame = table(trials(8), within=("length",)).table
    bests = sorted(frame[frame["fill"] == "near"]["mean"][:2])
    assert words(frame)[0] == (
        f"near and twin are best throughout ({span_text(bests, 'mm')} by length); the other is "
        "clearly behind, by 125\N{NO-BREAK SPACE}% or more."
    )


def test_an_interval_of_shares_and_counts_does_not_go_below_none_unless_they_do() -> None:
    wrong = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3])
    for shift, unit in ((0.0, "share"), (-0.01, "share"), (0.0, "mm"), (0.0, "of 100 links")):
        info = TableInfo(units={"rmse": unit})
        entries = {"few": wrong + shift, "more": wrong + 0.1}
        scores = {name: with_info(scored(each), info) for name, each in entries.items()}
        frame = table(Across.of(scores, axis="fill"), blocks=("gap",)).table
        (low,) = frame.loc[frame["fill"] == "few", "low"]
        assert (low == 0.0) == (shift == 0.0 and unit != "mm")
        assert low <= 0.0


def test_shares_are_reported_in_percent_and_powers_as_they_are_printed() -> None:
    for unit, text in (
        ("share", "(18.6\N{NO-BREAK SPACE}%)"),
        ("mm^2", "(0.186\N{NO-BREAK SPACE}mm²)"),
    ):
        tables = {"a": scored([0.2, 0.1, 0.3, 0.2]), "b": scored([0.4, 0.5, 0.6, 0.5])}
        info = TableInfo(units={"rmse": unit})
        tables = {name: with_info(scores, info) for name, scores in tables.items()}
        result = table(Across.of(tables, axis="fill"))
        assert text in words(result.table)[0]


def test_incomplete_blocks_are_dropped_for_all_and_reported() -> None:
    scores = Across.of(
        {"a": scored([1, 2, 3, 4]), "b": scored([1, NAN, 5, 6]), "c": scored([0, 9, 1])},
        axis="fill",
    )
    with pytest.warns(UserWarning, match=r"2 of 4 blocks left out \(b lacks 1, c lacks 1\)"):
        frame = table(scores).table
    assert frame["blocks"].tolist() == [2, 2, 2]
    assert dict(zip(frame["fill"], frame["mean"], strict=True)) == {"c": 0.5, "a": 2.0, "b": 3.0}
    assert dict(zip(frame["fill"], frame["left missing"], strict=True))["b"] == 0.25
    assert "used: 2 of 4 gaps, the rest left out: b lacks 1" in words(frame)[-1]
    assert any("2 of 4 blocks left out (b lacks 1, c" in note for note in info_of(frame).notes)


def test_a_method_without_any_number_leaves_the_others_their_blocks() -> None:
    scores = Across.of(
        {"a": scored([1, 2]), "b": scored([NAN, NAN]), "c": scored([2, 4])}, axis="f"
    )
    with pytest.warns(UserWarning, match="without any number, not compared: b"):
        frame = table(scores, baseline="a").table
    assert frame["f"].tolist() == ["a", "c", "b"]
    assert "without any number, not compared: b" in info_of(frame).notes
    assert frame["blocks"].tolist() == [2, 2, 0]
    assert frame.loc[2, ["mean", "low", "median"]].isna().all()


def test_a_method_without_any_number_is_not_said_to_be_behind() -> None:
    near = np.array([1.0, 1.2, 0.9, 1.1, 1.2, 1.0, 0.9, 1.1])
    scores = {"a": scored(near), "far": scored(9 * near), "none": scored(NAN * near)}
    with pytest.warns(UserWarning, match="without any number, not compared: none"):
        result = table(Across.of(scores, axis="fill"))
    sentence = words(result.table)[0]
    end = "the other is clearly behind, by 800 %. Not compared, without any number: none."
    assert sentence.replace("\N{NO-BREAK SPACE}", " ").endswith(end)
    shown = html_of(result.overview.answer.sentence)
    assert shown.endswith('without any number: <span data-method="none">none</span>.')


def test_rows_over_groups_count_the_same_results_once() -> None:
    both = trials(8, lengths=(5,))
    entries = [
        ({**labels, "ends": ends}, each.assign(rmse=each["rmse"] * factor))
        for ends, more in (("as_published", 1.0), ("met", 0.8))
        for labels, each in both
        for factor in [1.0 if labels["fill"] == "near" else more]
    ]
    scores = Across(("trial", "length", "ends", "fill"), tuple(entries), sources=("trial",))
    frame = table_of(scores, compare="fill", within=("length", "ends"), blocks=("gap",)).table
    overall = frame[frame["length"].isna()].set_index("fill")
    assert overall["blocks"].to_dict() == {"near": 40, "twin": 80, "far": 80}
    assert overall.loc["near", "mean"] == pytest.approx(frame["mean"][frame["fill"] == "near"][:1])


def both_ways(count: int) -> Across[Table]:
    """Two ways of every fill: `met` halves the errors of `far`, and raises those of `near`."""
    entries = [
        ({**labels, "ends": ends}, each.assign(rmse=each["rmse"] * factors[str(labels["fill"])]))
        for ends, factors in (
            ("plain", {"near": 1.0, "twin": 1.0, "far": 1.0}),
            ("met", {"near": 1.1, "twin": 1.0, "far": 0.5}),
        )
        for labels, each in trials(count)
    ]
    axes = ("trial", "ends", "length", "fill")
    declared: dict[Label, Declared] = {
        name: {"axes": ("ends",)} for name in ("near", "twin", "far")
    }
    return Across(axes, tuple(entries), sources=("trial",), methods={"fill": declared})


def test_the_better_of_two_ways_of_every_method_is_said() -> None:
    settings: Any = {"compare": "fill", "within": ("ends", "length"), "blocks": ("trial", "gap")}
    result = table(both_ways(8), **settings)
    (variation,) = result.overview.verdicts.variations
    assert (variation.axis, variation.label, variation.other) == ("ends", "met", "plain")
    methods = result.overview.verdicts.methods
    better, worse = ([methods[at] for at in at] for at in (variation.better, variation.worse))
    assert (better, worse, variation.methods) == (["far"], ["near"], 3)
    said = "Ends met: better than ends plain for 1 of 3 fills at every length; worse for near."
    assert said in words(result.table)[0]
    # too few units decide nothing, and neither does an axis that no method has
    assert not table(both_ways(4), **settings).overview.verdicts.variations
    unknown = replace(both_ways(8), methods={})
    assert not table(unknown, **settings).overview.verdicts.variations


def test_a_block_in_which_every_method_fails_is_suspect_in_measured_data_alone() -> None:
    random = np.random.default_rng(0)
    errors = np.append(random.uniform(0.9, 1.1, 79), 50.0)
    scores = {
        name: scored(errors * factor).assign(actor=np.arange(80) // 10)
        for name, factor in {"a": 1.0, "b": 1.2}.items()
    }
    across = Across.of(scores, axis="fill")

    def notes(of: Across[Any]) -> str:
        return " ".join(info_of(table(of, blocks=("gap",), clusters=("actor",)).table).notes)

    assert "(actor 7, gap 79: every method errs much)" in notes(across)
    assert "suspect" not in notes(replace(across, synthetic=True))


def test_a_group_of_which_every_block_is_suspect_says_nothing_without_them() -> None:
    length, actor = np.repeat([5, 45], 12), np.tile(np.arange(6).repeat(2), 2)
    errors = np.random.default_rng(0).uniform(0.9, 1.1, 24)
    suspect = np.where(length == 5, "impulse", "")
    scores = {
        name: scored(errors * factor).assign(actor=actor, length=length, suspect=suspect)
        for name, factor in {"near": 1.0, "far": 2.0}.items()
    }
    across = Across.of(scores, axis="fill")
    settings: Any = {"within": ("length",), "blocks": ("gap",), "clusters": ("actor",)}
    verdicts = table(across, **settings).overview.verdicts
    short, long = verdicts.groups
    assert len(short.suspects) == 12
    assert short.without_suspects is not None
    assert not short.without_suspects.best
    assert long.without_suspects is None


def test_what_is_found_on_synthetic_faces_holds_for_further_ones() -> None:
    scores = replace(trials(8), sources=("trial",), synthetic=True)
    entries = [({**labels, "recording": labels["trial"]}, each) for labels, each in scores]
    scores = replace(
        scores, axes=("recording", "length", "fill"), entries=tuple(entries), sources=("recording",)
    )
    verdicts = table_of(scores, within=("length",)).overview.verdicts
    held, *rest = scope_words(verdicts)
    assert held == Word("8 synthetic faces: holds for further synthetic faces; untested on people.")
    scope = plain(tuple(rest))
    assert "synthetic face (geometric mean over faces), lower is better; differences" in scope
    assert "recording" not in scope


def test_a_number_of_two_actors_is_of_a_recording_of_theirs() -> None:
    entries = [
        ({**labels, "actor": actor}, each) for actor in ("anna", "bo") for labels, each in trials(4)
    ]
    axes = ("actor", "trial", "length", "fill")
    verdicts = table_of(Across(axes, tuple(entries), sources=("actor",))).overview.verdicts
    scope = plain(scope_words(verdicts))
    assert "holds for further gaps in these 2 recordings, not for others." in scope
    assert (
        "of a typical recording (geometric mean over recordings), lower is better; differences"
        in scope
    )


def test_a_baseline_without_any_number_gives_no_differences() -> None:
    scores = Across.of({"a": scored([1, 2]), "b": scored([NAN, NAN])}, axis="fill")
    with pytest.warns(UserWarning, match="not compared: b"):
        frame = table(scores, baseline="b").table
    assert {"ratio", "p", "wins"}.isdisjoint(frame)


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
    assert frame["mean"].tolist() == [pytest.approx(gmean([1, 2, 3]))]
    assert words(frame)[0].startswith(
        "The mean rmse of only is 1.82\N{NO-BREAK SPACE}mm. There is nothing"
    )
    assert info_of(frame).best == {"mean": ()}


def test_one_block_has_no_spread() -> None:
    scores = Across.of({"a": scored([1]), "b": scored([2])}, axis="fill")
    frame = table(scores, baseline="a", clusters=()).table
    assert frame["mean"].tolist() == [1, 2]
    assert frame[["low", "high"]].isna().all(axis=None)
    assert words(frame)[0].startswith("Lowest mean rmse: a (1.00\N{NO-BREAK SPACE}mm), then b")
    assert "nothing is said for further" in words(frame)[1]


def test_no_common_block_says_nothing() -> None:
    scores = Across.of({"a": scored([1, NAN]), "b": scored([NAN, 2])}, axis="fill")
    with pytest.warns(UserWarning, match=r"2 of 2 blocks left out"):
        result = table(scores, baseline="a")
    assert result.table["blocks"].tolist() == [0, 0]
    assert result.table["mean"].isna().all()
    assert "nothing can be said" in words(result.table)[0]


def test_tables_without_rows_are_reported() -> None:
    empty = Across.of({"a": scored([])}, axis="fill")
    with pytest.warns(UserWarning, match="the tables have no rows"):
        result = table(empty)
    assert len(result.table) == 0


def test_numbers_label_methods_as_well() -> None:
    scores = Across.of({3: scored([1, 2, 4]), 5: scored([2, 4, 8])}, axis="order")
    frame = table(scores, baseline="3").table
    assert frame["order"].tolist() == [3, 5]
    assert frame["ratio"].tolist()[1] == pytest.approx(2.0)
    with pytest.raises(ValueError, match="no baseline '4'; compared are: 3, 5"):
        table(scores, baseline="4")


def declared(end: BetterEnd) -> Across[Table]:
    tables = {"a": scored([0.9, 0.8, 0.95, 0.9]), "b": scored([0.5, 0.4, 0.6, 0.5])}
    info = TableInfo(units={"rmse": "mm"}, better={"rmse": end})
    return Across.of({name: with_info(table, info) for name, table in tables.items()}, axis="fill")


def test_the_best_is_at_the_end_that_the_scores_declare() -> None:
    frame = table(declared("higher"), baseline="b").table
    assert frame["fill"].tolist() == ["a", "b"]
    assert info_of(frame).best == {"mean": ()}  # four units have no verdict
    assert frame["wins"].tolist()[0] == "4/4"
    assert "Highest mean rmse: a (0.88" in words(frame)[0]
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
    better: object, order: list[str]
) -> None:
    # 0.1 + 0.2 + 0.3 is more than 0.3 + 0.2 + 0.1: such errors do not decide which stands first
    values = {"a": [4, 4, 4], "b": [0.1, 0.2, 0.3], "b2": [0.3, 0.2, 0.1], "c": [0, 0.1, 0]}
    scores = Across.of({name: scored(value) for name, value in values.items()}, axis="fill")
    assert table(scores, better=better).table["fill"].tolist() == order


def test_a_metric_without_a_better_end_has_no_best() -> None:
    frame = table(declared("none"), baseline="b").table
    assert info_of(frame).best == {"mean": ()}
    assert "wins" not in frame
    assert words(frame)[0] == "Mean rmse in mm falls from 0.888 (a) to 0.500 (b)."


def test_against_a_baseline_it_is_stated_who_differs() -> None:
    frame = table(trials(8), within=("length",), baseline="far").table
    assert words(frame)[0].endswith("Against far: near and twin are better throughout.")


def test_a_constant_metric_has_intervals_without_width_and_no_winner_ahead() -> None:
    scores = Across.of({"a": scored([0.1] * 7), "b": scored([0.1] * 7)}, axis="fill")
    frame = table(scores, baseline="a").table
    assert frame["low"].tolist() == pytest.approx([0.1, 0.1])
    assert frame["p"].tolist()[1] == 1.0
    assert info_of(frame).best == {"mean": ()}
    sentence, scope, *_ = words(frame)
    assert sentence.startswith("a and b have the same mean rmse (0.100\N{NO-BREAK SPACE}mm).")
    assert "Provisional, as of 7 gaps." in scope


def test_blocks_that_differ_by_rounding_alone_have_no_deviation() -> None:
    nearly = [0.35, 0.35 + 6e-17, 0.35 - 6e-17, 0.35]
    scores = Across.of({"a": scored(nearly), "b": scored([1, 2, 3, 4])}, axis="fill")
    frame = table(scores).table
    assert frame[["low", "high"]].iloc[0].tolist() == [pytest.approx(0.35)] * 2


def test_infinite_scores_are_lacking() -> None:
    scores = Across.of({"a": scored([1, 2, 3]), "b": scored([1, np.inf, -np.inf])}, axis="fill")
    with pytest.warns(UserWarning, match="b lacks 2"):
        frame = table(scores).table
    assert frame["mean"].tolist() == [1.0, 1.0]


def test_many_groups_are_reported_in_one_sentence() -> None:
    rows = pd.DataFrame({"marker": np.repeat(range(20), 3), "take": [0, 1, 2] * 20})
    tables = {
        "a": rows.assign(rmse=1.0),
        "b": rows.assign(rmse=np.where(rows["marker"] < 5, 0.5, 2.0)),
    }
    scores = Across.of(tables, axis="fill")
    frame = table(scores, within=("marker",), blocks=("take",), clusters=()).table
    sentence, _ = words(frame)
    assert sentence.startswith(
        "Lowest mean rmse: b for 0, 1, 2, 3 and 4 (0.500); a for 5, 6, 7, 8, 9 and 10 more (1.00). "
        "The data cannot tell which is best: one repetition where 3 are needed"
    )


def narrow(lacking: int, *, unit: str = "gap") -> Across[Table]:
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
def test_the_answer_counts_the_blocks_that_are_left_and_notes_say_because_of_whom() -> None:
    for lacking, left, whom in (
        (6, "used: 14 of 20 gaps", "timid lacks 1, shy lacks 6"),
        (20, "used: 19 of 20 gaps", "timid lacks 1"),
    ):
        frame = table(narrow(lacking)).table
        assert left in words(frame)[-1]
        assert any(f"of 20 blocks left out ({whom})" in note for note in info_of(frame).notes)


@pytest.mark.filterwarnings("ignore:.*blocks left out")
def test_blocks_have_their_name_where_one_column_tells_them() -> None:
    markers = table(narrow(6, unit="marker"), clusters=("marker",)).table
    assert "used: 14 of 20 markers" in words(markers)[-1]
    # a block is a take and a gap: neither tells which one it is
    scores = Across.of(
        {at["fill"]: value.assign(take=0) for at, value in narrow(6)},
        axis="fill",
    )
    assert "used: 14 of 20 blocks" in words(table(scores, blocks=("take", "gap")).table)[-1]


@pytest.mark.filterwarnings("ignore:.*blocks left out")
def test_groups_of_which_few_blocks_are_left_are_distinguished() -> None:
    both = [
        ({**at, "length": length}, value)
        for length, scores in ((5, narrow(1)), (45, narrow(15)))
        for at, value in scores
    ]
    frame = table(Across(("length", "fill"), tuple(both)), within=("length",)).table
    short, long = words(frame)[3:5]
    assert short.startswith("length 5: bold")
    assert "used: 19 of 20 gaps" in short
    assert long.startswith("length 45: ")
    assert "used: 5 of 20 gaps" in long


def test_units_follow_the_metric() -> None:
    units = info_of(table(trials(), baseline="far").table).units
    assert units["mean"] == units["high"] == units["median"] == "mm"
    assert units["p"] == "chance"
    assert {"ratio", "margin"}.isdisjoint(units)


def test_gathered_tables_stay_as_they_are() -> None:
    scores = trials(2)
    before = [value.copy() for value in scores.values()]
    table(scores)
    assert all(value.equals(two) for value, two in zip(scores.values(), before, strict=True))


@settings(max_examples=8)
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
    for name in ("mean", "median", "low", "high"):
        assert two[name].to_numpy() == pytest.approx(
            value[name].to_numpy() * factor, rel=1e-9, abs=1e-9
        )


def test_the_outputs_have_their_names() -> None:
    described = node_of(table_of)
    assert described is not None
    assert [str(port) for port in described.outputs] == [
        "table: Table",
        "figure: Figure",
        "overview: Overview",
    ]
    assert described.inputs[0].across
