"""A table's answer: escaped, at most eight cards, in words, stored with the table."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pandas as pd
import pytest

from nodegraph import NodegraphError, Placeholder
from nodegraph.graphfile import read_graph_text
from nodegraph_tables import Answer, Card, Finding, TableInfo, Word, info_of, with_info
from nodegraph_tables.answer import Row, Rows
from nodegraph_tables.authors_answer import in_authors_words
from nodegraph_tables.lead import answer_html, cards_html
from nodegraph_tables.line import Line, line_of
from nodegraph_tables.numbers import difference_text
from nodegraph_tables.rendering import render_table
from nodegraph_tables.stored_table import put_together, take_apart
from nodegraph_tables.text import HERE, html_of, plain, say

MARKUP = '<b onclick="x">&'
TEXT = say(f"Mean {HERE} is best.", Word(MARKUP))
ANSWER = Answer(
    TEXT,
    (MARKUP,),
    (Card((MARKUP,), (MARKUP,), (MARKUP,), (MARKUP,), facts=((MARKUP, (MARKUP,)),), kind="best"),),
)


def test_what_users_write_is_escaped() -> None:
    shown = answer_html(ANSWER)
    assert "<b " not in shown
    assert shown.count("&lt;b onclick=&#34;x&#34;&gt;&amp;") == 8
    assert "<strong>&lt;b" in shown
    assert html_of((Word("m", "method", MARKUP),)).count("&lt;b onclick") == 1


def test_a_text_has_its_parts_where_they_belong() -> None:
    text = say(f"{HERE} of {HERE}.", "a {} b", say(f"c {HERE}", Word("5", "number")))
    assert plain(text) == "a {} b of c 5."
    assert plain(say("nothing")) == "nothing"


def test_more_cards_than_a_reader_sees_are_counted() -> None:
    cards = tuple(Card((str(place),), ("x",)) for place in range(11))
    shown = answer_html(Answer(("all",), cards=cards))
    assert shown.count("<article") == 8
    assert "3 more are in the table" in shown


def test_an_answer_in_words_has_all_that_its_cards_say() -> None:
    assert ANSWER.lines == ANSWER.in_words.lines
    assert not ANSWER.in_words.cards
    assert ANSWER.lines[0] == f"Mean {MARKUP} is best."
    assert ANSWER.lines[-1].count(MARKUP) == 6


def test_a_table_is_stored_and_shown_with_its_answer() -> None:
    table = with_info(pd.DataFrame({"step": ["a"], "rmse": [0.1]}), TableInfo(answer=ANSWER))
    again = put_together(take_apart(table))
    assert info_of(again).answer == ANSWER
    shown = render_table(again, "t")
    assert shown.lead == answer_html(ANSWER)
    assert shown.answer == ANSWER.lines
    assert ".lead-card" in shown.styles[0]
    plain_table = render_table(pd.DataFrame({"a": [1]}), "t")
    assert (plain_table.lead, plain_table.styles) == ("", ())


def test_a_line_holds_all_numbers() -> None:
    wide, narrow = line_of([0.1, float("nan"), 10.0]), line_of([0.0, 1.0])
    assert wide.at(1.0) == (wide.at(0.1) + wide.at(10.0)) / 2
    assert narrow.at(0.5) == (narrow.at(0.0) + narrow.at(1.0)) / 2
    assert 0 < line_of([2.0, 2.0]).at(2.0) < 240
    from_0 = line_of([0.0, 0.02, 2.0, 20.0])
    places = [from_0.at(value) for value in (0.0, 0.02, 2.0, 20.0)]
    assert min(after - before for before, after in pairwise(places)) > 15
    assert from_0.ticks() == [0.0, 0.1, 1.0, 10.0]


def test_a_line_makes_nothing_look_far_apart() -> None:
    near = line_of([0.638, 0.663], [0.6, 0.7])
    assert (near.low, near.high) == pytest.approx((0.0, 0.7))
    assert near.share(0.663) - near.share(0.638) < 0.05
    assert line_of([-3.0, -1.0]).high == 0.0
    many = line_of([0.0, 1.0, 100.0], [-5.0, 0.2, 120.0])  # ends of intervals set no scale
    assert (many.least, many.share(-5.0), many.high) == (1.0, 0.0, 200.0)
    wide = line_of([1.0, 100.0], [-5.0, 0.5])
    assert (wide.low, wide.log, wide.share(-5.0)) == (0.5, True, 0.0)


@pytest.mark.parametrize(
    ("means", "unit", "by"),
    [
        ((0.333, 0.3114), "mm", "0.022 mm"),
        ((0.1004, 0.0996), "mm", "under 0.001 mm"),
        ((0.1006, 0.1001), "mm", "0.001 mm"),
        ((12.34, 9.876), "", "2.5"),
        ((0.99, 1.16), "", "\N{MINUS SIGN}0.17"),
        ((213, 30), "", "183"),
        ((0.612, 0.56), "share", "5 %"),
        ((2e-4, 1e-4), "", "1.0e\N{MINUS SIGN}4"),
    ],
)
def test_a_difference_has_the_digits_of_the_means_that_are_shown(
    means: tuple[float, float], unit: str, by: str
) -> None:
    assert difference_text([means], unit).replace("\N{NO-BREAK SPACE}", " ") == by


@pytest.mark.parametrize(
    ("values", "ends"),
    [
        ([-0.07, 0.76], (-0.1, 0.8)),
        ([0.013, 7.0], (0.01, 10.0)),
        ([3.0, 41.0], (2.0, 50.0)),
        ([2.0, 200.0], (2.0, 200.0)),
    ],
)
def test_a_line_ends_with_round_numbers_around_all_values(
    values: list[float], ends: tuple[float, float]
) -> None:
    line = line_of(values)
    assert (line.low, line.high) == pytest.approx(ends)


def test_of_many_rows_those_that_matter_have_a_name() -> None:
    rows = [Row(f"method {at}", float(at)) for at in range(30)]
    rows[0] = replace(rows[0], kind="best", note=("by far",))
    rows[20] = replace(rows[20], for_all=True)
    rows[25] = replace(rows[25], kind="before")
    few = Rows.of(rows, Line(0.0, 30.0))
    assert [row.name for row in few.rows] == [f"method {at}" for at in (*range(6), 20, 25)]
    assert len(few.others) == 22
    card = Card(("fills",), ("method 0",), rows=few, status=("better",), kind="best")
    assert card.line == "fills: method 0; better; method 0 0, by far."
    html = cards_html([card])
    assert html.count("<circle") == 30
    assert html.count("<tr") == 8 + 1 + 1 + 1  # with a note, the others and the axis
    assert len(re.findall(r'<tr data-method="method 20" class="for-all">', html)) == 1
    assert "22 others" in html


def found(length: int, best: tuple[str, ...], behind: tuple[str, ...]) -> Finding:
    """Return the finding of a group; none without a best method."""
    means = {name: 0.1 * length + at for at, name in enumerate((*best, *behind))}
    first = best or behind[:1]
    return Finding(
        {"length": length}, f"length {length}", bool(best), best, (), behind if best else (),
        first=first, mean=means, unit="mm",
    )  # fmt: skip


SAME = (found(5, ("ridge",), ("linear", "pca")), found(15, ("ridge",), ("linear", "pca")))
OTHER = (SAME[0], found(15, ("pca",), ("linear", "ridge")))
NEAR = (replace(SAME[0], mean={"ridge": 0.5, "pca": 0.5004}),)
NONE = (SAME[0], found(15, (), ("linear", "ridge", "pca")))
TO_BASELINE = (
    replace(NONE[0], better=("pca",), worse=("linear",)),
    replace(NONE[1], better=("pca",)),
)
BESIDE = tuple(
    replace(each, beside={"missed": {"ridge": 0.0, "linear": share}}, units={"missed": "share"})
    for each, share in zip(SAME, (0.02, 0.2), strict=True)
)
INTERVALS = tuple(
    replace(
        each, low={"ridge": 0.4}, high={"ridge": 0.6}, reference="ridge", apart={"pca": (0.8, 1.3)}
    )
    for each in SAME
)
OVERALL = replace(found(5, ("pca",), ("ridge", "linear")), title="all groups together")


def holes(text: str) -> tuple[str | Placeholder, ...]:
    """Return the parts of an author's answer."""
    graph = f"nodegraph: 1\nnodes: {{a: {{use: x.a}}}}\nreport: [{{show: a, answer: '{text}'}}]"
    return read_graph_text(graph, "t.yaml", Path()).report[0].answer


