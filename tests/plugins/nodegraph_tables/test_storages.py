"""Tables and figures in a store: what a reader gets, and what a report shows."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import nodegraph_tables
from nodegraph.store import Packer, Unstorable
from nodegraph_mocap.specimens import specimens
from nodegraph_tables import StoredFigure
from nodegraph_tables.renderers import render_figure, renderers
from nodegraph_tables.storage import storages


@pytest.fixture
def packer() -> Packer:
    return Packer(storages())


@pytest.fixture
def figure() -> Figure:
    made = Figure(figsize=(3, 2))
    axes = made.subplots()
    axes.plot([1, 2], [3, 5], marker="o", label="a")
    axes.fill_between([1, 2], [3, 5], hatch="/")
    axes.legend()
    return made


def there_and_back(value: Any, packer: Packer) -> Any:
    packed = packer.pack(value)
    return packer.unpack(packed.head, [bytes(one) for one in packed.buffers])


def test_the_hook_gives_them() -> None:
    kinds = [one.type.__name__ for one in nodegraph_tables.nodegraph_storages()]
    assert kinds == ["Table", "Figure"]


def test_a_table_comes_back(packer: Packer) -> None:
    table = pd.DataFrame({"a": [1.5, np.nan], "b": ["x", None]})
    table.attrs["units"] = {"a": "mm"}
    back = there_and_back((table, 1), packer)[0]
    pd.testing.assert_frame_equal(back, table, check_exact=True)
    assert back.attrs == table.attrs
    assert packer.pack(table).faithful


def test_a_table_of_what_nobody_can_keep_is_refused(packer: Packer) -> None:
    table = pd.DataFrame({"a": pd.Series([object()], dtype=object)})
    with pytest.raises(Unstorable, match=r"object.*DataFrame"):
        packer.pack(table)
    with pytest.raises(Unstorable, match="'b'"):
        packer.pack(pd.DataFrame({"b": pd.period_range("2020", periods=2)}))


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
        (renderer,) = [one for one in renderers() if isinstance(stored, one.type)]
        assert renderer.render(stored, title) == render_figure(figure, title)


def test_a_figure_comes_back_as_a_stand_in(packer: Packer, figure: Figure) -> None:
    assert not packer.pack(figure).faithful
    assert not packer.travels(Figure)
    assert not packer.travels(nodegraph_tables.Figure)
    assert packer.travels(nodegraph_tables.Table)
    stored = there_and_back(figure, packer)
    assert there_and_back(stored, packer) == stored
    assert packer.digest(figure) == packer.digest(figure)


def test_every_type_that_travels_comes_back(packer: Packer) -> None:
    for kind, make in specimens().items():
        if not packer.travels(kind):
            continue
        for name, value in make().items():
            back = there_and_back(value, packer)
            assert type(back) is type(value), name
            assert packer.digest(back) == packer.digest(value), name


def test_asking_for_storages_imports_no_heavy_library() -> None:
    program = (
        "import sys, nodegraph_mocap\n"
        "from nodegraph.store import Packer\n"
        "packer = Packer(nodegraph_tables.nodegraph_storages())\n"
        "packer.pack(1.5), packer.lend((1,))\n"
        "sys.exit(len({'pandas', 'matplotlib'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
