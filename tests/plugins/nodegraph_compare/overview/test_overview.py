from __future__ import annotations

import base64
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.stats import gmean

from nodegraph import Across, Detail, Kind, Label
from nodegraph_compare import nodegraph_kinds
from nodegraph_compare.answer import answer_of
from nodegraph_compare.overview.value import Overview
from nodegraph_compare.table.node import Compared
from nodegraph_compare.table.node import table as table_of
from nodegraph_mocap import Table
from nodegraph_tables import BetterEnd, TableInfo, info_of, with_info
from nodegraph_tables.text import html_of

pytestmark = pytest.mark.usefixtures("without_pictures")

NAN = np.nan


def cakes(
    values: object, *, better: BetterEnd = "lower", unit: str = "g", **columns: object
) -> Table:
    """Tables of a study of baking: how much sugar a recipe wastes, by cake."""
    waste = np.asarray(values, dtype=float)
    frame = pd.DataFrame({"cake": np.arange(len(waste)), "waste": waste, **columns})
    return with_info(frame, TableInfo(units={"waste": unit}, better={"waste": better}))


def kitchens(
    recipes: Mapping[str, float], count: int = 8, heats: tuple[int, ...] = (180, 220)
) -> Across[Table]:
    """Recipes with their factors of waste; the first is the best in the cool oven alone."""
    random = np.random.default_rng(0)
    entries: list[tuple[dict[str, Label], Table]] = []
    for kitchen in range(count):
        for heat in heats:
            base = random.lognormal(size=6)
            for at, (recipe, factor) in enumerate(recipes.items()):
                hotter = 1.0 if heat == heats[0] else 1.0 + 2.0 * (at == 0)
                waste = base * factor * hotter * random.uniform(0.97, 1.03, 6)
                labels: dict[str, Label] = {"kitchen": kitchen, "heat": heat, "recipe": recipe}
                entries.append((labels, cakes(waste, mess=waste / 2, cleaned=np.ones(6))))
    return gathered(("kitchen", "heat", "recipe"), entries)


def gathered(
    axes: tuple[str, ...], entries: Sequence[tuple[dict[str, Label], Table]]
) -> Across[Table]:
    """Gather tables whose axis `heat` is in kelvin."""
    return Across(axes, tuple(entries), sources=("kitchen",), units={"heat": "K"})


def compared(scores: Across[Table], **settings: Any) -> Compared:
    return table_of(scores, metric="waste", compare="recipe", **settings)


@dataclass(frozen=True)
class Bakery:
    """The origin of an overview in a run of someone else's study."""

    node: str = "recipes"
    labels: Mapping[str, object] = field(default_factory=dict)
    caption: str = ""
    answer: tuple[str, ...] = ()
    view: Detail | None = None

    def seconds(self, axis: str) -> Mapping[Label, Sequence[float]]:
        return {"plain": [3.0, 0.002, 0.002, 0.002, 0.002], "rich": [0.2] * 5, "vegan": [0.1] * 3}

    def summaries(self, axis: str) -> Mapping[Label, str]:
        return {"plain": "Bake with <flour> alone (Child, 1961).", "burnt": "Bake for long."}

    def open_axes(self, labels: Mapping[str, object]) -> Mapping[str, tuple[object, ...]]:
        return {}

    def inputs(self, labels: Mapping[str, object]) -> Mapping[str, object] | None:
        return {"cake": 3.5}

    def detail(self, value: object) -> Detail | None:
        return self.view if isinstance(value, float) else None

    def command(self, labels: Mapping[str, object]) -> str:
        return " ".join(f"--only {name}={label}" for name, label in labels.items())


def rendered(overview: Overview, origin: Any = None) -> Any:
    (renderer,) = nodegraph_kinds()
    assert isinstance(renderer, Kind)
    assert renderer.render_in_run is not None
    return renderer.render_in_run(overview, "recipes", origin or Bakery())


def data_of(html: str, name: str = "overview-recipes") -> Any:
    match = re.search(rf'<script type="application/json" id="{name}">(.*?)</script>', html, re.S)
    assert match is not None
    return json.loads(match[1])


def text_of(html: str) -> str:
    numbers = re.sub(r'<span class="lead-number">([^<]*)</span>', r"\1", html)
    return re.sub(r"\s+", " ", re.sub(r"<(?!/?(?:script|style))[^>]*>", " ", numbers)).strip()


