from __future__ import annotations

from nodegraph import Absent, Across
from nodegraph_compare.labels import label_order


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
