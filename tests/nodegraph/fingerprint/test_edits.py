"""An edit that can change a result is noticed and named; a cosmetic one is not."""

from __future__ import annotations

import textwrap

import numpy as np
import pytest

from .conftest import Folder

FILL = """
    from nodegraph import node
    import numpy as np
    from tools import shapes
    from tools.walk import walk as step

    LIMIT = 3
    WEIGHTS = {"mean": 1}

    @node("fill.made", cite="someone")
    def fill(recording: shapes.Shape, *, width: int = 2) -> float:
        return near(recording) + step(width) + LIMIT

    def near(recording):
        return np.linalg.norm(recording)

    def unrelated(recording):
        return recording * 2
"""
FILES = {
    "tools/__init__.py": "",
    "tools/fill.py": FILL,
    "tools/shapes.py": '''
        """Shapes."""

        class Base:
            def area(self):
                return 1

        class Shape(Base):
            """A shape."""

            sides = 4

            def area(self):
                """Its area."""
                return self.sides * FACTOR

        FACTOR = 2
        OTHER = 3
    ''',
    "tools/walk.py": """
        from functools import cache

        def walk(width):
            return stride(width)

        def stride(width):
            return width / 2
    """,
}


@pytest.fixture
def tools(folder: Folder) -> Folder:
    folder.write(FILES)
    return folder


def edited(file: str, old: str, new: str) -> dict[str, str]:
    before = textwrap.dedent(FILES[file])
    assert old in before
    return {file: before.replace(old, new)}


def test_the_units_of_a_node(tools: Folder) -> None:
    reached = tools.reached("tools.fill:fill")
    assert set(reached.units) == {
        "tools.fill:LIMIT",
        "tools.fill:fill",
        "tools.fill:near",
        "tools.shapes:Base",
        "tools.shapes:FACTOR",
        "tools.shapes:Shape",
        "tools.walk:stride",
        "tools.walk:walk",
    }
    assert set(reached.versions) == {"python", "numpy"}
    assert all(len(digest) == 16 for digest in reached.units.values())
    assert not reached.unstable


@pytest.mark.parametrize(
    ("file", "old", "new", "changed"),
    [
        ("tools/fill.py", "norm(recording)", "norm(recording) + 1", "tools.fill:near"),
        ("tools/fill.py", "LIMIT = 3", "LIMIT = 4", "tools.fill:LIMIT"),
        ("tools/fill.py", "LIMIT = 3", "LIMIT = True", "tools.fill:LIMIT"),
        ("tools/fill.py", "LIMIT = 3", "LIMIT = 3\nLIMIT += 1", "tools.fill:LIMIT"),
        ("tools/fill.py", "width: int = 2", "width: int = 3", "tools.fill:fill"),
        ("tools/fill.py", "def near", "@staticmethod\ndef near", "tools.fill:near"),
        ("tools/shapes.py", "sides = 4", "sides = 5", "tools.shapes:Shape"),
        ("tools/shapes.py", "self.sides *", "self.sides +", "tools.shapes:Shape"),
        ("tools/shapes.py", "return 1", "return 2", "tools.shapes:Base"),
        ("tools/shapes.py", "FACTOR = 2", "FACTOR = 2.0", "tools.shapes:FACTOR"),
        ("tools/walk.py", "stride(width)\n\n", "-stride(width)\n\n", "tools.walk:walk"),
        ("tools/walk.py", "width / 2", "width // 2", "tools.walk:stride"),
        ("tools/walk.py", "def stride", "@cache\ndef stride", "tools.walk:stride"),
    ],
)
def test_an_edit_is_named(tools: Folder, file: str, old: str, new: str, changed: str) -> None:
    assert tools.changes("tools.fill:fill", edited(file, old, new)) == {changed}


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("tools/fill.py", "LIMIT = 3", "# why\nLIMIT = 3  # of them\n\n\n"),
        ("tools/fill.py", "LIMIT = 3", 'LIMIT = (\n    3\n)\n"""How many."""'),
        ("tools/fill.py", 'cite="someone"', 'cite=("someone", "other")'),
        ("tools/fill.py", "recording * 2", "recording * 3"),
        ("tools/fill.py", "def unrelated", "def renamed"),
        ("tools/fill.py", '{"mean": 1}', '{"mean": 2}'),
        ("tools/fill.py", "LIMIT = 3", '__all__ = ["fill"]\n__all__ += ["near"]\nLIMIT = 3'),
        ("tools/fill.py", "LIMIT = 3", 'LIMIT = 3\nif __name__ == "__main__":\n    print(fill(1))'),
        ("tools/fill.py", "import numpy", "from os import path\nimport numpy"),
        ("tools/shapes.py", '"""A shape."""', '"""Another."""'),
        ("tools/shapes.py", '"""Its area."""\n        ', ""),
        ("tools/shapes.py", '"""Shapes."""', ""),
        ("tools/shapes.py", "OTHER = 3", "OTHER = 4"),
        ("tools/shapes.py", "return 1", "return (\n            1\n        )"),
    ],
)
def test_a_cosmetic_edit_changes_nothing(tools: Folder, file: str, old: str, new: str) -> None:
    assert not tools.changes("tools.fill:fill", edited(file, old, new))


