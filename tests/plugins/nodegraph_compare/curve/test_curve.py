from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.stats import t

from nodegraph import Absent, Across, Label
from nodegraph.node.decorator import node_of
from nodegraph_compare.curve.node import Curve, curve
from nodegraph_mocap import Table
from nodegraph_tables import TableInfo, info_of, with_info

NAN = np.nan
VALLEY = {5: 0.9, 15: 0.5, 25: 0.2, 35: 0.1, 45: 0.3, 55: 0.25}
SLOPE = {5: 0.9, 15: 0.5, 25: 0.2, 35: 0.1, 45: 0.09, 55: 0.08}


def point(markers: float, mse: float) -> pd.DataFrame:
    frame = pd.DataFrame({"markers": [markers], "mse": [mse]})
    frame = with_info(frame, TableInfo(units={"mse": "1"}))
    return frame


def swept(**actors: dict[Any, float]) -> Across[Table]:
    """One table for each actor and k; k is five less than the number of markers."""
    entries: list[tuple[dict[str, Label], Table]] = [
        ({"actor": actor, "k": markers - 5}, point(markers, mse))
        for actor, values in actors.items()
        for markers, mse in values.items()
    ]
    return Across(("actor", "k"), tuple(entries))


def drawn(scores: Across[Table], floor: Any = None, **settings: Any) -> Curve:
    chosen = {"x": "markers", "metric": "mse", "compare": "actor", **settings}
    return curve(scores, floor, **chosen)


def best(result: Curve) -> pd.DataFrame:
    return result.table[result.table["marked"] != ""]


def floor(**levels: list[float]) -> Across[Table]:
    return Across.of(
        {name: pd.DataFrame({"mse": axis}) for name, axis in levels.items()}, axis="actor"
    )


def test_a_row_per_point_in_the_order_of_labels_and_of_x() -> None:
    frame = drawn(swept(ME=VALLEY, JZ=dict(reversed(SLOPE.items())))).table
    assert list(frame.columns) == [
        "actor", "k", "markers", "mse", "rows", "on curve", "local minimum", "marked",
    ]  # fmt: skip
    assert frame["actor"].tolist() == ["ME"] * 6 + ["JZ"] * 6
    assert frame["markers"].tolist() == [*VALLEY, *SLOPE]
    assert frame["markers"].dtype == np.int64
    assert frame["mse"].tolist() == [*VALLEY.values(), *SLOPE.values()]
    assert frame["k"].tolist() == [markers - 5 for markers in (*VALLEY, *SLOPE)]
    assert frame.loc[frame["local minimum"], ["actor", "markers"]].to_numpy().tolist() == [
        ["ME", 35]
    ]
    assert (frame["marked"] == "").all()
    assert frame["on curve"].all()
    assert info_of(frame).title == "mse over markers by actor"
    assert info_of(frame).units == {"mse": "1"}


def test_the_curve_takes_the_lowest_of_several_points_at_one_x() -> None:
    entries: list[tuple[dict[str, Label], Table]] = [
        ({"actor": "ME", "k": k}, point(markers, mse))
        for k, markers, mse in [(5, 9, 0.5), (10, 9, 0.4), (15, 9, 0.4), (20, 11, 0.1)]
    ]
    frame = drawn(Across(("actor", "k"), tuple(entries))).table
    assert frame["markers"].tolist() == [9, 9, 9, 11]
    assert frame["k"].tolist() == [10, 15, 5, 20]
    assert frame["on curve"].tolist() == [True, False, False, True]
    mean = drawn(Across(("actor", "k"), tuple(entries)), lowest=False).table
    assert mean["mse"].tolist() == pytest.approx([1.3 / 3, 0.1])
    assert mean["rows"].tolist() == [3, 1]
    assert "k" not in mean.columns


def test_repeats_are_averaged_with_an_interval_over_blocks() -> None:
    random = np.random.default_rng(0)
    rmse = random.uniform(size=(8, 2, 5))
    entries: list[tuple[dict[str, Label], Table]] = [
        ({"trial": trial, "length": 10 * place}, pd.DataFrame({"rmse": rmse[trial, place]}))
        for trial in range(8)
        for place in range(2)
    ]
    scores = Across(("trial", "length"), tuple(entries))
    frame = curve(scores, x="length", blocks=("trial",)).table
    assert frame["length"].tolist() == [0, 10]
    assert frame["blocks"].tolist() == [8, 8]
    for place, row in enumerate(frame.to_dict("records")):
        means = rmse[:, place].mean(axis=1)
        whole = means.mean()  # of one recording, whose repetitions say how certain it is
        others = np.log(whole) - np.log((8 * whole - means) / 7)
        half = t.ppf(0.975, 7) * np.sqrt(7) * others.std()
        assert row["rmse"] == pytest.approx(whole)
        ends = [whole * np.exp(-half), whole * np.exp(half)]
        assert [row["low"], row["high"]] == pytest.approx(ends)
    assert "for further trial of the same recording" in info_of(frame).notes[0]


