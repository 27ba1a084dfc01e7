"""What a function was made with counts as its source does, by value."""

from __future__ import annotations

import linecache
import os
import sys
import threading
from collections import namedtuple
from collections.abc import Callable
from functools import partial, wraps
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph.cache_key import Code, Reached
from tests.texts import any_text

from .toys import Function, Kind, Pair, Rule, far, near, over, with_default

if TYPE_CHECKING:  # it imports modules by names, and functions of this module would lead to all
    from .conftest import Folder

CODE = Code([])


def of(function: Any) -> Reached:
    return CODE.of(function)


@pytest.mark.parametrize("make", [over, with_default, lambda value: partial(near, value)])
@pytest.mark.parametrize(
    ("each", "other"),
    [
        (1, 2),
        (1, True),
        (1, 1.0),
        (0.0, -0.0),
        ("a", b"a"),
        ((1, 2), [1, 2]),
        ((1, 2), (2, 1)),
        ({"a": 1}, {"a": 2}),
        ({1, 2}, {1, 3}),
        (np.arange(6.0).reshape(2, 3), np.arange(6.0).reshape(3, 2)),
        (np.zeros(2), np.zeros(2, dtype=np.int64)),
        (np.float64(1), np.float32(1)),
        (np.array([{}, 1], dtype=object), np.array([{}, 2], dtype=object)),
        (Kind.ONE, Kind.TWO),
        (Pair(1, 2), Pair(1, 3)),
        (Rule(1.0), Rule(2.0)),
        (Path("a"), Path("b")),
        (near, far),
        (over(1), over(2)),
        ((over(1), over(2)), (over(2), over(1))),
        (partial(near, 1), partial(near, 2)),
        (partial(near), partial(far)),
        (np.mean, np.median),
        (np.add, np.subtract),
        (np, np.linalg),
        (int, float),
        (len, sum),
        ("a".join, "b".join),
        (Rule(1.0).__eq__, Rule(2.0).__eq__),
    ],
)
def test_values_are_distinguished(
    make: Callable[[Any], Function], each: object, other: object
) -> None:
    first, second = of(make(each)), of(make(other))
    assert not first.unstable
    assert first.digest == of(make(each)).digest
    assert first.digest != second.digest


@given(
    st.recursive(
        st.none() | st.integers() | st.floats() | any_text() | st.binary() | st.booleans(),
        lambda inner: st.lists(inner) | st.dictionaries(any_text(), inner) | st.tuples(inner),
        max_leaves=8,
    )
)
def test_equal_values_have_one_digest(value: object) -> None:
    again = eval(repr(value), {"nan": float("nan"), "inf": float("inf")})
    assert of(over(value)).digest == of(over(again)).digest


def test_a_set_has_no_order() -> None:
    assert of(over({"a", "b", "c"})).digest == of(over({"c", "b", "a"})).digest


def test_the_units_of_what_was_made() -> None:
    inner = f"{with_default.__module__}:with_default.<locals>.inner"
    one, two = of(with_default(1)).units, of(with_default(2)).units
    assert set(one) == {inner, with_default.__module__}
    assert [name for name in one if one[name] != two[name]] == [inner]
    assert of(over(np.mean)).versions["numpy"] == np.__version__


@pytest.mark.parametrize("function", [os.path.join, namedtuple, np.mean])
def test_functions_of_libraries_count_by_version(function: Any) -> None:
    reached = of(over(function))
    assert not reached.unstable
    assert function.__module__ not in reached.units


def test_functions_of_libraries_as_nodes() -> None:
    assert set(of(np.linalg.norm).versions) == {"python", "numpy"}
    assert not of(namedtuple).units
    assert not of(partial(np.nanmedian)).unstable  # its defaults are not plain values
    digests = {of(value).digest for value in (namedtuple, wraps, np.mean, np.median, os.path.join)}
    assert len(digests) == 5


def test_a_module_that_was_made_by_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    def held(number: int) -> Reached:
        module = ModuleType("by_hand")
        monkeypatch.setitem(sys.modules, "by_hand", module)
        text = "class Shape:\n def area(self): return {0}\ndef near(x): return {0}"
        vars(module).update(in_cell(text.format(number), "<by hand>", __name__="by_hand"))
        return of(over((module.Shape, module.near)))

    assert held(1).digest == held(1).digest
    assert held(1).digest != held(2).digest


