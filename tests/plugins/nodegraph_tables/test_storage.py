"""Stored tables come back exactly or are refused; stored figures come back as drawings."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import nodegraph_mocap
import nodegraph_tables
from nodegraph.equality import same
from nodegraph.store import Packer, Unreadable
from nodegraph_tables import Answer, StoredFigure
from nodegraph_tables.figures import render_figure, render_stored_figure
from nodegraph_tables.info import TableInfo, Take, info_of, with_info
from nodegraph_tables.stored_table import put_together, take_apart


@pytest.fixture
def packer() -> Packer:
    return Packer(nodegraph_tables.nodegraph_kinds())


@pytest.fixture
def figure() -> Figure:
    drawing = Figure(figsize=(3, 2))
    axes = drawing.subplots()
    axes.plot([1, 2], [3, 5], marker="o", label="a")
    axes.fill_between([1, 2], [3, 5], hatch="/")
    axes.legend()
    return drawing


def there_and_back(value: object, packer: Packer) -> Any:
    packed = packer.pack(value)
    return packer.unpack(packed.head, [bytes(buffer) for buffer in packed.buffers])


def test_a_digest_does_not_depend_on_how_pandas_holds_texts(packer: Packer) -> None:
    pytest.importorskip("pyarrow")
    plain, arrow = (
        pd.DataFrame({"a": pd.array(["x", None], dtype=dtype)})
        for dtype in (
            pd.StringDtype("python", na_value=np.nan),
            pd.StringDtype("pyarrow", na_value=np.nan),
        )
    )
    assert packer.digest(plain) == packer.digest(arrow)
    assert same(there_and_back(plain, packer), there_and_back(arrow, packer))


def test_what_a_table_says_comes_back_with_it(packer: Packer) -> None:
    info = TableInfo(
        answer=Answer(("x",)),
        units={"a": "mm"},
        best={"a": (0,)},
        cells={"a": {"low": "b"}},
        labels=(),
    )
    table = with_info(pd.DataFrame({"a": [1.5], "b": [1.0]}), info)
    back = there_and_back(table, packer)
    assert same(back, table)
    assert info_of(back) == info
    assert packer.digest(back) == packer.digest(table)
    assert not same(back, with_info(table, replace(info, notes=("y",))))


def test_a_damaged_record_is_not_read(packer: Packer) -> None:
    packed = packer.pack(with_info(pd.DataFrame({"a": [1.5]}), TableInfo(better={"a": "lower"})))
    head = packed.head.replace('"lower"', '"louder"')
    with pytest.raises(Unreadable, match=r"better\.a"):
        packer.unpack(head, [bytes(buffer) for buffer in packed.buffers])


def test_a_digest_does_not_depend_on_how_a_table_lies_in_memory(packer: Packer) -> None:
    table = pd.DataFrame(np.arange(20.0).reshape(5, 4), columns=list("abcd"))
    same = pd.DataFrame({name: table[name].tolist() for name in "abcd"})
    assert packer.digest(table) == packer.digest(same)
    assert packer.digest(table) != packer.digest(table.rename(columns={"a": "e"}))
    assert packer.digest(table) != packer.digest(table.astype("f4"))


def test_what_a_reader_does_to_a_table_no_other_reader_sees(packer: Packer) -> None:
    table = pd.DataFrame({"a": [1.0, 2.0], "b": pd.array([1, None], dtype="Int64")})
    table.attrs["notes"] = ["one"]
    lent = packer.lend(table)
    lent.loc[0, "a"] = 9
    lent.iloc[1, 1] = 5
    lent["c"] = 1
    lent.attrs["notes"].append("two")
    lent.index.name = "row"
    lent.columns.name = "column"
    lent.columns = pd.Index(["z", "b", "c"])
    assert table["a"].tolist() == [1, 2]
    assert table["b"].isna().tolist() == [False, True]
    assert list(table.columns) == ["a", "b"]
    assert table.attrs == {"notes": ["one"]}
    assert (table.index.name, table.columns.name) == (None, None)


def test_a_computed_table_and_a_stored_one_lie_alike_in_memory(packer: Packer) -> None:
    rng = np.random.default_rng(5)
    table = pd.DataFrame(rng.normal(size=(997, 4)), columns=list("abcd"))
    table.insert(0, "method", "x")
    computed, stored = packer.lend(table), packer.lend(there_and_back(table, packer))
    for name in "abcd":
        assert computed[name].to_numpy().strides == stored[name].to_numpy().strides
    for name in "abcd":
        assert computed[name].to_numpy().sum() == stored[name].to_numpy().sum()


def test_a_stored_figure_looks_as_if_it_were_drawn_now(packer: Packer, figure: Figure) -> None:
    for title in ("Errors", 'Other "title"'):
        stored = there_and_back(figure, packer)
        assert type(stored) is StoredFigure
        assert render_stored_figure(stored, title) == render_figure(figure, title)


def test_a_figure_comes_back_as_a_stand_in(packer: Packer, figure: Figure) -> None:
    assert not packer.pack(figure).faithful
    assert not packer.travels(Figure)
    assert not packer.travels(nodegraph_tables.Figure)
    assert packer.travels(nodegraph_tables.Table)
    stored = there_and_back(figure, packer)
    assert there_and_back(stored, packer) == stored
    assert packer.digest(figure) == packer.digest(figure)


MAKERS = {
    kind.type: kind.specimens
    for kind in (*nodegraph_mocap.nodegraph_kinds(), *nodegraph_tables.nodegraph_kinds())
    if kind.specimens
}


def test_every_type_that_travels_comes_back(packer: Packer) -> None:
    for kind, make in MAKERS.items():
        if not packer.travels(kind):
            continue
        for name, value in make().items():
            back = there_and_back(value, packer)
            assert type(back) is type(value), name
            assert packer.digest(back) == packer.digest(value), name


def test_the_take_of_a_table_is_stored_with_it(packer: Packer) -> None:
    info = TableInfo(take=Take(600, 12.5))
    back = there_and_back(with_info(pd.DataFrame({"rmse": [1.0]}), info), packer)
    assert info_of(back).take == info.take


def test_asking_for_storages_imports_no_heavy_library() -> None:
    program = (
        "import sys, nodegraph_tables\n"
        "from nodegraph.store import Packer\n"
        "packer = Packer(nodegraph_tables.nodegraph_kinds())\n"
        "packer.pack(1.5), packer.lend((1,))\n"
        "sys.exit(len({'pandas', 'matplotlib'} & set(sys.modules)))"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert ended.returncode == 0, ended.stderr


RNG = np.random.default_rng(3)


def objects(*values: object) -> pd.Series[Any]:
    held = np.empty(len(values), dtype=object)
    for place, value in enumerate(values):
        held[place] = value
    return pd.Series(held, dtype=object)


def inserted() -> pd.DataFrame:
    """Numbers that lie in memory row by row, with texts before them."""
    table = pd.DataFrame(RNG.normal(size=(1001, 5)), columns=list("abcde"))
    table.insert(0, "method", "muscle")
    return table


def with_attributes() -> pd.DataFrame:
    table = pd.DataFrame({"a": [1.5]})
    table.attrs = {"title": "T", "notes": ["one"], "units": {"a": "mm"}}
    return table


ZERO: Any = pd.array([0.0, 1.0, None], dtype="Float64")
TABLES = {
    "numbers": pd.DataFrame({"a": [1, 2], "b": [1.5, np.nan], "c": [True, False]}),
    "small kinds": pd.DataFrame({"a": np.ones(2, "f4"), "b": np.ones(2, "u1"), "c": [1j, 2]}),
    "texts": pd.DataFrame({"a": ["x", None], "b": ["é", ""]}),
    "strings with NA": pd.DataFrame({"a": pd.array(["x", None], dtype="string")}),
    "objects": pd.DataFrame({"a": objects(1, "x", None, (1, 2), [3], np.nan, True)}),
    "texts as objects": pd.DataFrame({"a": objects("x", "y")}),
    "times": pd.DataFrame(
        {"a": pd.to_datetime(["2020-01-01", "NaT"]), "b": pd.to_timedelta([1, 2], unit="s")}
    ),
    "nullable": pd.DataFrame(
        {
            "a": pd.array([1, None], dtype="Int64"),
            "b": pd.array([1.5, None], dtype="Float32"),
            "c": pd.array([True, None], dtype="boolean"),
            "d": pd.array([2**64 - 1, None], dtype="UInt64"),
        }
    ),
    "NaN beside NA": pd.DataFrame({"a": ZERO / ZERO}),
    "categories": pd.DataFrame(
        {
            "a": pd.Categorical(["x", "y", None], categories=["y", "x", "z"], ordered=True),
            "b": pd.Categorical([3, 1, 3]),
        }
    ),
    "one name twice": pd.DataFrame(np.eye(3), columns=["a", "a", "b"], index=["x", "x", "y"]),
    "names of any kind": pd.DataFrame(
        [[1, 2.0, "x", None]], columns=pd.Index(["a", 1, None, 2.5], dtype=object)
    ),
    "names of columns": pd.DataFrame([[1, 2]], columns=pd.Index(["a", "b"], name="metric")),
    "numbered columns": pd.DataFrame(np.eye(2, dtype="f4")),
    "columns on levels": pd.DataFrame(
        np.eye(2), columns=pd.MultiIndex.from_product([["m"], ["x", "y"]], names=["k", None])
    ),
    "rows on levels": pd.DataFrame(
        {"a": [1, 2]}, index=pd.MultiIndex.from_tuples([(1, "x"), (2, None)], names=["i", None])
    ),
    "counted rows": pd.DataFrame({"a": [1, 2]}, index=pd.RangeIndex(4, 0, -2, name="r")),
    "named rows": pd.DataFrame({"a": [1]}, index=pd.Index([5], name=("t", 1))),
    "dated rows": pd.DataFrame({"a": [1]}, index=pd.DatetimeIndex(["2020-01-01"])),
    "rows of categories": pd.DataFrame({"a": [1]}, index=pd.CategoricalIndex(["q"])),
    "no rows": pd.DataFrame({"a": np.empty(0, "f4"), "b": pd.Series([], dtype=str)}),
    "no columns": pd.DataFrame(index=[1, 2]),
    "nothing": pd.DataFrame(),
    "attributes": with_attributes(),
    "no name twice": pd.DataFrame({"a": [1]}).set_flags(allows_duplicate_labels=False),
    "row by row": pd.DataFrame(RNG.normal(size=(1001, 5))),
    "inserted": inserted(),
    "every second": inserted().iloc[::2],
}


@pytest.mark.parametrize("name", TABLES)
def test_a_table_comes_back_exactly(name: str) -> None:
    table = TABLES[name]
    back = put_together(take_apart(table))
    pd.testing.assert_frame_equal(
        table, back, check_exact=True, check_flags=True, check_freq=True, check_column_type=True
    )
    assert type(back.index) is type(table.index)
    assert type(back.columns) is type(table.columns)
    assert back.index.names == table.index.names
    assert back.attrs == table.attrs
    for place in range(table.shape[1]):
        value, other = table.iloc[:, place], back.iloc[:, place]
        assert value.dtype == other.dtype
        assert list(map(type, value)) == list(map(type, other))


def test_a_table_that_was_put_together_can_be_changed() -> None:
    for table in (TABLES["numbers"], TABLES["nullable"]):
        parts = take_apart(table)
        for part in parts["data"]:
            part[1].flags.writeable = False  # as what comes from the store
        back = put_together(parts)
        back.iloc[0, 0] = 7
        assert back.iloc[0, 0] == 7
        assert table.iloc[0, 0] == 1


class Special(pd.DataFrame):
    pass


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (pd.DataFrame({"x": pd.to_datetime(["2020-01-01"]).tz_localize("UTC")}), "'x'.*UTC"),
        (pd.DataFrame({"x": pd.period_range("2020", periods=2)}), "'x'.*period"),
        (pd.DataFrame({"x": pd.arrays.SparseArray([0, 1])}), "'x'.*Sparse"),
        (pd.DataFrame({"x": pd.interval_range(0, 2)}), "'x'.*interval"),
        (pd.DataFrame({"x": [1]}, index=pd.period_range("2020", periods=1)), "PeriodIndex"),
        (pd.DataFrame({"x": [1]}, index=pd.date_range("2020", periods=1)), "DatetimeIndex"),
        (Special({"x": [1]}), "Special is more"),
    ],
)
def test_what_would_not_come_back_exactly_is_refused(table: pd.DataFrame, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        take_apart(table)


RANGE = ("range", 0, 2, 1, None)
EMPTY = ("range", 0, 0, 1, None)
CODES = np.array([0, 1])


def levels(codes: object) -> tuple[Any, ...]:
    """Return an index on one level."""
    return ("multi", [RANGE], [codes], [None])


FORGED: dict[str, dict[str, object]] = {
    "no parts": {"columns": 1, "index": None, "data": 5},
    "a column of one number": {"data": [("numpy", np.float64(1))]},
    "a column of rows": {"data": [("numpy", np.zeros((2, 1)))]},
    "a longer column": {"data": [("numpy", np.zeros(3))]},
    "a column of an unknown kind": {"data": [("odd", np.zeros(2), np.zeros(2, bool))]},
    "a text for a column": {"data": [("objects", "ab")]},
    "numbers as texts": {"data": [("text", [1, 2], "python", True)]},
    "a column without missing values": {"data": [("integer", np.zeros(2, int))]},
    "missing values of another length": {
        "data": [("integer", np.zeros(2, int), np.zeros(3, bool))]
    },
    "categories beyond the last": {
        "data": [("categorical", np.array([0, 7]), ("range", 0, 2, 1, None), False)]
    },
    "more categories than can be": {
        "data": [("categorical", np.array([0, 1]), ("range", 0, 2**40, 1, None), False)]
    },
    "an endless index": {"index": ("range", 0, 2**40, 1, None), "data": [], "columns": EMPTY},
    "an endless index of one number": {
        "index": ("range", 0, 2**40, 1, None), "data": [("numpy", np.float64(1))]
    },
    "an index without numbers": {"index": ("range", 0, "2", 1, None)},
    "an index that is none": {"index": ("odd", 1)},
    "an index with no name": {"index": ("range", 0, 2, 1, [])},
    "a code beyond its level": {"index": levels(np.array([0, 9]))},
    "a code below its level": {"index": levels(np.array([0, -2]))},
    "codes that are not numbers": {"index": levels([0, 1])},
    "codes that are fractions": {"index": levels(np.array([0.0, 1.0]))},
    "codes in rows": {"index": levels(np.array([[0], [1]]))},
    "fewer codes than levels": {"index": ("multi", [RANGE, RANGE], [CODES], [None, None])},
    "levels of levels": {"index": ("multi", [levels(CODES)], [CODES], [None])},
    "more columns": {"columns": ("range", 0, 5, 1, None)},
    "attributes that are none": {"attrs": 5},
    "names twice": {"columns": ("index", ("objects", ["a", "a"]), None), "unique": True},
}  # fmt: skip


@pytest.mark.parametrize("name", FORGED)
def test_parts_of_no_table_are_refused(name: str) -> None:
    parts = take_apart(TABLES["numbers"].iloc[:, :1])
    assert put_together(parts).shape == (2, 1)
    with pytest.raises((ValueError, TypeError, AttributeError, KeyError)):
        put_together(parts | FORGED[name])