def test_of_repeats_the_lowest_is_that_of_their_means() -> None:
    errors = {("a", 0): 1.0, ("a", 1): 5.0, ("b", 0): 2.0, ("b", 1): 2.0}
    entries: list[tuple[dict[str, Label], Table]] = [
        ({"search": search, "trial": trial, "actor": "ME"}, point(9, mse))
        for (search, trial), mse in errors.items()
    ]
    scores = Across(("search", "trial", "actor"), tuple(entries))
    frame = curve(scores, x="markers", metric="mse", blocks=("trial",)).table
    assert frame[["search", "mse", "on curve"]].to_numpy().tolist() == [
        ["b", 2.0, True], ["a", 3.0, False],
    ]  # fmt: skip


def test_a_shared_minimum_is_named_and_marked_on_every_curve() -> None:
    near = {**VALLEY, 35: 0.15, 37: 0.1}
    result = drawn(swept(ME=VALLEY, MB=near, JZ=VALLEY), mark="shared")
    assert best(result)[["actor", "k", "markers", "marked"]].to_numpy().tolist() == [
        ["ME", 30, 35, "shared"], ["MB", 32, 37, "shared"], ["JZ", 30, 35, "shared"],
    ]  # fmt: skip
    sentence, _, certainty, card = info_of(result.table).answer.lines
    assert sentence == "All 3 curves have a minimum within 2 of 35 markers."
    assert certainty == "Each point is of one draw, without an interval."
    assert card.startswith("mse over markers: 35 to 37 markers, shared minimum; actor ME: 35")
    assert "; actor MB: 37 markers, mse 0.100" in card
    assert result.figure.get_suptitle() == "minimum shared at 35 markers"
    apart = drawn(swept(ME=VALLEY, MB=near, JZ=VALLEY), mark="shared", tolerance=1)
    assert set(best(apart)["marked"]) == {"knee"}


def test_without_a_shared_minimum_the_knees_are_marked_and_it_is_stated() -> None:
    result = drawn(swept(ME=VALLEY, JZ=SLOPE), mark="shared")
    assert best(result)[["actor", "markers", "marked"]].to_numpy().tolist() == [
        ["ME", 25, "knee"], ["JZ", 25, "knee"],
    ]  # fmt: skip
    sentence, *_, card = info_of(result.table).answer.lines
    assert sentence == "From 25 markers on, more of them help less (both curves)."
    assert re.findall(r"actor \w+: 25 markers, mse", card) == [
        "actor ME: 25 markers, mse", "actor JZ: 25 markers, mse",
    ]  # fmt: skip
    assert any(note.startswith("knee: ") for note in info_of(result.table).notes)
    assert result.figure.get_suptitle() == "no minimum shared within 2 markers"


def test_each_curve_has_its_own_lowest_minimum() -> None:
    twice = {5: 0.9, 15: 0.3, 25: 0.5, 35: 0.2, 45: 0.3}
    result = drawn(swept(ME=twice, JZ=SLOPE), mark="minimum")
    assert best(result)[["actor", "markers", "marked"]].to_numpy().tolist() == [
        ["ME", 35, "minimum"], ["JZ", 25, "knee"],
    ]  # fmt: skip


def test_shares_are_in_percent() -> None:
    info = TableInfo(units={"mse": "share"})
    scores = swept(ME=VALLEY, JZ=VALLEY)
    entries = tuple((labels, with_info(table, info)) for labels, table in scores)
    result = drawn(replace(scores, entries=entries), mark="minimum")
    assert "mse 10.0\N{NO-BREAK SPACE}%" in info_of(result.table).answer.lines[-1]
    assert result.figure.axes[0].yaxis.get_major_formatter()(0.07) == "7"


