"""A table's answer: escaped, at most eight cards, in words, stored with the table."""

from __future__ import annotations

import pandas as pd

from nodegraph_tables import Answer, Card, TableInfo, Word, info_of, with_info
from nodegraph_tables.answer import HERE, answer_html, html_of, line_of, plain, say
from nodegraph_tables.rendering import render_table
from nodegraph_tables.stored_table import put_together, take_apart

MARKUP = '<b onclick="x">&'
TEXT = say(f"Mean {HERE} is best.", Word(MARKUP))
ANSWER = Answer(
    TEXT,
    (MARKUP,),
    (Card(MARKUP, (MARKUP,), (MARKUP,), (MARKUP,), facts=((MARKUP, (MARKUP,)),), best=True),),
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
    cards = tuple(Card(str(place), ("x",)) for place in range(11))
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
