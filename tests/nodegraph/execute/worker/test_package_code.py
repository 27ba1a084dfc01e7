from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from nodegraph.execute.worker.protocol import code_of, reached

Make = Callable[..., None]


@pytest.fixture
def make(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Make:
    """Write a package of two modules, or one module, and import it."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def write(name: str, text: str, *, helper: str = "") -> None:
        file = tmp_path / f"{name}.py"
        if helper:
            (tmp_path / name).mkdir(exist_ok=True)
            file = tmp_path / name / "__init__.py"
            (tmp_path / name / "helper.py").write_text(helper)
        file.write_text(text)
        if name not in sys.modules:
            monkeypatch.setitem(sys.modules, name, __import__(name))

    return write


def test_an_edit_of_any_file_changes_the_code_of_its_package_alone(make: Make) -> None:
    make("code_a", "x = 1", helper="y = 1")
    make("code_b", "x = 1")
    before = code_of(["code_a", "code_b"])
    make("code_a", "x = 1", helper="y = 2")
    after = code_of(["code_a", "code_b"])
    assert after["code_a"] != before["code_a"]
    assert after["code_b"] == before["code_b"]


def test_the_same_files_have_the_same_code_wherever_they_lie(
    make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make("code_c", "x = 1", helper="y = 1")
    before = code_of(["code_c"])
    (tmp_path / "code_c").rename(tmp_path / "moved")
    monkeypatch.setattr(sys.modules["code_c"], "__path__", [str(tmp_path / "moved")])
    assert code_of(["code_c"]) == before


def test_what_a_package_imports_is_reached_through_others(make: Make) -> None:
    make("code_d", "x = 1")
    make("code_e", "def late():\n    from code_d import x\n    return x")
    make("code_f", "import code_e")
    make("code_g", "x = 1")
    code = code_of(["code_d", "code_e", "code_f", "code_g"])
    assert reached("code_f", code) == {"code_f", "code_e", "code_d"}
    assert reached("code_g", code) == {"code_g"}
    assert reached("unknown", code) == set()


def test_what_has_no_source_has_no_code() -> None:
    assert code_of(["sys", "no_such_module"]) == {}
