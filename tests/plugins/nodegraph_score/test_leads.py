"""The answers of the scores of steps and of alignments at a glance."""

from __future__ import annotations

import numpy as np
from pandas import DataFrame

from nodegraph import Across
from nodegraph_mocap import Trajectories
from nodegraph_score.alignment_answer import answer_of
from nodegraph_score.steps import steps
from nodegraph_tables import Answer, info_of
from nodegraph_tables.lead import answer_html
from nodegraph_tables.text import plain
from tests.plugins.recordings import quietly


def recording(error: float, missing: int = 0) -> Trajectories:
    positions = np.zeros((10, 2, 3))
    positions[:, 1, 0] = 50.0
    positions[:5, 0, 1] = error
    positions[5 : 5 + missing, 0] = np.nan
    return Trajectories(positions=positions, markers=("a", "b"), rate=60.0)


def of_steps(**errors: float) -> Answer:
    stages = {name: recording(error, name == "captured") for name, error in errors.items()}
    answer = info_of(quietly(steps, Across.of(stages, axis="stage"), recording(0.0))).answer
    assert answer_html(answer)
    return answer


def test_a_step_has_a_card_with_before_and_after() -> None:
    answer = of_steps(captured=4.0, fill=4.0, despike=1.0, smooth=0.5)
    assert [title for card in answer.cards for title in card.title] == [
        "captured",
        "fill",
        "despike",
        "smooth",
    ]
    assert [card.kind for card in answer.cards] == ["rest", "rest", "best", "best"]
    despike = answer.cards[2]
    assert dict(despike.facts)["Step"] == ("changes 5 samples; 100 % come nearer",)
    assert "before 4.00\N{NO-BREAK SPACE}mm" in despike.picture
    assert "after 1.00\N{NO-BREAK SPACE}mm" in despike.picture
    assert "adds 1 at" in plain(dict(answer.cards[1].facts)["Step"])
    assert plain(answer.sentence) == (
        "despike does most: 4.00 to 1.00\N{NO-BREAK SPACE}mm over the 5 samples that it changes. "
        "No step makes it worse."
    )


def test_a_step_that_makes_it_worse_is_named() -> None:
    answer = of_steps(captured=4.0, smooth=5.0)
    assert "smooth makes it worse" in plain(answer.sentence)
    assert "No step brings" in plain(answer.sentence)
    assert 'class="worse"' in answer.cards[1].picture


def part(name: str, head: float, in_all: float) -> DataFrame:
    return DataFrame(
        {
            "align": name, "component": [1, 2], "share": [0.7, 0.3], "head motion": [head, 0.0],
            "finds": ["head motion" if head > 0.5 else "face", "face"], "in all": in_all,
        }
    )  # fmt: skip


def test_head_motion_is_reported_of_the_recording_with_most_of_it() -> None:
    answer = answer_of([part("stable", 0.0, 0.004), part("captured", 0.8, 0.56)], ("align",))
    assert plain(answer.sentence) == (
        "The first principal component is 80 % head motion in captured, as is 56 % of all "
        "variance; in the other at most 0 %, and 0 %."
    )
    assert [plain(card.headline) for card in answer.cards] == ["0 %", "80 %"]
    assert plain(answer.cards[1].aside) == "head motion; 56 % of all variance"
    assert answer_html(answer).count("<rect") == 8
    alone = answer_of([part("", 0.1, 0.2)], ())
    assert plain(alone.sentence) == (
        "The first principal component is 10 % head motion, as is 20 % of all variance."
    )


def test_the_largest_bar_is_as_tall_as_all_whatever_its_share() -> None:
    for share in np.random.default_rng(0).uniform(0.5, 1.0, 50):
        shares = part("a", 1.0, 0.9).assign(share=[share, 1.0 - share])
        (card,) = answer_of([shares], ("align",)).cards
        assert card.picture.count('y="0.0"') == 2