@pytest.mark.parametrize(
    ("findings", "text", "said"),
    [
        (SAME, "{best}: {number}, not {behind linear}.",
         "ridge: 0.500 to 1.50 mm by length, not linear."),
        (SAME, "{tied} and {behind}: {scope}", "none and linear and pca: 8 faces: all"),
        (OTHER, "{best at length=5}, {best at length=15}, ridge", "ridge, pca, ridge"),
        (NONE, "{number linear at length=15}", "1.50 mm"),
        (TO_BASELINE, "{better pca}; {worse at length=5}", "pca; linear"),
        (BESIDE, "{number missed of linear}, {number missed}", "2 to 20 % by length, 0 %"),
        (INTERVALS, "{interval at length=5}; {interval ridge to pca at length=5}",
         "95 %: 0.400 to 0.600; 95 %: \u22121.30 to \u22120.800"),
        (SAME, "{difference linear to ridge at length=5}", "1.00 mm"),
        (NEAR, "{difference pca to ridge}", "under 0.001 mm"),
        (OTHER, "{count best ridge}, {count behind linear}, {count tied pca}",
         "1 of 2, all 2, none of 2"),
        (SAME, "{best at all}, pca: {number at all}; {behind linear at all}",
         "pca, pca: 0.500 mm; linear"),
        ((), "Our words.", "Our words."),
    ],
)  # fmt: skip
def test_an_answer_in_the_authors_words(
    findings: tuple[Finding, ...], text: str, said: str
) -> None:
    answer = Answer(("computed",), (Word("8 faces: all."),), findings=findings, overall=OVERALL)
    told = in_authors_words(answer, holes(text))
    assert plain(told.sentence).replace("\N{NO-BREAK SPACE}", " ") == said
    assert (told.scope, told.findings) == (answer.scope, answer.findings)