def codes(text: str) -> Any:
    return np.frombuffer(base64.b64decode(text), dtype="<u2")


RECIPES = {"plain": 1.0, "rich": 1.4, "airy": 1.41, "burnt": 9.0}


@pytest.fixture(scope="module")
def study() -> Compared:
    return compared(kitchens(RECIPES), within=("heat",))


def test_verdicts_are_those_of_the_table_and_its_answer(study: Compared) -> None:
    verdicts, frame = study.overview.verdicts, study.table
    assert verdicts.methods == tuple(RECIPES)
    cool, hot = verdicts.groups
    assert [verdicts.methods[at] for at in cool.best] == ["plain"]
    assert [verdicts.methods[at] for at in (*hot.best, *hot.tied)] == ["rich", "airy"]
    assert {verdicts.methods[at] for at in hot.behind} == {"plain", "burnt"}
    for group, heat in zip(verdicts.groups, (180, 220), strict=True):
        rows = frame[frame["heat"] == heat].set_index("recipe").loc[list(RECIPES)]
        for name in ("mean", "low", "high", "median"):
            np.testing.assert_array_equal(getattr(group, name), rows[name])
        assert group.to_best is not None
        for name, column in (("value", "ratio"), ("low", "ratio low"), ("p", "p")):
            np.testing.assert_array_equal(getattr(group.to_best, name), rows[column])
        best = str(verdicts.methods[group.best[0]])
        assert best in info_of(frame).answer.lines[3 + verdicts.groups.index(group)]
        assert (group.scope.kind, group.scope.count) == ("clusters", 8)


def test_every_block_of_every_method_is_there(study: Compared) -> None:
    overview = study.overview
    assert [metric.name for metric in overview.metrics] == ["waste", "mess", "cleaned"]
    for at, (group, behind) in enumerate(
        zip(overview.verdicts.groups, overview.blocks, strict=True)
    ):
        assert behind.errors["waste"].shape == (48, 4)
        np.testing.assert_allclose(behind.errors["mess"], behind.errors["waste"] / 2, rtol=1e-6)
        means = [behind.errors["waste"][behind.cluster == unit].mean(axis=0) for unit in range(8)]
        np.testing.assert_allclose(gmean(means), group.mean, rtol=1e-6)
        where = {name: overview.columns[name][codes[7]] for name, codes in behind.rows.items()}
        assert where == {"kitchen": 1, "cake": 1}
        assert group.labels == ((180, 220)[at],)


def test_the_lead_answers_without_script(study: Compared) -> None:
    lead = rendered(study.overview).lead
    text = text_of(lead)
    assert "<script" not in lead
    assert text.startswith(
        "It depends on heat. One method for all: rich . Lowest: plain for 180 K ("
    )
    assert "rich is lowest over all 2 groups together, at most 40 % behind in any; next " in text
    assert "Clearly: p ≤ 0.05, paired tests over 8 kitchens, adjusted for 4 methods." in text
    assert "plain : Bake with &lt;flour&gt; alone." in text
    assert "Bake for long" not in text
    # on every name, to hover
    assert lead.count('data-method="plain" title="Bake with &lt;flour&gt; alone."') > 3
    assert lead.count('data-method="burnt" title="Bake for long."') == 2
    assert lead.count("<article") == 2
    # on the cards, and in the key above them
    assert lead.count('<circle class="best"') == 1 + 1
    assert lead.count('<circle class="tied"') == 2 + 1
    assert "8 kitchens: holds for further kitchens." in text
    assert " clearly best may be the best clearly behind line: 95 % interval " in text
    assert lead.index("lead-key") < lead.index("<article")


def test_charts_begin_with_the_first_of_names_and_the_last_of_numbers() -> None:
    entries = tuple(
        ({**labels, "oven": oven}, frame)
        for oven in ("gas", "coal")
        for labels, frame in kitchens({"plain": 1.0, "rich": 1.4}, 5)
    )
    for axes, group in ((("heat",), {"heat": 220}), (("oven",), {"oven": "gas"})):
        scores = gathered(("kitchen", "oven", "heat", "recipe"), entries)
        data = data_of(rendered(compared(scores, within=axes).overview).html)
        assert data["groups"][data["shown_group"]]["labels"] == [*group.values()]


