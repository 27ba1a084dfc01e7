"""What a table says beside its rows stays with it, through pandas and through a store."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest
from pydantic import ValidationError

from nodegraph.execute.run import execute
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_text
from nodegraph.node.decorator import node
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry
from nodegraph_tables import Answer, TableInfo, info_of, with_info

INFO = TableInfo(
    title="Errors",
    answer=Answer(("a is best.",)),
    notes=("one", "two"),
    units={"rmse": "mm"},
    better={"rmse": "lower"},
    labels=("fill",),
    best={"rmse": (0,)},
    cells={"rmse": {"low": "low", "high": "high"}},
)
ROWS = pd.DataFrame({"fill": ["a", "b"], "rmse": [1.0, 2.0], "low": [0.5, 1], "high": [2.0, 3]})


def test_a_plain_table_says_nothing() -> None:
    assert info_of(ROWS) == TableInfo()
    assert info_of(pd.DataFrame({"table_info": [1]})) == TableInfo()


def test_the_table_itself_is_left_as_it_is() -> None:
    table = with_info(ROWS, INFO)
    assert info_of(table) == INFO
    assert info_of(ROWS) == TableInfo()
    pd.testing.assert_frame_equal(table, ROWS)


@pytest.mark.parametrize(
    "operation",
    [
        lambda table: table.copy(),
        lambda table: table[table["rmse"] > 1.0],
        lambda table: table.sort_values("rmse"),
        lambda table: table.reset_index(),
        lambda table: table.drop(columns="low"),
        lambda table: table.iloc[:1],
    ],
)
def test_operations_of_pandas_pass_it_on(
    operation: Callable[[pd.DataFrame], pd.DataFrame],
) -> None:
    assert info_of(operation(with_info(ROWS, INFO))) == INFO


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("title", 3),
        ("answer", [3]),
        ("answer", "a sentence"),
        ("notes", None),
        ("units", {"rmse": 1}),
        ("better", {"rmse": "up"}),
        ("best", {"rmse": ["first"]}),
        ("cells", {"rmse": {"middle": "low"}}),
    ],
)
def test_a_field_of_another_type_is_refused_by_its_name(field: str, value: object) -> None:
    fields: dict[str, object] = {field: value}
    with pytest.raises(ValidationError, match=rf"TableInfo\n{field}"):
        TableInfo(**fields)  # type: ignore[arg-type]


@node("score.rows")
def rows(*, trial: int) -> pd.DataFrame:
    return with_info(ROWS.assign(rmse=ROWS["rmse"] * trial), INFO)


def test_the_table_of_all_combinations_has_that_of_the_first() -> None:
    text = (
        "nodegraph: 1\naxes: {trial: [1, 2]}\nnodes: {a: {use: score.rows, with: {trial: $trial}}}"
    )
    graph = build(read_graph_text(text, "toy.yaml", Path()), Registry.of([rows]))
    frame = execute(plan(graph))["a"].frame()
    assert frame["trial"].tolist() == [1, 1, 2, 2]
    assert info_of(frame) == INFO
