"""What of the study is another is told apart from what it stands on."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from typing import Any

import pytest

from nodegraph.execute import Run
from nodegraph.lock.compare import Change, Explained
from nodegraph.lock.lockfile import Lock
from nodegraph.lock.results import Cell, cells_of

Frozen = tuple[Run, Lock]


def edited(lock: Lock) -> tuple[Lock, Any]:
    """Return a lock with data that may be changed."""
    data = deepcopy(dict(lock.data))
    return replace(lock, data=data), data


def cut_of(run: Run) -> Cell:
    return next(cell for cell in cells_of(run) if cell.group == "cut")


def test_an_untouched_study_has_no_change(frozen: Frozen) -> None:
    run, lock = frozen
    explained = Explained(lock, run)
    assert {explained.change(cell) for cell in cells_of(run)} == {Change()}
    assert list(explained.everywhere()) == []


def test_what_a_method_was_is_told(frozen: Frozen) -> None:
    run, lock = frozen
    lock, data = edited(lock)
    data["methods"]["cut"] |= {"use": "gaps.old", "in": {"recording": "b"}, "code": "0" * 10}
    data["methods"]["cut"]["settings"]["seed"] = 4
    assert Explained(lock, run).change(cut_of(run)).own == (
        "use was gaps.old, now gaps.cut",
        "seed was 4, now 0",
        "input recording was 'b', now 'a'",
        "its code was edited",
    )


def test_versions_are_what_it_stands_on(frozen: Frozen) -> None:
    run, lock = frozen
    lock, data = edited(lock)
    data["versions"] |= {"platform": "Plan 9", "scipy": "0.1"}
    explained = Explained(lock, run)
    own, around = explained.change(cut_of(run)).own, explained.change(cut_of(run)).around
    assert own == ()
    assert [one.split(",")[0] for one in around] == ["platform was Plan 9"]
    assert "scipy was 0.1" in [one.split(",")[0] for one in explained.everywhere()]


@pytest.mark.parametrize(("python", "compared"), [("3.99.1", False), ("", True)])
def test_code_is_not_compared_across_versions_of_the_language(
    frozen: Frozen, python: str, compared: bool
) -> None:
    run, lock = frozen
    lock, data = edited(lock)
    data["versions"]["python"] = python or data["versions"]["python"]
    data["methods"]["cut"]["code"] = "0" * 10
    assert ("its code was edited" in Explained(lock, run).change(cut_of(run)).own) == compared