def test_the_best_of_most_conditions_stands_after_the_exceptions() -> None:
    entries = tuple(
        ({**labels, "oven": oven}, frame)
        for oven, factor in (("gas", 1.0), ("coal", 9.0))
        for labels, frame in kitchens({"plain": factor, "rich": 1.4})
    )
    scores = gathered(("kitchen", "oven", "heat", "recipe"), entries)
    text = text_of(rendered(compared(scores, within=("oven", "heat")).overview).lead)
    assert text.startswith("It depends on oven and heat. One method for all: rich .")
    assert " Lowest: plain for oven gas, heat 180 K (" in text
    assert "; rich otherwise (" in text


def test_every_method_is_compared_to_a_baseline_over_all_groups() -> None:
    """As in "does it beat chance?", for each number of markers and each performer."""
    entries = tuple(
        ({**labels, "oven": oven}, frame)
        for oven, plain in (("gas", 1.0), ("coal", 9.0))
        for labels, frame in kitchens({**RECIPES, "plain": plain})
    )
    scores = gathered(("kitchen", "oven", "heat", "recipe"), entries)
    settings: Any = {"within": ("oven", "heat"), "baseline": "rich"}
    text = text_of(rendered(compared(scores, **settings).overview).lead).replace("\u00a0", " ")
    rest = "airy is not clearly different throughout; burnt is worse throughout."
    gas = f"oven gas: plain is better at heat 180 K, worse at heat 220 K; {rest}"
    coal = (
        "oven coal: plain and burnt are worse throughout; airy is not clearly different throughout."
    )
    for sentence in (gas, coal):
        assert f"Against rich , {sentence}" in re.sub(r" ([;:.])", r"\1", text), text
    assert "Against" not in text_of(rendered(compared(scores, within=("oven",)).overview).lead)
    few = [entry for entry in entries if entry[0]["kitchen"] in range(4)]
    described = compared(Across(scores.axes, tuple(few), sources=("kitchen",)), **settings)
    assert "Against" not in text_of(rendered(described.overview).lead)


@pytest.mark.parametrize("better", ["lower", "higher"])
def test_the_compromise_is_by_the_ratio_that_judges_the_best(better: BetterEnd) -> None:
    """One kitchen with large values decides the plain means, not the mean ratio."""
    factors = {"cool": (1.0, 3.0), "hot": (3.0, 1.0), "mild": (1.2, 1.2), "slow": (1.6, 1.6)}
    random = np.random.default_rng(0)
    entries: list[tuple[dict[str, Label], Table]] = []
    for kitchen in range(8):
        large = kitchen == 0
        for at, heat in enumerate((180, 220)):
            base = 1000.0**large * random.uniform(0.99, 1.01, 6)
            for recipe, both in factors.items():
                times = 4.0 if large and recipe == "mild" else both[at]
                waste = base * (times if better == "lower" else 1 / times)
                labels: dict[str, Label] = {"kitchen": kitchen, "heat": heat, "recipe": recipe}
                entries.append((labels, cakes(waste, better=better)))
    scores = Across(("kitchen", "heat", "recipe"), tuple(entries), sources=("kitchen",))
    text = text_of(rendered(compared(scores, within=("heat",)).overview).lead)
    ratio = (4.0 * 1.2**7) ** (1 / 8)  # 1.395; of the plain means, 3.94 or 1.74
    behind = abs((ratio if better == "lower" else 1 / ratio) - 1)
    shown = re.search(r", at most (\d+) % behind in any; next ", text)
    assert shown is not None
    assert int(shown[1]) == pytest.approx(100 * behind, abs=1)  # of means in three digits


