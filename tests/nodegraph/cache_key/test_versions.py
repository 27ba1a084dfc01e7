"""Of what was installed the version counts, unless it came with a plugin."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from nodegraph.cache_key import Code

from .conftest import Folder

PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Folder]:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    path = tmp_path / "lib" / "site-packages"
    path.mkdir(parents=True)
    monkeypatch.syspath_prepend(path)
    folder = Folder(path)
    folder.forget()
    yield folder
    folder.forget()


def distribution(name: str, version: str, *files: str) -> dict[str, str]:
    folder = f"{name.replace('-', '_')}-{version}.dist-info"
    about = f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n\ntext"
    return {
        f"{folder}/METADATA": about,
        f"{folder}/RECORD": "\n".join(f"{file},," for file in files),
    }


def fill_with(folder: Folder, module: str) -> None:
    folder.write({"fills.py": f"def fill(x):\n    import {module}\n    return {module}.walk(x)"})


def test_the_version_counts_and_not_the_code(folder: Folder, installed: Folder) -> None:
    fill_with(folder, "heavy")
    installed.write({"heavy/__init__.py": "def walk(x): return 1"})
    installed.write(distribution("heavy", "1.2", "heavy/__init__.py"))
    before = folder.reached("fills:fill")
    assert before.versions == {"heavy": "1.2", "python": PYTHON}
    assert not folder.changes("fills:fill", {"lib/site-packages/heavy/__init__.py": "walk = 2"})
    installed.write({"heavy-1.2.dist-info/METADATA": "Name: heavy\nVersion: 1.3\n"})
    after = folder.reached("fills:fill")
    assert after.versions["heavy"] == "1.3"
    assert after.digest != before.digest


def test_a_distribution_of_another_name(folder: Folder, installed: Folder) -> None:
    fill_with(folder, "heavy")
    installed.write({"heavy/__init__.py": ""})
    installed.write(distribution("Heavy.Lib", "1.2", "heavy/__init__.py"))
    installed.write(distribution("heavy", "0.0", "nothing.txt"))
    assert folder.reached("fills:fill").versions.get("Heavy.Lib") == "1.2"


def test_distributions_that_share_a_namespace(folder: Folder, installed: Folder) -> None:
    folder.write({"fills.py": "def fill(x):\n    from shared import one\n    return one.walk(x)"})
    installed.write({"shared/one.py": "", "shared/two.py": ""})
    installed.write(distribution("shared-one", "1", "shared/one.py"))
    installed.write(distribution("shared-two", "2", "shared/two.py"))
    versions = folder.reached("fills:fill").versions
    assert (versions["shared-one"], versions["shared-two"]) == ("1", "2")


def test_what_came_with_a_plugin_is_followed(folder: Folder, installed: Folder) -> None:
    installed.write(
        {
            "my_plugin.py": "from my_core import walk\ndef fill(x): return walk(x)",
            "my_core.py": "def walk(x): return 1",
            **distribution("mine", "1", "my_plugin.py", "my_core.py"),
        }
    )
    function = installed.function("my_plugin:fill")
    assert set(Code(["my_plugin"]).of(function).units) == {"my_plugin", "my_core"}
    by_version = Code([]).of(function)
    assert not by_version.units
    assert by_version.versions["mine"] == "1"


def test_a_file_that_nobody_installed_is_followed(folder: Folder, installed: Folder) -> None:
    fill_with(folder, "stray")
    installed.write({"stray.py": "def walk(x): return 1"})
    assert set(folder.reached("fills:fill").units) == {"fills", "stray"}


def test_a_module_that_is_not_there(folder: Folder) -> None:
    fill_with(folder, "nobody_has_this")
    assert folder.reached("fills:fill").versions["nobody_has_this"] == "unknown"


def test_a_module_that_hides_one_of_pythons(folder: Folder) -> None:
    fill_with(folder, "sndhdr")
    assert set(folder.reached("fills:fill").units) == {"fills"}
    folder.write({"sndhdr.py": "def walk(x): return 1"})
    assert set(folder.reached("fills:fill").units) == {"fills", "sndhdr"}


def test_what_was_found_is_looked_up_again(folder: Folder, installed: Folder) -> None:
    fill_with(folder, "heavy")
    installed.write({"heavy/__init__.py": ""})
    installed.write(distribution("heavy-lib", "1.2", "heavy/__init__.py"))
    function = folder.function("fills:fill")
    first = Code([])
    first.of(function)
    remembered = first.remembered()
    assert Code([], remembered).of(function) == first.of(function)
    installed.write(distribution("heavy-lib", "1.3", "heavy/__init__.py"))
    for file in (installed.path / "heavy_lib-1.2.dist-info").iterdir():
        file.unlink()
    assert Code([], remembered).of(function).versions["heavy-lib"] == "1.3"
