"""``new`` writes what a template holds, and overwrites nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph import hookimpl
from nodegraph.plugin import loading
from tests.nodegraph.cli.conftest import Command


@pytest.fixture(autouse=True)
def _templates(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """An installed plugin with a template of a package and one of a file."""
    folder = tmp_path / "shipped" / "pair"
    (folder / "{{name}}").mkdir(parents=True)
    (folder / "{{name}}" / "{{name}}.py.template").write_text("{{name}} = 1\n")
    (folder / "notes.md").write_text("of {{name}}, {other}\n")
    leaf = tmp_path / "shipped" / "leaf"
    leaf.mkdir()
    (leaf / "{{name}}.yaml.template").write_text("title: {{name}}\n")

    class Shipping:
        __name__ = "its_package"

        @staticmethod
        @hookimpl
        def nodegraph_templates() -> dict[str, Path]:
            return {"pair": folder, "leaf": leaf}

    monkeypatch.setattr(loading, "installed", lambda: ([loading.Plugin("ships", Shipping())], []))


def test_the_name_stands_in_texts_and_paths(command: Command) -> None:
    status, out, _ = command("new", "pair", "mine", "--to", "here")
    assert status == 0
    assert out.splitlines() == ["wrote here/notes.md", "wrote here/mine/mine.py"]
    assert Path("here/mine/mine.py").read_text() == "mine = 1\n"
    assert Path("here/notes.md").read_text() == "of mine, {other}\n"


def test_nothing_is_overwritten_and_nothing_written_by_halves(command: Command) -> None:
    Path("mine").mkdir()
    Path("mine/mine.py").write_text("precious")
    status, _, err = command("new", "pair", "mine")
    assert (status, "mine/mine.py already exists" in err) == (2, True)
    assert Path("mine/mine.py").read_text() == "precious"
    assert not Path("notes.md").exists()


@pytest.mark.parametrize(
    ("kind", "name", "reason"),
    [
        ("pear", "mine", "no template or study 'pear'; did you mean 'pair'"),
        ("pair", "Mine", "'Mine' cannot be the name of a package"),
        ("pair", "../up", "'../up' cannot be the name of a package"),
        ("pair", "class", "'class' cannot be the name of a package"),
        ("pair", "json", "'json' is the name of a module of Python, which"),
        ("pair", "ships", "'ships' is the name of a plugin, which"),
        ("pair", "numpy", "'numpy' is the name of an installed package or module, which"),
        ("pair", "scikit_learn", "an installed package or module"),
        ("pair", "sklearn", "an installed package or module"),
        ("pair", "no_package", "an installed package or module"),
        ("leaf", "../up", "'../up' is not a portable file name"),
        ("leaf", "up.", "'up.' is not a portable file name"),
        ("leaf", "mine.yaml", "'mine.yaml': .yaml is added to the name; write 'mine'"),
    ],
)
def test_a_wrong_kind_or_name_is_an_error(
    command: Command,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    kind: str,
    name: str,
    reason: str,
) -> None:
    (tmp_path / "found").mkdir()
    (tmp_path / "found" / "no_package.py").touch()
    monkeypatch.syspath_prepend(tmp_path / "found")
    before = set(tmp_path.rglob("*"))
    status, _, err = command("new", kind, name)
    assert (status, reason in err) == (2, True)
    assert set(tmp_path.rglob("*")) == before


def test_a_folder_of_that_name_here_is_no_installed_package(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend("")  # as under `python -m`
    Path("mine").mkdir()
    status, _, err = command("new", "pair", "mine")
    assert status == 0, err


@pytest.mark.parametrize("name", ["ships", "numpy", "2nd-try v1.2", "Lücken"])
def test_a_template_without_code_takes_any_file_name(command: Command, name: str) -> None:
    status, out, _ = command("new", "leaf", name)
    assert (status, out) == (0, f"wrote {name}.yaml\n")
    assert Path(f"{name}.yaml").read_text(encoding="utf-8") == f"title: {name}\n"


def test_a_template_that_is_no_text_is_named(command: Command, tmp_path: Path) -> None:
    (tmp_path / "shipped" / "leaf" / "face.png").write_bytes(b"\x89PNG\xff")
    status, out, err = command("new", "leaf", "mine")
    assert (status, out) == (2, "")
    assert "face.png: " in err
    assert not Path("mine.yaml").exists()