def test_the_order_of_functions_does_not_count(tools: Folder) -> None:
    head, near, unrelated = textwrap.dedent(FILL).partition("def near")
    node = head.index("@node")
    moved = head[:node] + near + unrelated + "\n" + head[node:]
    assert not tools.changes("tools.fill:fill", {"tools/fill.py": moved})


def test_another_base_class(tools: Folder) -> None:
    edit = edited("tools/shapes.py", "Shape(Base)", "Shape")
    assert tools.changes("tools.fill:fill", edit) == {"tools.shapes:Base", "tools.shapes:Shape"}


def test_a_decorator_is_followed(tools: Folder) -> None:
    edit = edited(
        "tools/walk.py", "def stride", "def twice(f):\n    return f\n\n@twice\ndef stride"
    )
    changed = {"tools.walk:stride", "tools.walk:twice"}
    assert tools.changes("tools.fill:fill", edit) == changed


def test_the_name_of_a_node_and_what_it_cites_lead_nowhere(folder: Folder) -> None:
    folder.write(
        {
            "cited.py": "KEYS = ('a',)",
            "fills.py": """
                import nodegraph as ng
                from cited import KEYS

                def make(name):
                    @ng.node(name, cite=KEYS)
                    def inner(x: int) -> int:
                        return x
                    return inner

                @ng.node("fill.cited", cite=KEYS)
                def fill(x: int) -> int:
                    return x

                made = make("fill.other")
            """,
        }
    )
    assert set(folder.reached("fills:fill").units) == {"fills:fill"}
    assert not folder.changes("fills:made", {"cited.py": "KEYS = ('b',)"})


def test_statements_that_act_belong_to_every_unit(folder: Folder) -> None:
    text = """
        import numpy as np

        TABLE = {}
        def fill(x):
            return TABLE[x]

        np.seterr(all="ignore")
        for key in (1, 2):
            TABLE[key] = key
    """
    folder.write({"fills.py": text})
    for old, new, changed in [
        ("ignore", "warn", {"fills:<statements>"}),
        ("(1, 2)", "(1, 3)", {"fills:<statements>", "fills:key"}),
    ]:
        folder.write({"fills.py": text})
        edit = {"fills.py": textwrap.dedent(text).replace(old, new)}
        with np.errstate():  # which the module sets for everybody when it is imported
            assert folder.changes("fills:fill", edit) == changed


def test_statements_of_a_package_belong_to_its_modules(folder: Folder) -> None:
    folder.write({"pack/__init__.py": "print", "pack/inner.py": "def fill(): return 1"})
    assert folder.changes("pack.inner:fill", {"pack/__init__.py": "print()"}) == {
        "pack:<statements>"
    }


def test_a_compound_statement_is_one_unit(folder: Folder) -> None:
    text = """
        try:
            from missing_module_of_nobody import root
        except ImportError:
            def root(x):
                return x + 1
            def other():
                return 2

        def fill(x):
            return root(x)
    """
    folder.write({"fills.py": text})
    assert set(folder.reached("fills:fill").units) == {"fills:fill", "fills:root"}
    assert folder.reached("fills:fill").versions["missing_module_of_nobody"] == "unknown"
    edit = {"fills.py": textwrap.dedent(text).replace("x + 1", "x + 2")}
    assert folder.changes("fills:fill", edit) == {"fills:root"}


def test_functions_that_a_table_holds_by_decorator(folder: Folder) -> None:
    text = """
        RULES = {}

        def rule(name):
            def enter(function):
                RULES[name] = function
                return function
            return enter

        @rule("mean")
        def _mean(x):
            return x

        def fill(x):
            return RULES["mean"](x)
    """
    folder.write({"fills.py": text})
    edit = {
        "fills.py": textwrap.dedent(text).replace(
            "    return x\n\ndef fill", "    return -x\n\ndef fill"
        )
    }
    assert folder.changes("fills:fill", edit) == {"fills:_mean"}


def test_functions_that_another_function_dispatches_to(folder: Folder) -> None:
    text = """
        from functools import singledispatch

        @singledispatch
        def fill(x):
            return 0

        @fill.register
        def _(x: int):
            return 1
    """
    folder.write({"fills.py": text})
    edit = {"fills.py": textwrap.dedent(text).replace("return 1", "return 2")}
    assert folder.changes("fills:fill", edit) == {"fills:_"}


def test_a_module_imported_for_what_it_does(folder: Folder) -> None:
    folder.write({"fills.py": "import patches\ndef fill(x): return x", "patches.py": "A = 1"})
    assert folder.changes("fills:fill", {"patches.py": "A = 2"}) == {"patches:A"}


def test_imports_for_a_type_checker_are_no_unit(folder: Folder) -> None:
    text = """
        from typing import TYPE_CHECKING
        if TYPE_CHECKING:
            from shapes import Shape
        def fill(x: Shape): return x
    """
    folder.write({"fills.py": "from __future__ import annotations\n" + textwrap.dedent(text)})
    folder.write({"shapes.py": "class Shape: pass\nclass Other: pass"})
    assert set(folder.reached("fills:fill").units) == {"fills:fill", "shapes:Shape"}
    more = textwrap.dedent(text).replace("Shape\ndef", "Other, Shape\ndef")
    edit = {"fills.py": "from __future__ import annotations\n" + more}
    assert not folder.changes("fills:fill", edit)