def test_a_function_that_holds_itself() -> None:
    def make(limit: int) -> Function:
        def inner(x: int) -> int:
            return inner(x - 1) if x > limit else limit

        return inner

    assert of(make(1)).digest == of(make(1)).digest
    assert of(make(1)).digest != of(make(2)).digest


@pytest.mark.parametrize("value", [threading.Lock(), np.random.default_rng(0), iter(())])
def test_what_has_no_digest_makes_a_function_unstable(value: Any) -> None:
    name = type(value).__qualname__
    for function in (over(value), over([{"deep": value}]), partial(near, value)):
        assert f"holds a {name}, of which no digest can be made" in of(function).unstable
    assert "over.<locals>.inner holds" in of(over(value)).unstable


def test_what_is_nested_too_deeply() -> None:
    deep: list[Any] = []
    for _ in range(5000):
        deep = [deep]
    assert "nested too deeply" in of(over(deep)).unstable


def test_a_wrapped_function_and_its_wrapper(folder: Folder) -> None:
    text = """
        from functools import wraps

        def checked(limit):
            def decorate(function):
                @wraps(function)
                def wrapper(x):
                    return function(x) + {wrapper}
                return wrapper
            return decorate

        def quietly(function):
            def wrapper(x):
                return function(x) - {wrapper}
            return wrapper

        @checked(1)
        def fill(x):
            return x * {function}

        def bare(x):
            return x * {function}

        made = checked(2)(bare)
        quiet = quietly(bare)
    """
    texts = {
        name: text.format(**{"wrapper": 1, "function": 1} | edit)
        for name, edit in {
            "now": {},
            "wrapper": {"wrapper": 2},
            "function": {"function": 2},
        }.items()
    }
    for name in ("fills:fill", "fills:made", "fills:quiet"):
        for edit in ("wrapper", "function"):
            folder.write({"fills.py": texts["now"]})
            assert "fills" in folder.changes(name, {"fills.py": texts[edit]})


def test_a_wrapper_made_by_hand() -> None:
    def decorate(function: Function, extra: int) -> Function:
        @wraps(function)
        def wrapper(x: int) -> int:
            return int(function(x)) + extra

        return wrapper

    assert of(decorate(over(1), 1)).digest != of(decorate(over(2), 1)).digest
    assert of(decorate(over(1), 1)).digest != of(decorate(over(1), 2)).digest


def test_lambdas_of_one_module_are_distinguished(folder: Folder) -> None:
    folder.write({"fills.py": "first = lambda x: x + 1\nsecond = lambda x: x + 2\n"})
    assert folder.reached("fills:first").digest != folder.reached("fills:second").digest


def test_a_function_that_its_module_has_under_another_name(folder: Folder) -> None:
    text = "def fill(x): return 1\nfirst = fill\ndef fill(x): return 2\nsecond = fill"
    folder.write({"fills.py": text})
    assert folder.reached("fills:first").digest != folder.reached("fills:second").digest


def test_functions_made_in_a_loop(folder: Folder) -> None:
    folder.write({"fills.py": "made = []\nfor k in 1, 2:\n    made.append(lambda x, k=k: x + k)"})
    folder.write({"first.py": "from fills import made\none, two = made"})
    first, second = folder.reached("first:one"), folder.reached("first:two")
    assert first.digest != second.digest
    assert not first.unstable


WITHOUT_FILE = """
LIMIT = 3
import wave
def far(x): return x + 1
def near(x, *, k=0): return [far(y) for y in x if y in {"a", "b"}]
def fill(x):
    "Doc."
    import wave
    return near(x), LIMIT, wave.open, (lambda y: y)(x)  # done
"""


def digest_of(source: str) -> str:
    names: dict[str, Any] = {"__name__": "__main__"}
    exec(source, names)
    reached = of(names["fill"])
    assert not reached.unstable
    assert set(reached.units) == {"__main__:fill"}
    return reached.digest


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("return x + 1", "return x + 2"),
        ("LIMIT = 3", "LIMIT = 4"),
        ("LIMIT = 3", "LIMIT = True"),
        ('"b"}', '"c"}'),
        ("near(x)", "near(-x)"),
        ("near(x)", "near(x, k=1)"),
        ("y: y", "y: -y"),
        ("k=0", "k=1"),
        ("fill(x)", "fill(x, *more)"),
        ("wave.open", "wave.Error"),
    ],
)
def test_an_edit_of_a_function_without_a_file(old: str, new: str) -> None:
    assert old in WITHOUT_FILE
    assert digest_of(WITHOUT_FILE) != digest_of(WITHOUT_FILE.replace(old, new))


