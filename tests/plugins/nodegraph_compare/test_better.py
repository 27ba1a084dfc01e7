from __future__ import annotations

from typing import Any

import pandas as pd
import pytest

from nodegraph import Across
from nodegraph_compare.question import better_end, sign_of
from nodegraph_tables import TableInfo, with_info


def declared(*ends: Any) -> Across[pd.DataFrame]:
    tables = {}
    for place, end in enumerate(ends):
        info = TableInfo(better={} if end is None else {"recall": end})
        tables[place] = with_info(pd.DataFrame({"recall": [0.5]}), info)
    return Across.of(tables, axis="method")


@pytest.mark.parametrize("end", ["lower", "higher", "none"])
def test_tables_say_which_end_is_better(end: object) -> None:
    assert better_end(declared(end, end), "recall", "declared") == end


def test_lower_is_better_where_nobody_says() -> None:
    assert better_end(declared(None, None), "recall", "declared") == "lower"
    assert better_end(declared("higher"), "rmse", "declared") == "lower"


def test_a_setting_has_the_last_word() -> None:
    assert better_end(declared("higher", "lower"), "recall", "none") == "none"


def test_tables_that_disagree_are_refused() -> None:
    with pytest.raises(ValueError, match=r"different ends of 'recall' .*: higher, lower; give"):
        better_end(declared("higher", None), "recall", "declared")


def test_signs() -> None:
    assert [sign_of(end) for end in ("lower", "higher", "none")] == [1.0, -1.0, 1.0]
