from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from nodegraph import Absent, Across
from nodegraph_compare.blocks import groups
from nodegraph_compare.question import Asked, ask
from tests.plugins.nodegraph_compare.scores import scored

NAN = np.nan


def across(
    values: dict[tuple[int, str], pd.DataFrame], *absent: tuple[int, str, str]
) -> Across[pd.DataFrame]:
    return Across(
        ("length", "fill"),
        tuple(({"length": value[0], "fill": value[1]}, table) for value, table in values.items()),
        tuple(Absent({"length": value[0], "fill": value[1]}, value[2], "why") for value in absent),
    )


def test_rows_become_blocks_in_the_order_of_the_labels() -> None:
    scores = across(
        {
            (45, "lin"): scored(1, 2),
            (45, "cubic"): scored(3, 4),
            (5, "lin"): scored(5, 6),
            (5, "cubic"): scored(7, 8),
        }
    )
    question = ask(scores, Asked(compare="fill", within=("length",)))
    long, short = groups(scores, question)
    assert (long.labels, short.labels) == ((45,), (5,))
    assert long.methods == short.methods == ("lin", "cubic")
    assert long.values.tolist() == [[1, 3], [2, 4]]
    assert short.values.tolist() == [[5, 7], [6, 8]]


def test_rows_are_averaged_within_their_block() -> None:
    scores = across({(5, "a"): scored(1, 3, 8), (15, "a"): scored(2, 4, 0)})
    question = ask(scores, Asked(compare="fill", blocks=("gap",)))
    (group,) = groups(scores, question)
    assert group.values.tolist() == [[1.5], [3.5], [4.0]]


def test_a_block_with_a_row_without_a_number_is_lacking() -> None:
    scores = across({(5, "a"): scored(1, NAN), (5, "b"): scored(1, np.inf), (5, "c"): scored(1, 2)})
    question = ask(scores, Asked(compare="fill", blocks=("length",)))
    (group,) = groups(scores, question)
    assert group.values[0] == pytest.approx([NAN, NAN, 1.5], nan_ok=True)
    assert group.missing.tolist() == [0.5, 0.5, 0.0]


def test_blocks_count_when_every_usable_method_has_them() -> None:
    scores = across(
        {
            (5, "a"): scored(1, NAN, 3),
            (5, "b"): scored(1, 2),
            (5, "c"): scored(NAN, NAN, NAN),
        }
    )
    question = ask(scores, Asked(compare="fill", within=("length",)))
    (group,) = groups(scores, question)
    assert group.usable.tolist() == [True, True, False]
    assert group.complete.tolist() == [True, False, False]


def test_refused_combinations_are_a_share_and_skipped_ones_are_not_there() -> None:
    scores = across(
        {(5, "a"): scored(1), (15, "a"): scored(2), (15, "b"): scored(3)},
        (5, "b", "refused"),
        (45, "b", "failed"),
        (45, "a", "skipped"),
    )
    by_length = ask(scores, Asked(compare="fill", within=("length",)))
    short, middle, long = groups(scores, by_length)
    assert (short.methods, short.refused.tolist()) == (("a", "b"), [0, 1])
    assert np.isnan(short.values[0, 1])
    assert np.isnan(short.missing[1])
    assert (middle.methods, middle.refused.tolist()) == (("a", "b"), [0, 0])
    assert (long.labels, long.methods, long.refused.tolist()) == ((45,), ("b",), [1])
    assert not long.complete.any()
    together = ask(scores, Asked(compare="fill", blocks=("length", "gap")))
    (group,) = groups(scores, together)
    assert group.refused == pytest.approx([0, 2 / 3])


def test_columns_of_the_tables_group_too() -> None:
    table = pd.DataFrame({"marker": ["x", "y", "x"], "side": ["l", "r", "r"], "rmse": [1.0, 2, 3]})
    scores = Across.of({"a": table, "b": table.assign(rmse=table["rmse"] * 2)}, axis="fill")
    question = ask(scores, Asked(compare="fill", within=("side",), blocks=("marker",)))
    left, right = groups(scores, question)
    assert (left.labels, left.values.tolist()) == (("l",), [[1, 2]])
    assert (right.labels, right.values.tolist()) == (("r",), [[3, 6], [2, 4]])


def test_nothing_compared_is_one_column() -> None:
    scores = Across((), (({}, scored(1, 2, 3)),))
    question = ask(scores, Asked())
    (group,) = groups(scores, question)
    assert group.methods == ("",)
    assert group.values.tolist() == [[1], [2], [3]]


def test_tables_without_rows_have_no_groups() -> None:
    scores = Across.of({"a": scored(1).iloc[:0]}, axis="fill")
    question = ask(scores, Asked(metric="rmse"))
    assert groups(scores, question) == ()