@pytest.mark.parametrize(("old", "new"), [("Doc.", "Other."), ("# done", ""), ("\n", "\n\n")])
def test_a_cosmetic_edit_of_a_function_without_a_file(old: str, new: str) -> None:
    assert digest_of(WITHOUT_FILE) == digest_of(WITHOUT_FILE.replace(old, new))


def test_a_function_without_a_file_reaches_the_modules_that_it_names(folder: Folder) -> None:
    folder.write({"tools.py": "import helper\nA = 1", "helper.py": "A = 1", "late.py": "A = 1"})
    text = "import tools\ndef fill(x):\n    def inner():\n        import late\n    return tools"

    def reached() -> Reached:
        folder.forget()
        names: dict[str, Any] = {"__name__": "__main__"}
        exec(text, names)
        return Code([]).of(names["fill"])

    before = reached()
    assert set(before.units) == {"__main__:fill", "helper", "late", "tools"}
    for name in ("helper", "late"):
        folder.write({f"{name}.py": "A = 2"})
        after = reached()
        assert after.digest != before.digest
        before = after


def in_cell(text: str, name: str, **names: object) -> dict[str, object]:
    """Run a text as a notebook does, which keeps it for tracebacks."""
    linecache.cache[name] = (len(text), None, text.splitlines(keepends=True), name)
    result: dict[str, Any] = {"__name__": "__main__", **names}
    exec(compile(text, name, "exec", dont_inherit=True), result)
    return result


def test_a_function_of_a_cell() -> None:
    text = (
        "import numpy as np\nfrom nodegraph import node\nLIMIT = 1\n\n"
        "class Shape:\n    sides = 3\n    def area(self): return LIMIT\n\n"
        "def near(x): return np.sum(x) + {}\n\n"
        "@node('fill.cell', cite='{}')\n"
        "def fill(x: int) -> int:\n    '''{}'''\n    return near(x) + LIMIT + Shape().area()\n"
    )

    def cell_with(*parts: object) -> Reached:
        return of(in_cell(text.format(*parts), "<cell 1>")["fill"])

    reached = cell_with(1, "a", "Doc.")
    assert set(reached.units) == {"__main__:fill"}
    assert set(reached.versions) == {"python", "numpy"}
    assert not reached.unstable
    assert cell_with(1, "b", "Other.").digest == reached.digest
    assert cell_with(2, "a", "Doc.").digest != reached.digest


def test_a_class_of_a_cell() -> None:
    text = (
        "from dataclasses import dataclass\n@dataclass\nclass Shape:\n"
        "    sides: int = {}\n    def area(self): return {}\n"
        "    @property\n    def rim(self): return 1\n    @staticmethod\n    def of(): return {}\n"
        "def fill(x: int) -> int: return Shape().area()\n"
    )

    def cell_with(*parts: int) -> Reached:
        return of(in_cell(text.format(*parts), "<cell 1>")["fill"])

    first = cell_with(1, 1, 1)
    assert not first.unstable
    assert cell_with(1, 1, 1).digest == first.digest
    for other in ((2, 1, 1), (1, 2, 1), (1, 1, 2)):
        assert cell_with(*other).digest != first.digest


@pytest.mark.parametrize(
    "text",
    [
        "from typing import NamedTuple\nclass Shape(NamedTuple):\n sides: int = {}",
        "from collections import namedtuple\nShape = namedtuple('Shape', 'sides', defaults=[{}])",
        "from enum import Enum\nclass Shape(Enum):\n SIDES = {}",
        "from dataclasses import *\n@dataclass(slots=True)\nclass Shape:\n s: int = {}",
        "class Base:\n sides = {}\nclass Shape(Base): pass",
        "from nodegraph import Value\nclass Shape(Value):\n sides = {}",
    ],
)
def test_kinds_of_classes_of_a_cell(text: str) -> None:
    def cell_with(number: int) -> Reached:
        whole = text.format(number) + "\ndef fill(x: int) -> Shape: return Shape(x)"
        return of(in_cell(whole, "<cell 1>")["fill"])

    assert not cell_with(1).unstable
    assert cell_with(1).digest == cell_with(1).digest
    assert cell_with(1).digest != cell_with(2).digest


def test_one_function_is_looked_at_once() -> None:
    function = over(1)
    assert of(function) is of(function)
    assert of(over(1)) is not of(function)