def test_several_axes_have_a_card_for_each_combination_of_their_labels() -> None:
    entries = tuple(
        ({**labels, "oven": oven}, frame)
        for oven in ("gas", "coal", "wood")
        for labels, frame in kitchens({"plain": 1.0, "rich": 1.4}, 5)
    )
    scores = gathered(("kitchen", "oven", "heat", "recipe"), entries)
    section = rendered(compared(scores, within=("oven", "heat")).overview)
    sentence, scope, certainty, *cards = section.answer
    assert sentence.startswith("It depends on heat. One method for all: rich. ")
    assert certainty.startswith(
        "rich is lowest over all 6 groups together, at most 39\N{NO-BREAK SPACE}% behind in any; "
        "next over all is plain, clearly 24\N{NO-BREAK SPACE}% behind. Clearly: p "
    )
    assert " Lowest: plain for 180" in sentence
    assert scope.startswith("5 kitchens: holds for further kitchens.")
    assert [card.partition(":")[0] for card in cards[:2]] == [
        "oven gas, heat 180\N{NO-BREAK SPACE}K", "oven gas, heat 220\N{NO-BREAK SPACE}K",
    ]  # fmt: skip
    assert section.lead.count("It depends on heat. ") == 1
    assert text_of(section.lead).count("Provisional, as of 5 kitchens.") == 1
    assert section.lead.count("<article") == 6
    # a card names the best, and how the method to take stands to it
    text = text_of(section.lead).replace("\u00a0", " ")
    heads = 'lead-winner (\\w+)"><span data-method="(\\w+)"'
    assert re.findall(heads, section.lead) == [("best", "plain"), ("best", "rich")] * 3
    assert text.count("clearly best; rich +0.55 (39 %)") == 3
    assert text.count("clearly best; next, plain +2.11 (2.1 times)") == 3
    assert "tinted : rich, the one to take" in text
    assert section.lead.count('<tr data-method="rich" class="for-all">') == 3
    assert section.lead.count('<tr data-method="rich" class="best for-all">') == 3


def test_a_field_of_an_axis_has_its_own_name_for_readers() -> None:
    entries: Any = tuple(
        ({("oven.heat" if axis == "heat" else axis): label for axis, label in at.items()}, frame)
        for at, frame in kitchens({"plain": 1.0, "rich": 1.4})
    )
    scores = Across(("kitchen", "oven.heat", "recipe"), entries, sources=("kitchen",))
    section = rendered(compared(scores, within=("oven.heat",)).overview)
    text = text_of(section.lead)
    assert "It depends on heat." in text
    assert "oven.heat" not in text
    (within,) = data_of(section.html)["within"]
    assert (within["axis"], within["name"]) == ("oven.heat", "heat")


FIRST = {"plain": 1.0, "rich": 1.004, "burnt": 3.0}
LAST = {"plain": 3.0, "rich": 1.004, "burnt": 1.0}


@pytest.mark.parametrize(
    ("wastes", "where"),
    [
        ((FIRST, LAST), "in none of 2 groups, at"),
        ((FIRST, LAST, FIRST | {"rich": 1.5}), "in 1 of 3 groups, no method in fewer, at"),
        ((FIRST | {"rich": 1.5}, LAST | {"rich": 1.5}), ""),
    ],
)
def test_the_one_to_take_is_clearly_behind_in_few_groups_and_marked_on_every_card(
    wastes: Sequence[Mapping[str, float]], where: str
) -> None:
    random = np.random.default_rng(1)
    entries: Any = tuple(
        (
            {"kitchen": kitchen, "oven": oven, "recipe": recipe},
            # without any waste in one kitchen there are no ratios, and no mean over ovens
            cakes(random.uniform(0.99, 1.01, 4) * (0.0 if mean == 1.0 and not kitchen else mean)),
        )
        for kitchen in range(8)
        for oven, of in zip(("gas", "coal", "wood"), wastes, strict=False)
        for recipe, mean in of.items()
    )
    scores = Across(("kitchen", "oven", "recipe"), entries, sources=("kitchen",))
    overview = compared(scores, within=("oven",)).overview
    methods = overview.verdicts.methods
    (rich,) = (at for at, name in enumerate(methods) if name == "rich")
    assert overview.verdicts.best_over_all is None
    assert overview.verdicts.for_all == (rich if where else None)
    lead = rendered(overview).lead
    marked = re.findall(r'<tr data-method="rich" class="(?:best )?for-all">', lead)
    assert len(marked) == len(wastes) * bool(where)
    assert (f"rich is clearly behind {where} most" in text_of(lead)) == bool(where)


def test_groups_of_other_sizes_have_lines_on_which_the_same_ratio_is_as_long() -> None:
    entries: Any = tuple(
        (
            {"kitchen": kitchen, "heat": heat, "recipe": recipe},
            cakes(np.full(4, size * factor * 1.1**kitchen)),
        )
        for kitchen in range(8)
        for heat, size in zip(range(5), (1.0, 7.0, 30.0, 200.0, 900.0), strict=True)
        for recipe, factor in {"plain": 1.0, "rich": 3.0, "dry": 9.0}.items()
    )
    scores = Across(("kitchen", "heat", "recipe"), entries, sources=("kitchen",))
    lead = rendered(compared(scores, within=("heat",)).overview).lead
    places = [float(each) for each in re.findall(r'<circle[^>]* cx="([\d.]+)%"', lead)]
    assert len(places) == 5 * 3
    for group in range(5):
        plain, rich, dry = places[3 * group : 3 * group + 3]
        assert plain == pytest.approx(places[0], abs=0.2)
        assert rich - plain == pytest.approx(places[1] - places[0], abs=0.2)
        assert rich - plain == pytest.approx(dry - rich, abs=0.2)
        assert dry - plain > 40  # of a hundred; on one line of all groups a third of them
    assert "axis: multiples of the lowest, logarithmic" in text_of(lead)
    ticks = re.findall(r'x="([\d.]+)%" y="15">1\N{MULTIPLICATION SIGN}<', lead)
    assert [float(tick) for tick in ticks] == pytest.approx([places[0]] * 5, abs=0.2)


