"""``new`` writes what a template holds, and overwrites nothing."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from nodegraph import hookimpl, plugins

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture(autouse=True)
def _templates(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """An installed plugin with one kind of template, in which a name stands in text and paths."""
    folder = tmp_path / "shipped" / "pair"
    (folder / "{{name}}").mkdir(parents=True)
    (folder / "{{name}}" / "{{name}}.py.template").write_text("{{name}} = 1\n")
    (folder / "notes.md").write_text("of {{name}}, {other}\n")

    class Shipping:
        @staticmethod
        @hookimpl
        def nodegraph_templates() -> dict[str, Path]:
            return {"pair": folder}

    monkeypatch.setattr(plugins, "installed", lambda: ([plugins.Plugin("ships", Shipping)], []))


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
    assert (status, "mine/mine.py is there already; it is left as it is" in err) == (2, True)
    assert Path("mine/mine.py").read_text() == "precious"
    assert not Path("notes.md").exists()


@pytest.mark.parametrize(
    ("kind", "name", "said"),
    [
        ("pear", "mine", "nothing new of kind 'pear'; did you mean 'pair'"),
        ("pair", "Mine", "'Mine' cannot be a name here"),
        ("pair", "../up", "'../up' cannot be a name here"),
        ("pair", "class", "'class' cannot be a name here"),
        ("pair", "json", "'json' is the name of a plugin or of a module of Python"),
        ("pair", "ships", "'ships' is the name of a plugin or of a module of Python"),
    ],
)
def test_a_kind_or_a_name_that_will_not_do_is_told(
    command: Command, kind: str, name: str, said: str
) -> None:
    status, _, err = command("new", kind, name)
    assert (status, said in err) == (2, True)
