"""Names are followed from module to module, wherever they come from."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

from nodegraph.fingerprint import Code

from .conftest import Folder

ONE, TWO = "def walk(x): return 1", "def walk(x): return 2"


@pytest.mark.parametrize(
    ("taken", "used"),
    [
        ("from pack.inner import walk", "walk"),
        ("from pack.inner import walk as step", "step"),
        ("from pack import inner", "inner.walk"),
        ("import pack.inner", "pack.inner.walk"),
        ("import pack.inner as deep", "deep.walk"),
        ("from pack import walk", "walk"),
        ("import pack", "pack.walk"),
        ("from pack import *", "walk"),
        ("from pack.inner import *", "walk"),
        ("from pack.again import handed", "handed"),
        ("from pack.again import inner", "inner.walk"),
        ("import pack.again as again", "again.table['walk']"),
    ],
)
@pytest.mark.parametrize("local", [False, True], ids=["at the top", "in the function"])
def test_ways_to_import(folder: Folder, taken: str, used: str, local: bool) -> None:
    if local and "*" in taken:
        taken = "from pack import walk"
    inside, top = (taken, "") if local else ("pass", taken)
    folder.write(
        {
            "pack/__init__.py": "from .inner import walk",
            "pack/inner.py": f"{ONE}\ndef other(): return 1",
            "pack/again.py": (
                "from . import inner\nfrom .inner import walk as handed\ntable = {'walk': handed}"
            ),
            "fills.py": f"{top}\ndef fill(x):\n    {inside}\n    return {used}(x)",
        }
    )
    edit = {"pack/inner.py": f"{ONE}\ndef other(): return 2"}
    assert not folder.changes("fills:fill", edit)
    assert folder.changes("fills:fill", {"pack/inner.py": TWO}) == {"pack.inner:walk"}


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
    assert changed == {"pack.one:walk", "pack.two:walk"}


def test_a_module_passed_as_a_value_is_reached_whole(folder: Folder) -> None:
    folder.write(
        {
            "tools.py": f"{ONE}\nLIMIT = 1",
            "fills.py": "import tools\ndef fill(x): return getattr(tools, x)",
        }
    )
    assert set(folder.reached("fills:fill").units) == {"fills:fill", "tools:LIMIT", "tools:walk"}


def test_names_that_a_module_makes_late(folder: Folder) -> None:
    folder.write(
        {
            "pack/__init__.py": "def __getattr__(name): return 1",
            "fills.py": "import pack\ndef fill(x): return pack.late",
        }
    )
    edit = {"pack/__init__.py": "def __getattr__(name): return 2"}
    assert folder.changes("fills:fill", edit) == {"pack:__getattr__"}


def test_modules_that_import_each_other(folder: Folder) -> None:
    folder.write(
        {
            "one.py": "import two\ndef fill(x): return two.walk(x)\ndef end(): return 1",
            "two.py": "import one\ndef walk(x): return one.end() or one.fill(x)\ndef back(): pass",
        }
    )
    assert set(folder.reached("one:fill").units) == {"one:end", "one:fill", "two:walk"}


def test_a_local_name_hides_a_helper(folder: Folder) -> None:
    text = "def walk(): return {}\ndef fill(walk): return walk() + [walk for walk in ()][0]"
    folder.write({"fills.py": text.format(1)})
    assert not folder.changes("fills:fill", {"fills.py": text.format(2)})


def test_a_builtin_is_hidden_by_a_helper(folder: Folder) -> None:
    text = "def fill(x): return sum(x)\ndef sum(x): return {}"
    folder.write({"fills.py": text.format(1)})
    assert folder.changes("fills:fill", {"fills.py": text.format(2)}) == {"fills:sum"}


def test_a_builtin_is_hidden_by_a_star(folder: Folder) -> None:
    folder.write(
        {
            "tools.py": "def sum(x): return 1",
            "fills.py": "from tools import *\ndef fill(x): return sum(x)",
        }
    )
    edit = {"tools.py": "def sum(x): return 2"}
    assert folder.changes("fills:fill", edit) == {"tools:sum"}


def test_a_chain_of_functions_longer_than_the_stack(folder: Folder) -> None:
    chain = "\n".join(f"def f{number}(): return f{number + 1}()" for number in range(2000))
    folder.write({"fills.py": f"{chain}\ndef f2000(): return 1"})
    reached = folder.reached("fills:f0")
    assert len(reached.units) == 2001
    assert not reached.unstable


def test_a_single_file_is_named_after_itself(folder: Folder, tmp_path: Path) -> None:
    elsewhere = tmp_path / "not a package"
    folder.write({"not a package/mine.py": "LIMIT = 1\ndef fill(x): return x + LIMIT"})
    spec = importlib.util.spec_from_file_location("mine", elsewhere / "mine.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    reached = Code([]).of(module.fill)
    assert set(reached.units) == {"mine:LIMIT", "mine:fill"}
    assert str(tmp_path) not in repr(reached)


def test_a_script_reaches_what_the_module_reaches(folder: Folder) -> None:
    text = """
        class A:
            pass
        def fill(x=A):
            return A
        if __name__ == "__main__":
            from nodegraph.fingerprint import Code
            print(Code([]).of(fill).digest)
    """
    folder.write({"mine.py": text})
    file = str(folder.path / "mine.py")
    done = subprocess.run([sys.executable, file], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == folder.reached("mine:fill").digest


def test_nothing_is_imported(folder: Folder) -> None:
    folder.write(
        {
            "never.py": "raise SystemError('imported')\ndef walk(): pass",
            "fills.py": "def fill():\n    import sympy\n    from never import walk\n    walk()",
        }
    )
    function = folder.function("fills:fill")
    before = set(sys.modules)
    reached = Code([]).of(function)
    assert "never:walk" in reached.units
    assert {
        name for name in set(sys.modules) - before if not name.startswith("nodegraph.")
    } == set()


def test_a_file_that_is_not_python(folder: Folder) -> None:
    folder.write({"tools.py": ONE, "fills.py": "import tools\ndef fill(x): return tools.walk(x)"})
    function = folder.function("fills:fill")
    folder.write({"tools.py": "x = 1\ndef walk(:"})
    assert Code([]).of(function).unstable.startswith("tools: line 2 is not Python: ")
    folder.write({"tools.py": "x = '\0'"})
    assert Code([]).of(function).unstable.startswith("tools: ")
    folder.write({"fills.py": "def fill(:"})
    assert "fills: line 1" in Code([]).of(function).unstable


def test_a_file_that_has_vanished(folder: Folder) -> None:
    folder.write({"tools.py": ONE, "fills.py": "import tools\ndef fill(x): return tools.walk(x)"})
    function = folder.function("fills:fill")
    (folder.path / "tools.py").unlink()
    assert "tools: its file cannot be read" in Code([]).of(function).unstable
    (folder.path / "fills.py").unlink()
    assert "fills:fill has no source" in Code([]).of(function).unstable


def test_a_function_that_its_file_no_longer_has(folder: Folder) -> None:
    folder.write({"fills.py": "def fill(x): return x"})
    function = folder.function("fills:fill")
    folder.write({"fills.py": ""})
    assert "edited after it was imported" in Code([]).of(function).unstable


def test_functions_of_one_name_are_distinguished_by_their_lines(folder: Folder) -> None:
    text = "def fill(x): return {}\nfirst = fill\ndef fill(x): return {}\nsecond = fill"
    folder.write({"fills.py": text.format(1, 2)})
    first, second = folder.reached("fills:first"), folder.reached("fills:second")
    assert first.digest != second.digest
    folder.write({"fills.py": text.format(1, 3)})
    assert folder.reached("fills:first").digest == first.digest
    assert folder.reached("fills:second").digest != second.digest


def test_a_compiled_module_counts_by_its_content(folder: Folder) -> None:
    suffix = importlib.machinery.EXTENSION_SUFFIXES[0]
    folder.write(
        {
            f"fast{suffix}": "machine code",
            "fills.py": "def fill(x):\n    import fast\n    return fast.walk(x)",
        }
    )
    changed = folder.changes("fills:fill", {f"fast{suffix}": "other code"})
    assert changed == {"fast:<compiled>"}