def test_packed_errors_are_those_of_the_blocks(study: Compared) -> None:
    section = rendered(study.overview)
    data = data_of(section.html)
    assert [method["seconds"] for method in data["methods"]] == [0.002, 0.2, None, None]
    for group, packed in zip(study.overview.blocks, data["groups"], strict=True):
        scale = packed["scale"]["waste"]
        step = (scale["high"] - scale["low"]) / 65534
        values = np.exp(scale["low"] + step * codes(packed["errors"]["waste"]))
        np.testing.assert_allclose(values.reshape(-1, 4), group.errors["waste"], rtol=1e-3)
        labels = data["columns"]["kitchen"]["labels"]
        assert [labels[code] for code in codes(packed["rows"]["kitchen"])][6] == "1"
    assert data["command"]["axes"] == ["heat", "kitchen", "cake", "recipe"]
    assert data["command"]["text"].endswith("--only cake={cake} --only recipe={recipe}")
    assert "rich" in text_of(section.html)
    assert section.replaces == ("figure",)


def test_blocks_worth_a_look_are_packed_from_what_is_at_hand(study: Compared) -> None:
    views: list[Any] = []

    def pack(block: Mapping[str, object], inputs: Mapping[str, Mapping[str, object]]) -> Any:
        views.append((dict(block), dict(inputs)))
        return {"cake": block["cake"]}

    def layout(inputs: Mapping[str, object], column: str) -> Any:
        return {
            "title": "in the tin",
            "names": ["0"],
            "points": [[0, 0]],
            "edges": [],
            "regions": {},
        }

    detail = Detail(pack, layout, "bakery/cake")
    html = rendered(study.overview, Bakery(view=detail)).html
    data = data_of(html)
    assert data["detail"]["module"] == "bakery/cake"
    assert data["layout"] == {**layout({}, ""), "column": "kitchen"}
    assert {"heat", "kitchen", "cake"} == views[0][0].keys()
    assert views[0][1] == {recipe: {"cake": 3.5} for recipe in RECIPES}
    assert data["suggested"][0]["why"] == "worst for plain"
    for view, (block, _) in zip(data["detail"]["packed"].values(), views, strict=True):
        assert data_of(html, view) == {"cake": block["cake"]}


def test_few_units_have_no_method_for_all() -> None:
    text = text_of(rendered(compared(kitchens(RECIPES, 4), within=("heat",)).overview).lead)
    assert text.count("no verdict") == 2 + 1  # on the cards, and in the key
    assert "One method for all" not in text


def test_of_equal_methods_none_is_the_one_to_take() -> None:
    scores = kitchens({"plain": 1.0})
    twice = [
        ({**labels, "recipe": recipe}, table)
        for labels, table in scores.entries
        for recipe in ("plain", "same")
    ]
    axes = ("kitchen", "heat", "recipe")
    overview = compared(gathered(axes, twice), within=("heat",)).overview
    assert overview.verdicts.for_all is None
    assert "tinted" not in text_of(rendered(overview).lead)


def test_numbers_are_named_with_what_they_are_numbers_of() -> None:
    recipes: Any = {2: 1.0, 3: 9.0}
    scores = replace(kitchens(recipes, heats=(1, 5)), units={"heat": "minutes"})
    text = text_of(rendered(compared(scores, within=("heat",)).overview).lead)
    assert "recipe 2 is best throughout" in text
    assert "heat 1 minute " in text
    assert "heat 5 minutes " in text