def test_an_answer_that_recommends_another_method_than_its_cards_is_refused() -> None:
    answer = Answer(("computed",), findings=OTHER, take="ridge")
    with pytest.raises(NodegraphError, match="first that it calls best is pca, and ridge is the"):
        in_authors_words(answer, holes("Take {best pca at length=15}, not {best at length=5}."))
    told = in_authors_words(answer, holes("{best at length=5}, for long gaps {best at length=15}."))
    assert plain(told.sentence) == "ridge, for long gaps pca."


@pytest.mark.parametrize(
    ("findings", "text", "why"),
    [
        (SAME, "{best linear}", "{best linear} for length 5: best is ridge"),
        (SAME, "{behind ridge}", "behind are linear, pca"),
        (SAME, "Take linear.", "it names linear, which is best nowhere; say what it is: {beh"),
        (SAME, "{best at length=45}", "is about no group; there are: length 5, length 15"),
        (OTHER, "{best}", "differs: ridge for length 5; pca for length 15; write {best at"),
        (NONE, "{best}", "says what there is no verdict on for length 15"),
        (NONE, "{number cubic}", "cubic has no number there"),
        (BESIDE, "{number missed of pca}", "pca has no number there"),
        (SAME, "{number missed of ridge}", "missed of ridge has no number there"),
        (TO_BASELINE, "{worse linear}", "{worse linear} for length 15: worse is none"),
        ((), "{best}", "is about no group; there are: none"),
        (INTERVALS, "{interval}", "{interval} is about one group, and there are: length 5, length"),
        (INTERVALS, "{interval linear at length=5}", "linear has no interval there"),
        (INTERVALS, "{interval pca to linear at length=5}", "differences have intervals to ridge"),
        (SAME, "{difference ridge}", "write {difference METHOD to METHOD}, of: linear, pca, ridge"),
        (OTHER, "{difference pca to ridge}", "is below 0; write {difference ridge to pca}"),
        (SAME, "{count ridge}", "counts no claim; write {count CLAIM METHOD}"),
        (SAME, "{count best cubic}", "cubic has no count there"),
        ((NONE[1],), "{count best pca}", "counts what there is no verdict on"),
        (SAME, "{best at all}", "{best at all}: the groups cannot be taken together"),
    ],
)  # fmt: skip
def test_what_contradicts_the_verdict_is_refused(
    findings: tuple[Finding, ...], text: str, why: str
) -> None:
    with pytest.raises(NodegraphError, match=re.escape(why)):
        in_authors_words(Answer(("computed",), findings=findings), holes(text))