def test_an_error_that_is_small_enough_is_marked_where_a_curve_stays_within_it() -> None:
    result = drawn(swept(ME=VALLEY, JZ=SLOPE, MB=dict.fromkeys(VALLEY, 0.4)), mark=0.25)
    assert best(result)[["actor", "markers", "marked"]].to_numpy().tolist() == [
        ["ME", 55, "enough"], ["JZ", 25, "enough"],
    ]  # fmt: skip
    sentence, *_, card = info_of(result.table).answer.lines
    assert sentence == (
        "55 markers are enough for mse of at most 0.250\N{NO-BREAK SPACE}1 in 2 of 3 curves; "
        "the others do not come to it."
    )
    assert "; actor ME: 55 markers, mse 0.250" in card
    assert "; actor MB: not reached, lowest at 5 markers, mse 0.400" in card
    assert any(note.startswith("enough: ") for note in info_of(result.table).notes)
    assert "Dashed" in str(result.figure.get_supxlabel())
    assert info_of(result.table).answer.findings == ()
    both = info_of(drawn(swept(ME=VALLEY, JZ=SLOPE), mark=0.25).table).answer
    assert [(found.group, found.mean) for found in both.findings] == [
        ({"actor": "ME"}, {"": 55.0}), ({"actor": "JZ"}, {"": 25.0}),
    ]  # fmt: skip
    # what is enough for every curve stands out, as one number
    assert both.overall is not None
    assert both.overall.mean == {"": 55}
    assert both.overall.beside == {"next fewer": {"": 45}}
    assert both.lines[0].startswith(
        "55 markers are enough for mse of at most 0.250\N{NO-BREAK SPACE}1 in both curves "
        "(25 to 55 by curve)."
    )
    assert (both.cards[0].headline, both.cards[0].value) == (
        ("55 markers",), ("enough for both curves",),
    )  # fmt: skip
    none = drawn(swept(ME=VALLEY, JZ=SLOPE), mark=0.01)
    assert info_of(none.table).answer.lines[0] == (
        "No curve comes to mse of at most 0.010\N{NO-BREAK SPACE}1, with up to 55 markers."
    )


def test_a_straight_curve_has_nothing_to_mark() -> None:
    result = drawn(swept(ME={1: 3.0, 2: 2.0, 3: 1.0}), mark="shared")
    assert info_of(result.table).answer.lines[0].startswith("Neither a minimum nor a knee to mark")
    assert not len(best(result))
    assert list(best(result).columns) == list(result.table.columns)


def test_the_noise_floor_is_the_mean_of_each_label_and_what_reaches_it_is_reported() -> None:
    levels = floor(ME=[0.2, 0.3], JZ=[0.01])
    frame = drawn(swept(ME=VALLEY, JZ=SLOPE), levels, mark="shared").table
    assert frame["floor"].unique().tolist() == [0.25, 0.01]
    me = frame[frame["actor"] == "ME"]
    assert me.loc[me["below floor"], "markers"].tolist() == [25, 35, 55]
    assert not frame.loc[frame["actor"] == "JZ", "below floor"].any()
    assert re.findall(r"\(.*?\)", info_of(frame).answer.lines[-1]) == [
        "(noise 0.250\N{NO-BREAK SPACE}1, reached at 55)",
        "(noise 0.010\N{NO-BREAK SPACE}1, not reached)",
    ]


def test_the_knee_is_that_of_the_curve_as_drawn_and_of_nothing_below_the_noise() -> None:
    steep = {1: 1.0, 2: 0.3, 3: 0.02, 4: 0.01, 5: 0.0, 6: 0.0}
    assert best(drawn(swept(ME=SLOPE), mark="shared"))["markers"].tolist() == [25]
    logarithms = np.log10([1.0, 0.3, 0.02, 0.015, 0.015, 0.015])
    below = np.linspace(logarithms[0], logarithms[-1], 6) - logarithms
    result = best(drawn(swept(ME=steep), floor(ME=[0.015]), mark="shared"))
    assert result["markers"].tolist() == [1 + np.argmax(below)] == [3]
    linear = {**steep, 1: 0.29, 2: 0.28}
    result = best(drawn(swept(ME=linear), floor(ME=[0.27]), mark="shared"))
    assert result["markers"].tolist() == [3]


def test_a_floor_without_labels_lies_under_all_curves() -> None:
    common = Across((), (({}, pd.DataFrame({"mse": [0.25]})),))
    frame = drawn(swept(ME=VALLEY, JZ=SLOPE), common).table
    assert (frame["floor"] == 0.25).all()


