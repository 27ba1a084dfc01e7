from __future__ import annotations

from typing import Any

import pandas as pd
import pytest

from nodegraph import Absent, Across
from nodegraph_compare.blocks import label_order
from nodegraph_compare.comparison import fallback_label
from nodegraph_compare.question import Asked, Question, ask

TABLE = pd.DataFrame({"gap": [0, 1], "rmse": [1.0, 2.0]})


def question_of(scores: Across[Any]) -> Question:
    return ask(scores, Asked(metric="rmse"))


def across(present: list[tuple[int, str]], absent: list[tuple[int, str, str]]) -> Across[None]:
    return Across(
        ("trial", "fill"),
        tuple(({"trial": trial, "fill": fill}, None) for trial, fill in present),
        tuple(Absent({"trial": trial, "fill": fill}, kind, "") for trial, fill, kind in absent),
    )


def test_a_label_absent_from_the_first_trial_keeps_its_place() -> None:
    scores = across(
        [(0, "a"), (0, "c"), (1, "a"), (1, "b"), (1, "c"), (2, "z"), (2, "a")],
        [(0, "b", "refused"), (0, "never", "failed"), (1, "left", "skipped")],
    )
    assert label_order(scores, "fill") == ("z", "a", "b", "c", "never")
    assert label_order(scores, "trial") == (0, 1, 2)


def test_the_order_does_not_depend_on_which_axis_runs_fastest() -> None:
    scores = across([(1, "b"), (0, "b"), (1, "a"), (0, "a")], [])
    assert label_order(scores, "fill") == ("b", "a")
    assert label_order(scores, "trial") == (1, 0)


def test_a_fallback_that_is_not_compared_is_warned_of_and_left_out() -> None:
    assert fallback_label(("linear", "cubic"), "cubic") == "cubic"
    assert fallback_label(("linear",), None) is None
    with pytest.warns(UserWarning, match="'cubic' is not among those compared"):
        assert fallback_label(("linear",), "cubic") is None
