"""An edit of a module that a function imports, directly or not, is noticed and named; no other."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import textwrap
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

import pytest

from nodegraph.cache_key import Code

from .conftest import Folder

FILES = {
    "tools/__init__.py": '"""Tools."""\nfrom tools.other import unused',
    "tools/other.py": "def unused(): return 1",
    "tools/fill.py": """
        from nodegraph import node
        import numpy as np
        from tools import shapes
        from tools.walk import walk as step

        LIMIT = 3

        @node("fill.made", cite="someone")
        def fill(recording: shapes.Shape, *, width: int = 2) -> float:
            return np.linalg.norm(recording) + step(width) + LIMIT
    """,
    "tools/shapes.py": '''
        """Shapes."""

        class Shape:
            """A shape."""

            sides = 4

            def area(self):
                """Its area."""
                return self.sides
    ''',
    "tools/walk.py": """
        def walk(width):
            from .stride import stride
            return stride(width)
    """,
    "tools/stride.py": "def stride(width):\n    return width / 2",
}
ONE, TWO = "def walk(x): return 1", "def walk(x): return 2"


@pytest.fixture
def tools(folder: Folder) -> Folder:
    folder.write(FILES)
    return folder


def edited(file: str, old: str, new: str) -> dict[str, str]:
    before = textwrap.dedent(FILES[file])
    assert old in before
    return {file: before.replace(old, new)}


def test_the_code_of_a_node(tools: Folder) -> None:
    reached = tools.reached("tools.fill:fill")
    machine = {name for name in reached.units if name.startswith("nodegraph.")}
    assert "nodegraph.node.decorator" in machine
    assert set(reached.units) - machine == {
        "tools.fill",
        "tools.shapes",
        "tools.stride",
        "tools.walk",
    }
    assert {"python", "numpy"} <= set(reached.versions)
    assert all(len(digest) == 16 for digest in reached.units.values())
    assert not reached.unstable


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("tools/fill.py", "LIMIT = 3", "LIMIT = 4"),
        ("tools/fill.py", "LIMIT = 3", "LIMIT = True"),
        ("tools/fill.py", "width: int = 2", "width: int = 3"),
        ("tools/shapes.py", "sides = 4", "sides = 5"),
        ("tools/shapes.py", "return self", "return -self"),
        ("tools/walk.py", "stride(width)", "-stride(width)"),
        ("tools/stride.py", "width / 2", "width // 2"),
    ],
)
def test_an_edit_is_named(tools: Folder, file: str, old: str, new: str) -> None:
    changed = file.removesuffix(".py").replace("/", ".")
    assert tools.changes("tools.fill:fill", edited(file, old, new)) == {changed}


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("tools/fill.py", "LIMIT = 3", "# why\nLIMIT = 3  # of them\n\n\n"),
        ("tools/fill.py", "LIMIT = 3", 'LIMIT = (\n    3\n)\n"""How many."""'),
        ("tools/shapes.py", '"""A shape."""', '"""Another."""'),
        ("tools/shapes.py", '"""Its area."""\n        ', ""),
        ("tools/shapes.py", '"""Shapes."""', ""),
        ("tools/other.py", "return 1", "return 2"),
        ("tools/__init__.py", "unused", "unused as other"),
        ("tools/__init__.py", "from tools.other", "LIMIT = 1\nfrom tools.other"),
    ],
)
def test_other_edits_change_nothing(tools: Folder, file: str, old: str, new: str) -> None:
    assert not tools.changes("tools.fill:fill", edited(file, old, new))


@pytest.mark.parametrize(
    ("taken", "used"),
    [
        ("from pack.inner import walk", "walk"),
        ("from pack.inner import walk as step", "step"),
        ("from pack import inner", "inner.walk"),
        ("import pack.inner as deep", "deep.walk"),
        ("from pack import walk", "walk"),
        ("from pack.inner import *", "walk"),
        ("from pack.again import handed", "handed"),
        ("from pack.again import inner", "inner.walk"),
        ("import pack.again as again", "again.table['walk']"),
        ("from importlib import import_module", "import_module('pack.inner').walk"),
    ],
)
@pytest.mark.parametrize("local", [False, True], ids=["at the top", "in the function"])
def test_ways_to_import(folder: Folder, taken: str, used: str, local: bool) -> None:
    if local and "*" in taken:
        taken = "from pack import walk"
    inside, top = (taken, "") if local else ("pass", taken)
    folder.write(
        {
            "pack/__init__.py": "from .inner import walk\nfrom .sibling import other",
            "pack/inner.py": ONE,
            "pack/sibling.py": "def other(): return 1",
            "pack/again.py": (
                "from . import inner\nfrom .inner import walk as handed\ntable = {'walk': handed}"
            ),
            "fills.py": f"{top}\ndef fill(x):\n    {inside}\n    return {used}(x)",
        }
    )
    assert not folder.changes("fills:fill", {"pack/sibling.py": "def other(): return 2"})
    assert folder.changes("fills:fill", {"pack/inner.py": TWO}) == {"pack.inner"}


@pytest.mark.parametrize("used", ["from pack import *", "import pack", "import pack.inner"])
def test_of_a_package_that_is_imported_as_a_whole_everything_counts(
    folder: Folder, used: str
) -> None:
    folder.write(
        {
            "pack/__init__.py": "from .inner import walk",
            "pack/inner.py": ONE,
            "fills.py": f"{used}\ndef fill(x): return x",
        }
    )
    assert folder.changes("fills:fill", {"pack/inner.py": TWO}) == {"pack.inner"}
    edit = {"pack/__init__.py": "from .inner import walk\nLIMIT = 1"}
    assert folder.changes("fills:fill", edit) == {"pack"}


@pytest.mark.parametrize(
    "listing",
    [
        "from .one import one\nfrom .two import two",
        "from . import one, two\nNODES = (one.one, two.two)",
        "def nodegraph_nodes():\n    from .one import one\n    from .two import two\n    return 1",
        "__all__ = ['one']\n__all__ += ['two']\nfrom .two import *\nfrom .one import *",
        "if True:\n    from .one import one\n    from .two import two",
    ],
)
def test_a_node_does_not_depend_on_those_that_its_package_lists(
    folder: Folder, listing: str
) -> None:
    folder.write(
        {
            "pack/__init__.py": listing,
            "pack/one.py": "from .help import walk\ndef one(): return walk(1)",
            "pack/two.py": "def two(): return 1",
            "pack/help.py": ONE,
        }
    )
    assert not folder.changes("pack.one:one", {"pack/two.py": "def two(): return 2"})
    assert folder.changes("pack.one:one", {"pack/help.py": TWO}) == {"pack.help"}


@pytest.mark.parametrize(
    "act",
    [
        "print(two)",
        "TABLE = {}\nTABLE['two'] = two",
        "two.seen = True",
        "del two",
        "if True:\n    print()",
        "import pack.two",
    ],
)
def test_what_a_package_does_when_it_is_imported_counts(folder: Folder, act: str) -> None:
    folder.write(
        {
            "pack/__init__.py": f"from .two import two\n{act}",
            "pack/one.py": "def one(): return 1",
            "pack/two.py": "def two(): return 1",
        }
    )
    assert folder.changes("pack.one:one", {"pack/two.py": "def two(): return 2"}) == {"pack.two"}


@pytest.mark.parametrize(
    "binding",
    [
        "def walk(x): return other(x)",
        "walk = other",
        "try:\n    from pack.inner import walk\nexcept ImportError:\n    def walk(x): return other",
        "def __getattr__(name): return other",
        "for walk in (other,):\n    pass",
    ],
)
def test_a_name_that_a_package_makes_depends_on_all_that_it_imports(
    folder: Folder, binding: str
) -> None:
    folder.write(
        {
            "pack/__init__.py": f"from .others import other\n{binding}",
            "pack/others.py": "def other(x): return 1",
            "pack/inner.py": ONE,
            "fills.py": "from pack import walk\ndef fill(x): return walk(x)",
        }
    )
    edit = {"pack/others.py": "def other(x): return 2"}
    assert folder.changes("fills:fill", edit) == {"pack.others"}
    assert "pack" in folder.reached("fills:fill").units


def test_the_target_of_a_re_export(folder: Folder) -> None:
    folder.write(
        {
            "pack/__init__.py": "from pack.one import walk",
            "pack/one.py": ONE,
            "pack/two.py": ONE,
            "fills.py": "from pack import walk\ndef fill(x): return walk(x)",
        }
    )
    changed = folder.changes("fills:fill", {"pack/__init__.py": "from pack.two import walk"})
    assert changed == {"pack.one", "pack.two"}


def test_both_sources_of_a_name_count(folder: Folder) -> None:
    folder.write(
        {
            "pack/__init__.py": (
                "try:\n    from .fast import walk\nexcept ImportError:\n    from .slow import walk"
            ),
            "pack/slow.py": ONE,
            "fills.py": "from pack import walk\ndef fill(x): return walk(x)",
        }
    )
    assert folder.changes("fills:fill", {"pack/slow.py": TWO}) == {"pack.slow"}
    assert folder.changes("fills:fill", {"pack/fast.py": ONE}) == {"pack.fast"}


def test_names_that_a_package_imports_late_are_found_by_its_imports_for_types(
    folder: Folder,
) -> None:
    folder.write(
        {
            "pack/__init__.py": """
                from importlib import import_module
                from typing import TYPE_CHECKING
                if TYPE_CHECKING:
                    from .inner import walk
                    from .sibling import other

                MODULES = {"walk": "pack.inner"}
                def __getattr__(name): return getattr(import_module(MODULES[name]), name)
            """,
            "pack/inner.py": ONE,
            "pack/sibling.py": "other = 1",
            "fills.py": "from pack import walk\ndef fill(x): return walk(x)",
        }
    )
    assert not folder.changes("fills:fill", {"pack/sibling.py": "other = 2"})
    assert folder.changes("fills:fill", {"pack/inner.py": TWO}) == {"pack.inner"}


@pytest.mark.parametrize(
    "load", ["import_module(x)", "import_module('.deep', 'pack')", "spec_from_file_location(x)"]
)
def test_a_computed_import_reaches_all_modules_of_its_package(folder: Folder, load: str) -> None:
    folder.write(
        {
            "pack/__init__.py": "",
            "pack/fills.py": f"from importlib import *\ndef fill(x): return {load}",
            "pack/inner/__init__.py": ONE,
            "pack/inner/deep.py": ONE,
        }
    )
    assert folder.changes("pack.fills:fill", {"pack/inner/deep.py": TWO}) == {"pack.inner.deep"}
    assert folder.changes("pack.fills:fill", {"pack/inner/__init__.py": TWO}) == {"pack.inner"}


def test_a_computed_import_outside_of_packages_makes_code_unstable(folder: Folder) -> None:
    folder.write({"fills.py": "def fill(x):\n    return __import__(x)"})
    assert folder.reached("fills:fill").unstable == (
        "fills imports a module whose name is known only when it runs"
    )


def test_imports_for_a_type_checker_do_not_count(folder: Folder) -> None:
    folder.write(
        {
            "fills.py": """
                from __future__ import annotations
                import typing
                if typing.TYPE_CHECKING:
                    from shapes import Shape
                def fill(x: Shape): return x
            """,
            "shapes.py": "class Shape: pass",
        }
    )
    assert set(folder.reached("fills:fill").units) == {"fills"}


def test_a_module_imported_for_what_it_does(folder: Folder) -> None:
    folder.write({"fills.py": "import patches\ndef fill(x): return x", "patches.py": "A = 1"})
    assert folder.changes("fills:fill", {"patches.py": "A = 2"}) == {"patches"}


def test_modules_that_import_each_other(folder: Folder) -> None:
    folder.write(
        {
            "one.py": "import two\ndef fill(x): return two.walk(x)",
            "two.py": "import one\ndef walk(x): return one.fill(x)",
        }
    )
    assert set(folder.reached("one:fill").units) == {"one", "two"}


def test_a_folder_without_a_file_of_its_own_is_a_package(folder: Folder) -> None:
    folder.write(
        {
            "space/deep/one.py": ONE,
            "fills.py": "def fill(x):\n    from space.deep import one\n    return one.walk(x)",
        }
    )
    assert folder.changes("fills:fill", {"space/deep/one.py": TWO}) == {"space.deep.one"}


def test_a_sum_deeper_than_the_stack(folder: Folder) -> None:
    text = "def fill(x): return " + " + ".join(["x"] * 1000)
    folder.write({"fills.py": text})
    assert folder.changes("fills:fill", {"fills.py": f"{text} + x"}) == {"fills"}


def test_a_single_file_is_named_after_itself(folder: Folder, tmp_path: Path) -> None:
    folder.write({"not a package/mine.py": "LIMIT = 1\ndef fill(x): return x + LIMIT"})
    spec = importlib.util.spec_from_file_location("mine", tmp_path / "not a package" / "mine.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    reached = Code([]).of(module.fill)
    assert set(reached.units) == {"mine", "mine:fill"}
    assert str(tmp_path) not in repr(reached)


def test_files_of_one_name_are_told_apart(folder: Folder) -> None:
    code, digests = Code([]), []
    for number in (1, 2, 1):
        folder.write({f"{number}/mine.py": f"LIMIT = {number}\ndef fill(x): return x"})
        spec = importlib.util.spec_from_file_location("mine", folder.path / f"{number}" / "mine.py")
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        digests.append(list(code.of(module.fill).units.values()))
    assert digests[0] == digests[2] != digests[1]


def test_a_script_reaches_what_the_module_reaches(folder: Folder) -> None:
    text = """
        import helper
        def fill(x):
            return helper.walk(x)
        if __name__ == "__main__":
            from nodegraph.cache_key import Code
            print(sorted(Code([]).of(fill).units))
    """
    folder.write({"mine.py": text, "helper.py": ONE})
    file = str(folder.path / "mine.py")
    done = subprocess.run([sys.executable, file], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("['__main__:fill', 'helper', 'mine', ")


def test_nothing_is_imported(folder: Folder) -> None:
    folder.write(
        {
            "never/__init__.py": "raise SystemError('imported')",
            "never/inner.py": ONE,
            "fills.py": "def fill():\n    import sympy.core\n    from never.inner import walk",
        }
    )
    function = folder.function("fills:fill")
    before = set(sys.modules)
    assert "never.inner" in Code([]).of(function).units
    new = set(sys.modules) - before
    assert {name for name in new if not name.startswith("nodegraph.")} == set()


@pytest.mark.parametrize(
    "wrong", ["x = 1\ndef walk(:", "x = '\0'", "x = 'ab\\q'\n", f"x = 0x{'f' * 9999}"]
)
def test_a_file_that_is_not_quite_python_counts(folder: Folder, wrong: str) -> None:
    folder.write({"tools.py": ONE, "fills.py": "def fill(x):\n    import tools"})
    assert folder.changes("fills:fill", {"tools.py": wrong}) == {"tools"}
    assert folder.changes("fills:fill", {"tools.py": f"y = 1\n{wrong}"}) == {"tools"}


def test_a_file_that_has_vanished(folder: Folder) -> None:
    folder.write({"tools.py": ONE, "fills.py": "import tools\ndef fill(x): return tools.walk(x)"})
    function = folder.function("fills:fill")
    (folder.path / "tools.py").unlink()
    assert "tools: its file cannot be read" in Code([]).of(function).unstable


def test_a_compiled_module_counts_by_its_content(folder: Folder) -> None:
    name = f"fast{EXTENSION_SUFFIXES[0]}"
    folder.write(
        {name: "machine code", "fills.py": "def fill(x):\n    import fast\n    return fast.walk(x)"}
    )
    assert folder.changes("fills:fill", {name: "other code"}) == {"fast"}
