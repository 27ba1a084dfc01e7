"""``cite`` prints what a paper needs, or writes it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture
def ran(command: Command) -> str:
    assert command("run", "toy.yaml")[0] == 0
    return "runs/toy"


def test_it_prints_a_paragraph_a_table_and_the_sources(command: Command, ran: str) -> None:
    status, out, _ = command("cite", ran, nodes=False)
    assert status == 0
    assert out.startswith("Step `a` used `toy.number` (`start` 5).")
    assert "| gaps | toy.cut | length | 1, 5 | frames |" in out


def test_it_writes_files_and_overwrites_none(command: Command, ran: str) -> None:
    status, out, _ = command("cite", ran, "--out", "paper", nodes=False)
    assert status == 0
    names = {path.name for path in Path("paper").iterdir()}
    assert names == {"methods.md", "methods.tex", "settings.md", "settings.tex", "references.bib"}
    assert out.count("\n") == len(names)
    status, _, err = command("cite", ran, "--out", "paper", nodes=False)
    assert (status, "is there already" in err) == (2, True)


def test_a_folder_without_a_run_is_named(command: Command) -> None:
    status, _, err = command("cite", "nowhere", nodes=False)
    assert (status, "there is no finished run" in err) == (2, True)
