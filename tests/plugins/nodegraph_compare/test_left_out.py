from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from nodegraph import Absent, Across
from nodegraph_compare.blocks import Group
from nodegraph_compare.left_out import absences, dropped, end_text, left_out
from nodegraph_compare.question import Question
from tests.plugins.nodegraph_compare.scores import group_of

QUESTION = Question("rmse", "fill", ("length",), ("gap",), (), ("gap",), (), ())


def lacking(length: int, blocks: int = 2) -> Group:
    values = np.tile([2.0, 3.0, np.nan], (blocks, 1))
    values[0, 1] = np.nan
    return group_of((length,), ("a", "b", "c"), values)


def test_what_is_dropped_is_counted_by_method() -> None:
    assert dropped(lacking(5)) == (
        "1 of 2 blocks left out (b lacks 1); without any number, not compared: c"
    )


def test_many_groups_are_summed_up_in_notes_and_warning() -> None:
    scores = Across.of({"a": pd.DataFrame()}, axis="fill")
    with pytest.warns(UserWarning, match=r"length 7: .*; and 92 more, see the table's notes"):
        noted = left_out(scores, QUESTION, [lacking(length, length + 2) for length in range(100)])
    assert noted[-1] == "and so in 60 more groups"
    assert len(noted) == 41


def test_what_several_groups_and_methods_lack_stands_once() -> None:
    absent = tuple(
        Absent({"fill": fill, "length": length}, "failed", "gaps of 5000 frames do not fit")
        for length, fills in ((5, "ab"), (45, "abc"))
        for fill in fills
    )
    scores = Across(("fill", "length"), (({"fill": "a"}, pd.DataFrame()),), absent)
    with pytest.warns(UserWarning, match="groups") as caught:
        left_out(scores, QUESTION, [lacking(length) for length in range(10)])
    groups = "; ".join(f"length {length}" for length in range(8))
    assert str(caught[0].message) == (
        f"{groups}; and 2 more groups: 1 of 2 blocks left out (b lacks 1); "
        "without any number, not compared: c; "
        "a, b: 2 combinations each; c: 1 combination failed (gaps of 5000 frames do not fit)"
    )


def test_absent_combinations_are_counted_by_label_with_two_of_their_reasons() -> None:
    absent = [Absent({"fill": "b"}, "refused", why) for why in ("x", "y", "x", "z", "w")]
    assert absences(absent, "fill") == ["b: 5 combinations refused (x; y; and 2 more reasons)"]
    each = [Absent({"fill": "b"}, "failed", f"fill(k={k}, fill=b) failed: (x)") for k in range(3)]
    assert absences(each, "fill") == ["b: 3 combinations failed (fill failed: (x))"]
    assert absences(absent[:1], None) == ["1 combination refused (x)"]


def test_the_better_end_is_reported() -> None:
    assert end_text(QUESTION) == "Lower is better."
    assert end_text(replace(QUESTION, metric="lag", better="none")) == (
        "Neither end of lag is the better one."
    )