def test_a_label_without_a_floor_is_reported() -> None:
    with pytest.warns(UserWarning, match="without a noise floor: JZ"):
        frame = drawn(swept(ME=VALLEY, JZ=SLOPE), floor(ME=[0.1], MB=[0.2], JZ=[NAN])).table
    assert frame.loc[frame["actor"] == "JZ", "floor"].isna().all()
    assert not frame.loc[frame["actor"] == "JZ", "below floor"].any()


def test_what_has_no_number_is_left_out_and_counted() -> None:
    scores = swept(ME={**VALLEY, 25: NAN, 60: np.inf}, MB=dict.fromkeys(VALLEY, NAN))
    with pytest.warns(UserWarning, match="ME: 2 rows left out.*MB: 6 rows.*without a curve: MB"):
        result = drawn(scores, mark="shared")
    assert result.table.loc[result.table["mse"].isna(), "on curve"].tolist() == [False] * 8
    assert info_of(result.table).answer.lines[0].startswith("All 1 curves have a minimum")
    assert best(result)["actor"].tolist() == ["ME"]
    assert "MB (no value)" in [axis.get_title("left") for axis in result.figure.axes]


def test_rows_without_a_place_are_left_out_and_counted() -> None:
    frame = pd.DataFrame({"markers": [5.0, NAN, 9.5], "mse": [1.0, 2.0, 3.0]})
    with pytest.warns(
        UserWarning, match="ME: 1 rows left out, whose markers is not a finite number"
    ):
        result = drawn(Across.of({"ME": frame}, axis="actor")).table
    assert result["markers"].tolist() == [5.0, 9.5]


def test_a_block_that_lacks_a_number_is_left_out() -> None:
    frame = pd.DataFrame(
        {"trial": [0, 0, 1, 2, 3], "x": 1, "rmse": [1.0, NAN, 2.0, 3.0, 4.0], "who": "a"}
    )
    with pytest.warns(UserWarning, match="a: 1 blocks left out, whose rmse is not a finite number"):
        result = curve(Across((), (({}, frame),)), x="x", compare="who", blocks=("trial",)).table
    assert result[["rmse", "blocks"]].to_numpy().tolist() == [[3.0, 3.0]]


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_where_nothing_has_a_number_nothing_is_said() -> None:
    result = drawn(swept(ME=dict.fromkeys(VALLEY, NAN)), floor(ME=[NAN]), mark="shared")
    assert list(info_of(result.table).answer.lines) == ["No point has a number for mse."]
    assert not len(best(result))
    empty = drawn(Across.of({"ME": point(1, 1).iloc[:0]}, axis="actor"), mark="shared")
    assert not len(empty.table)
    assert list(empty.table.columns)[:3] == ["actor", "markers", "mse"]


def test_one_point_is_neither_minimum_nor_knee() -> None:
    result = drawn(swept(ME={9: 0.1}), mark="shared")
    assert not len(best(result))
    assert result.figure.get_suptitle() == "no minimum shared within 2 markers"


def test_absent_combinations_are_counted_and_keep_their_place() -> None:
    scores = swept(ME=VALLEY, JZ=SLOPE)
    absent = (
        Absent({"actor": "MB", "k": 5}, "refused", "needs frames"),
        Absent({"actor": "MB", "k": 10}, "refused", "needs frames"),
        Absent({"actor": "JZ", "k": 55}, "skipped", "skip"),
    )
    with pytest.warns(UserWarning, match="MB: 2 combinations refused") as caught:
        frame = drawn(Across(scores.axes, scores.entries, absent)).table
    assert "skipped" not in str(caught[0].message)
    assert "MB: 2 combinations refused (needs frames)" in info_of(frame).notes
    assert "JZ: 1 combination skipped (skip)" in info_of(frame).notes


def test_labels_with_markup_stay_as_they_are() -> None:
    names = {"$x^$": VALLEY, "<b>": SLOPE, "_hidden": SLOPE}
    result = drawn(swept(**names), floor(**{name: [0.2] for name in names}), mark="shared")
    result.figure.canvas.draw()
    texts = [axis.get_title("left") for axis in result.figure.axes]
    assert [text.strip("\u200b").replace(r"\$", "$") for text in texts[:3]] == list(names)
    assert result.table["actor"].unique().tolist() == list(names)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"x": "actor"}, "x 'actor' is not an axis of finite numbers: it has ME"),
        ({"x": "name"}, "x 'name' is not a column of numbers in the table of actor=ME, k=5; there"),
        (
            {"x": "size"},
            r"no axis or column 'size'.*axes and columns: actor, k, markers, mse, name",
        ),
        ({"metric": "mae"}, r"no metric 'mae' in the table of actor=ME, k=5;.* columns: markers"),
        ({"metric": "name"}, "metric 'name' is not a column of numbers"),
        ({"compare": "markers"}, "x, metric, compare and blocks share a name: markers"),
        ({"blocks": ("trial",)}, "no axis or column 'trial'"),
    ],
)
def test_names_that_do_not_fit_are_reported(settings: dict[str, object], message: str) -> None:
    entries: Any = (({"actor": "ME", "k": 5}, point(5, 0.1).assign(name="a")),)
    with pytest.raises(ValueError, match=message):
        drawn(Across(("actor", "k"), entries), **{"compare": "k", **settings})