def test_what_leads_some_groups_only_is_not_called_best_throughout() -> None:
    overview = compared(kitchens({"plain": 1.0, "rich": 9.0}), within=("heat",)).overview
    assert "plain is best throughout" in text_of(rendered(overview).lead)
    verdicts = overview.verdicts
    first, *rest = verdicts.groups
    few = replace(first, scope=replace(first.scope, count=0))
    some = replace(verdicts, groups=(few, *rest), overall=None)
    text = text_of(html_of(answer_of(some).sentence))
    assert f"plain is best in {len(rest)} of {len(rest) + 1} groups" in text
    assert "throughout" not in text


def test_markup_in_labels_is_text() -> None:
    evil = "<script>alert(1)</script>&"
    scores = kitchens({evil: 1.0, '"quoted"': 2.0, "c": 3.0})
    section = rendered(compared(scores, within=("heat",)).overview)
    for html in (section.lead, re.sub(r"<script type=.*?</script>", "", section.html, flags=re.S)):
        assert "<script" not in html
    assert "&lt;script&gt;" in section.lead
    assert data_of(section.html)["methods"][0]["label"] == evil


@pytest.mark.parametrize("better", ["none", "higher"])
def test_other_ends_of_a_metric(better: BetterEnd) -> None:
    values = {name: np.arange(8) / 10 + at for at, name in enumerate(("a", "b", "c"))}
    scores = {name: cakes(each, better=better, unit="share") for name, each in values.items()}
    overview = compared(Across.of(scores, axis="recipe"), clusters=("cake",)).overview
    text = text_of(rendered(overview).lead)
    if better == "none":
        assert overview.verdicts.groups[0].best == ()
        assert text == ""  # the table has a lead of its own
    else:
        assert text.startswith("c is best (235 %); every other is clearly behind, by ")
        assert "c 235 % 95 %: " in text


def test_methods_of_equal_numbers_leave_nobody_behind() -> None:
    scores = {name: cakes(np.arange(1.0, 9.0)) for name in ("plain", "rich")}
    overview = compared(Across.of(scores, axis="recipe"), clusters=("cake",)).overview
    text = text_of(rendered(overview).lead)
    assert text.startswith("plain and rich have the same mean waste (")
    assert "behind" not in text


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(
    "values",
    [[[NAN] * 8, [NAN] * 8], [[], []], [[np.inf, 1.0] * 4, [2.0, 1.0] * 4], [[0.0] * 8, [0.0] * 8]],
    ids=["missing", "empty", "infinite", "zero"],
)
def test_odd_numbers_end_in_a_page(values: list[list[float]]) -> None:
    scores = Across.of(
        {name: cakes(each) for name, each in zip("ab", values, strict=True)}, axis="recipe"
    )
    overview = compared(scores, clusters=("cake",) if values[0] else ()).overview
    lead = rendered(overview).lead
    assert "nan" not in text_of(lead)
    assert not overview.blocks or data_of(rendered(overview).html)["groups"]


def test_a_hundred_methods_and_many_groups_stay_readable() -> None:
    recipes = {f"recipe {number}": 1.0 + number / 50 for number in range(100)}
    lead = rendered(compared(kitchens(recipes, 5), within=("heat",)).overview).lead
    assert len(re.findall("<circle[^>]*><title>", lead)) == 200
    assert text_of(lead).count("92 others") == 2
    six = rendered(
        compared(kitchens(recipes, 1, heats=(1, 2, 3, 4, 5, 6)), within=("heat",)).overview
    )
    assert len(re.findall("<circle[^>]*><title>", six.lead)) == 600
    assert text_of(six.lead).count("97 others") == 6
    many = kitchens({"plain": 1.0, "rich": 2.0}, 5, heats=tuple(range(100, 112)))
    lead = rendered(compared(many, within=("heat",)).overview).lead
    assert "<article" not in lead
    assert lead.count("<tr>") == 13
    assert len(re.findall(r"clearly best plain [\d.]+ ", text_of(lead))) == 1
    assert len(re.findall(r"clearly best rich [\d.]+ ", text_of(lead))) == 11
    assert len(re.findall(r"clearly behind rich \+[\d.]+ \(\d+ %\)", text_of(lead))) == 1
    assert lead.count('<div class="for-all">') == 12
    assert lead.count('class="lead-strip" height="16"') == 12
    assert "tinted : rich, the one to take" in text_of(lead)
    # 84 of twelve groups are more than a thousand dots
    every = kitchens(dict([*recipes.items()][:84]), 2, heats=tuple(range(100, 112)))
    lead = rendered(compared(every, within=("heat",)).overview).lead
    assert 'class="lead-strip"' not in lead


