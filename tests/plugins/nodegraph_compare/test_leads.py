"""The answers of curves, ranks, and of comparisons without a better end, at a glance."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
import pytest

from nodegraph import Across
from nodegraph_compare.curve.marks import Mark
from nodegraph_compare.curve.node import curve
from nodegraph_compare.ranks.node import ranks
from nodegraph_compare.table.node import table
from nodegraph_tables import Answer, info_of
from nodegraph_tables.lead import answer_html
from nodegraph_tables.text import plain

pytestmark = pytest.mark.usefixtures("without_pictures")

KNEE = {10: 1.0, 20: 0.1, 30: 0.08, 40: 0.06}
VALLEY = {10: 1.0, 20: 0.1, 30: 0.3, 40: 0.05}


def lead(result: Any) -> Answer:
    answer = info_of(result.table).answer
    assert answer_html(answer)
    return answer


def text(result: Answer) -> str:
    return plain(result.sentence)


def over_markers(
    floor: float | None = None, mark: Mark = "shared", **values: dict[int, float]
) -> Answer:
    scores = {
        actor: pd.DataFrame({"markers": [*points], "mse": [*points.values()]})
        for actor, points in values.items()
    }
    noise = None
    if floor is not None:
        noise = Across.of({actor: pd.DataFrame({"mse": [floor]}) for actor in values}, axis="actor")
    shown = curve(
        Across.of(scores, axis="actor"), noise, x="markers", metric="mse", compare="actor",
        mark=mark,
    )  # fmt: skip
    return lead(shown)


def test_a_curve_has_a_card_with_its_knee_and_what_noise_does() -> None:
    answer = over_markers(0.07, ME=KNEE, JZ=KNEE)
    assert [(*card.title, *card.headline, *card.value) for card in answer.cards] == [
        ("mse over markers", "20 markers", "knee"),
    ]  # fmt: skip
    assert answer.cards[0].facts == tuple(
        (actor, ("20 markers, mse 0.100 (noise 0.070, reached at 40)",))
        for actor in ("actor ME", "actor JZ")
    )
    assert "20 markers" in text(answer)
    assert text(answer).endswith(
        " mse there is 1.43 times that of measurement noise, which both curves reach at 40 markers."
    )
    assert "<rect" in answer.cards[0].picture


def test_a_curve_above_the_noise_says_so() -> None:
    answer = over_markers(0.001, ME=KNEE, JZ=KNEE)
    assert text(answer).endswith(" times that of measurement noise, which no curve reaches.")
    assert "not reached" in plain(answer.cards[0].facts[0][1])


def test_curves_have_their_names_at_their_ends_apart_from_each_other() -> None:
    values: Any = {f"actor {at}": {**KNEE, 40: 0.06 + at / 1000} for at in range(4)}
    picture = over_markers(**values).cards[0].picture
    names = re.findall(r'<text x="439" y="([\d.]+)">actor (\d)</text>', picture)
    places = [float(y) for y, _ in names]
    assert [int(actor) for _, actor in names] == list(range(3, -1, -1))
    assert min(below - above for above, below in pairwise(places)) >= 12
    assert max(places) <= 176
    assert ">ME</text>" not in over_markers(ME=KNEE).cards[0].picture
    many: Any = {f"actor {at}": KNEE for at in range(5)}
    crowded = over_markers(**many).cards[0].picture
    assert ">actor 4</text>" not in crowded
    assert "<title>actor 4</title>" in crowded


def test_a_shared_minimum_is_the_answer() -> None:
    answer = over_markers(ME=VALLEY, JZ=VALLEY)
    assert "All 2 curves" in text(answer)
    assert {card.value for card in answer.cards} == {("shared minimum",)}


def test_without_a_mark_the_lowest_point_stands_there() -> None:
    answer = over_markers(mark="none", ME=KNEE)
    assert (answer.cards[0].headline, answer.cards[0].kind) == (("40 markers",), "rest")
    with pytest.warns(UserWarning, match="left out"):
        nothing = over_markers(ME={10: float("nan")})
    assert not nothing.cards
    assert "No point has a number" in text(nothing)


def gathered(shift: float) -> Across[pd.DataFrame]:
    random = np.random.default_rng(0)
    tables = {
        name: pd.DataFrame({"take": range(8), "rmse": random.uniform(1, 2, 8) + shift * place})
        for place, name in enumerate(("ridge", "linear", "cubic"))
    }
    return Across.of(tables, axis="fill")


def test_ranks_name_the_first_and_those_that_are_not_apart() -> None:
    answer = lead(ranks(gathered(0.5), clusters=("take",)))
    (card,) = answer.cards
    assert (plain(card.headline), card.kind) == ("ridge", "best")
    assert card.rows is not None
    assert [(row.name, row.kind) for row in card.rows.rows] == [
        ("ridge", "best"), ("linear", "tied"), ("cubic", "rest"),
    ]  # fmt: skip
    assert "linear 2.00, may be as good" in card.line
    assert text(answer) == "ridge has the lowest mean rank."
    assert "8 takes" in plain(answer.scope)


def test_ranks_that_chance_explains_are_no_verdict() -> None:
    answer = lead(ranks(gathered(0.0), clusters=("take",)))
    assert answer.cards[0].headline == ("no verdict",)
    assert "do not tell the methods apart" in text(answer)


def test_means_of_steps_stand_in_a_row() -> None:
    steps = {"original": 213.0, "shifted": 30.0, "scaled": 12.0, "turned": 1e-31}
    tables = {name: pd.DataFrame({"sum of squares": [value]}) for name, value in steps.items()}
    answer = lead(table(Across.of(tables, axis="align"), metric="sum of squares", better="none"))
    ((rows,),) = ([card.rows] for card in answer.cards)
    assert rows is not None
    assert [(row.name, rows.number(row)) for row in rows.rows] == [
        ("original", "213"), ("shifted", "30"), ("scaled", "12"), ("turned", "0"),
    ]  # fmt: skip
    assert text(answer).startswith("Sum of squares falls")
    assert "falls from 213 (original) to 30 (shifted)" in text(answer)


def test_without_a_better_end_others_are_held_against_a_baseline() -> None:
    scores = gathered(0.5)
    answer = lead(table(scores, clusters=("take",), better="none", baseline="ridge"))
    ((rows,),) = ([card.rows] for card in answer.cards)
    assert rows is not None
    (finding,) = answer.findings
    assert finding.reference == "ridge"
    for row in rows.rows:
        low, high = finding.apart.get(row.name, (0.0, 0.0))
        ends = f"95 %: {low:.3f}".replace("-", "\N{MINUS SIGN}")
        note = plain(row.note)
        assert note.startswith("difference to ridge: +") == (row.name != "ridge")
        assert (ends in note) == (row.name != "ridge")
        assert low <= row.value - finding.mean["ridge"] <= high


def test_a_comparison_with_a_better_end_leaves_its_cards_to_its_overview() -> None:
    result = table(gathered(0.5), clusters=("take",))
    answer = info_of(result.table).answer
    assert not answer.cards
    assert answer.lines == result.overview.answer.lines