def test_a_name_that_the_table_needs_is_refused() -> None:
    scores = Across.of({1: point(5, 0.1).assign(floor=1.0)}, axis="low")
    with pytest.raises(ValueError, match="has a column low of its own"):
        curve(scores, x="markers", metric="mse")


def test_there_must_be_a_table_and_the_floor_must_have_the_metric() -> None:
    with pytest.raises(ValueError, match="no table to draw a curve of"):
        drawn(Across(("actor",), ()))
    with pytest.raises(
        ValueError, match=r"no metric 'mse' in the table of actor=ME; .*columns: rmse"
    ):
        drawn(swept(ME=VALLEY), Across.of({"ME": pd.DataFrame({"rmse": [1.0]})}, axis="actor"))


def test_settings_have_their_defaults() -> None:
    node = node_of(curve)
    assert node is not None
    assert node.cite == ("satopaa2011finding",)
    assert {name: setting.default for name, setting in node.settings.items() if name != "x"} == {
        "metric": None, "compare": None, "blocks": (), "clusters": (), "lowest": None,
        "fallback": None, "mark": "none", "tolerance": 2.0,
    }  # fmt: skip


def test_the_fallback_stands_where_another_curve_has_no_number() -> None:
    def entry(fill: str, share: int, *errors: float) -> Any:
        frame = pd.DataFrame({"gap": range(len(errors)), "rmse": errors})
        return {"fill": fill, "share": share}, frame

    scores = Across(
        ("fill", "share"),
        (
            entry("linear", 1, 1.0, 2.0),
            entry("linear", 2, 5.0, 7.0),
            entry("picky", 1, 0.5, NAN),
            entry("never", 1, NAN, NAN),
        ),
    )
    settings: dict[str, Any] = {
        "x": "share",
        "metric": "rmse",
        "compare": "fill",
        "blocks": ("gap",),
    }
    with pytest.warns(UserWarning, match="without a curve: never"):
        frame = curve(scores, fallback="linear", **settings).table
    picky = frame[frame["fill"] == "picky"]
    # of gaps 0 and 1: its own and the fallback's; at share 2 it has no table
    assert dict(zip(picky["share"], picky["rmse"], strict=True)) == {1: 1.25, 2: 6.0}
    (note,) = [note for note in info_of(frame).notes if "fallback" in note]
    assert note.startswith("picky: 3 blocks")
    with pytest.raises(ValueError, match="blocks"):
        curve(scores, fallback="linear", **{**settings, "blocks": ()})


def test_what_has_no_label_has_a_curve_of_its_own() -> None:
    frame = pd.DataFrame({"x": [1, 1, 2, 2], "rmse": [1.0, 2.0, 3.0, 4.0], "who": ["a", None] * 2})
    result = curve(Across((), (({}, frame),)), x="x", compare="who").table
    assert result[["who", "x", "rmse"]].to_numpy().tolist() == [
        ["a", 1, 1.0], ["a", 2, 3.0], ["missing", 1, 2.0], ["missing", 2, 4.0],
    ]  # fmt: skip


def test_a_row_of_the_fallback_without_a_place_is_no_loss_of_others() -> None:
    frame = pd.DataFrame(
        {
            "x": [1.0, NAN, 1.0],
            "gap": [0, 1, 1],
            "rmse": [1.0, 2.0, 3.0],
            "who": ["a", "a", "b"],
        }
    )
    scores = Across((), (({}, frame),))
    with pytest.warns(UserWarning, match="^a: 1 rows left out, whose x is not a finite number$"):
        result = curve(scores, x="x", compare="who", blocks=("gap",), fallback="a").table
    assert result[["who", "rmse", "blocks"]].to_numpy().tolist() == [["a", 1.0, 1], ["b", 2.0, 2]]