def ovens(kitchens: int, spread: float) -> Across[pd.DataFrame]:
    """Return the waste of two recipes, of which one wastes a little more, in twelve groups."""
    random = np.random.default_rng(5)
    entries: Any = tuple(
        (
            {"kitchen": kitchen, "oven": oven, "heat": heat, "recipe": recipe},
            cakes(waste * np.exp(spread * random.standard_normal(4))),
        )
        for kitchen in range(kitchens)
        for oven in ("gas", "coal", "wood")
        for heat in (180, 200, 220, 240)
        for recipe, waste in {"plain": 1.0, "rich": 1.15}.items()
    )
    return Across(("kitchen", "oven", "heat", "recipe"), entries, sources=("kitchen",))


def test_a_grid_in_which_only_all_groups_together_tell_methods_apart() -> None:
    overview = compared(ovens(7, 0.4), within=("oven", "heat")).overview
    verdicts = overview.verdicts
    assert not any(group.behind for group in verdicts.groups)
    assert verdicts.overall is not None
    assert verdicts.overall.behind
    lead = rendered(overview).lead
    text = text_of(lead)
    assert "clearly best may be the best clearly behind no clear difference" not in text
    assert "clearly best clearly behind no clear difference" in text
    assert len(re.findall(r"no clear difference (?:plain|rich) [\d.]+ ", text)) == 12
    assert re.search(r"clearly best take plain [\d.]+ clearly behind rich \+[\d.]+ ", text)


def test_a_grid_without_verdicts_says_so_beside_the_means() -> None:
    lead = rendered(compared(ovens(3, 0.4), within=("oven", "heat")).overview).lead
    text = text_of(lead)
    assert len(re.findall(r"no verdict (?:plain|rich) [\d.]+; no verdict", text)) >= 12
    assert "no clear difference" not in text


def test_a_hundred_thousand_blocks_are_packed_within_the_budget() -> None:
    random = np.random.default_rng(0)
    kitchen = np.arange(100_000) // 12_500
    scores = {
        name: cakes(random.lognormal(size=100_000), kitchen=kitchen, mess=random.random(100_000))
        for name in ("a", "b", "c")
    }
    across = Across.of(scores, axis="recipe")
    overview = compared(across, blocks=("cake",), clusters=("kitchen",)).overview
    html = rendered(overview).html
    assert len(html) < 3_000_000
    (group,) = data_of(html)["groups"]
    assert group["all_blocks"] == 100_000
    assert len(codes(group["cluster"])) <= 20_000


def test_steps_that_follow_one_another_are_compared_to_the_one_before() -> None:
    random = np.random.default_rng(0)
    entries: Any = tuple(
        (
            {"kitchen": kitchen, "heat": heat},
            with_info(
                pd.DataFrame({"step": ["mix", "rest", "bake"], "waste": waste}),
                TableInfo(units={"waste": "g"}, sequences=("step",)),
            ),
        )
        for kitchen in range(8)
        for heat, rested in (("cool", 0.5), ("hot", 1.0))
        for waste in [np.array([1.0, rested, 1.5 * rested]) * random.uniform(0.99, 1.01, 3)]
    )
    scores = Across(("kitchen", "heat"), entries, sources=("kitchen",))
    overview = table_of(
        scores, metric="waste", compare="step", within=("heat",), blocks=("kitchen",)
    ).overview
    assert not any(
        group["best"] or group["tied"] for group in data_of(rendered(overview).html)["groups"]
    )
    text = text_of(rendered(overview).lead).replace(" ,", ",")
    assert text.startswith(
        "rest lowers waste by 50 % (cool), with no clear change (hot); bake raises it by 5"
    )
    assert "best" not in text.partition("kitchens")[0]
    assert "where it begins clearly better than before clearly worse hardly changed" in text
    assert re.search(r"Clearly: p ≤ 0\.05, paired tests over [^.]+, adjusted for 3 steps\.", text)
    assert "%: change to the one before" in text


def test_what_the_best_does_besides_stands_on_its_card() -> None:
    section = rendered(compared(kitchens(RECIPES), within=("heat",), beside=("mess",)).overview)
    assert "Of the best: mess " in section.answer[0]
    assert section.lead.count("<dt>mess</dt>") == 2
    with pytest.raises(ValueError, match="no metric 'dust'"):
        compared(kitchens(RECIPES), within=("heat",), beside=("dust",))
