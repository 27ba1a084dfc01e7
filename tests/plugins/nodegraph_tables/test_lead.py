"""A table's answer at a glance: escaped, at most eight cards, stored with the table."""

from __future__ import annotations

import pandas as pd

from nodegraph_tables import Card, Lead, TableInfo, info_of, with_info
from nodegraph_tables.lead import lead_html, line_of
from nodegraph_tables.rendering import render_table
from nodegraph_tables.stored_table import put_together, take_apart

MARKUP = '<b onclick="x">&'
LEAD = Lead(
    ("Mean ", MARKUP, " is best."),
    (Card(MARKUP, MARKUP, MARKUP, MARKUP, facts=((MARKUP, MARKUP),), best=True),),
    MARKUP,
)


def test_what_users_write_is_escaped() -> None:
    shown = lead_html(LEAD)
    assert "<b " not in shown
    assert shown.count("&lt;b onclick=&#34;x&#34;&gt;&amp;") == 8
    assert "<strong>&lt;b" in shown


def test_more_cards_than_a_reader_sees_are_counted() -> None:
    shown = lead_html(Lead(("all",), tuple(Card(str(place), "x") for place in range(11))))
    assert shown.count("<article") == 8
    assert "3 more are in the table" in shown


def test_a_table_is_stored_and_shown_with_its_lead() -> None:
    table = with_info(pd.DataFrame({"step": ["a"], "rmse": [0.1]}), TableInfo(lead=LEAD))
    again = put_together(take_apart(table))
    assert info_of(again).lead == LEAD
    shown = render_table(again, "t")
    assert shown.lead == lead_html(LEAD)
    assert ".lead-card" in shown.styles[0]
    plain = render_table(pd.DataFrame({"a": [1]}), "t")
    assert (plain.lead, plain.styles) == ("", ())


def test_a_line_holds_all_numbers() -> None:
    wide, narrow = line_of([0.1, float("nan"), 10.0]), line_of([0.0, 1.0])
    assert wide.at(1.0) == (wide.at(0.1) + wide.at(10.0)) / 2
    assert narrow.at(0.5) == (narrow.at(0.0) + narrow.at(1.0)) / 2
    assert 0 < line_of([2.0, 2.0]).at(2.0) < 240
