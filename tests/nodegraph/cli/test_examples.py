"""``examples`` copies graphs and overwrites nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph import hookimpl
from nodegraph.plugin import loading
from tests.nodegraph.cli.conftest import Command


@pytest.fixture
def examples(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """An installed plugin that ships one example graph."""
    folder = tmp_path / "shipped"
    folder.mkdir()
    (folder / "toy.yaml").write_text(Path("toy.yaml").read_text())

    class Shipping:
        @staticmethod
        @hookimpl
        def nodegraph_graphs() -> list[Path]:
            return [folder / "toy.yaml"]

    monkeypatch.setattr(loading, "installed", lambda: ([loading.Plugin("ships", Shipping)], []))
    return folder


def test_examples_are_listed_and_copied(command: Command, examples: Path) -> None:
    status, out, _ = command("new")
    assert status == 0
    assert out.splitlines()[0] == "toy  A toy"
    status, out, _ = command("new", "toy", "--to", "new/folder")
    assert status == 0
    assert Path("new/folder/toy.yaml").read_text() == Path("toy.yaml").read_text()
    assert "nodegraph run new/folder/toy.yaml" in out


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["toi"], "no template or study 'toi'; did you mean 'toy'"),
        (["toy"], "toy.yaml already exists"),
        (["toy", "--to", "toys.py"], "toys.py"),
    ],
)
def test_an_example_never_overwrites(
    command: Command, examples: Path, words: list[str], reason: str
) -> None:
    Path("toy.yaml").write_text("mine")
    status, _, err = command("new", *words)
    assert status == 2
    assert reason in err
    assert Path("toy.yaml").read_text() == "mine"


def test_what_an_example_uses_comes_with_it(command: Command, examples: Path) -> None:
    (examples / "parts").mkdir()
    inner = "nodegraph: 1\nnodes: {a: {use: toy.number}}\noutputs: {number: a}\n"
    (examples / "parts" / "inner.yaml").write_text(inner)
    outer = "nodegraph: 1\nnodes: {n: {use: ./parts/inner.yaml}, b: {use: fill.hold, in: n}}\n"
    (examples / "toy.yaml").write_text(outer)
    assert command("new", "toy", "--to", "new")[0] == 0
    assert Path("new/parts/inner.yaml").read_text() == inner
    status, out, err = command("run", "new/toy.yaml")
    assert (status, "3 steps: 3 computed" in out) == (0, True), err
    assert Path("runs/toy/parts/inner.yaml").read_text() == inner
    assert command("run", "runs/toy/graph.yaml")[0] == 0
    assert command("new", "toy", "--to", "new")[0] == 2
