"""Changes of a study, and of its environment."""

from __future__ import annotations

import pytest

from nodegraph.execute import Run
from nodegraph.lock.changes import Change, Changes
from nodegraph.lock.document import LockedStudy
from nodegraph.lock.lockfile import Lock
from nodegraph.lock.results import Cell, cells_of

Frozen = tuple[Run, Lock]


def with_versions(lock: Lock, **versions: str) -> LockedStudy:
    return lock.study.model_copy(update={"versions": {**lock.study.versions, **versions}})


def with_cut(study: LockedStudy, **changes: object) -> LockedStudy:
    cut = study.methods["cut"].model_copy(update=changes)
    return study.model_copy(update={"methods": {**study.methods, "cut": cut}})


def cut_of(run: Run) -> Cell:
    return next(cell for cell in cells_of(run) if cell.group == "cut")


def test_an_untouched_study_has_no_change(frozen: Frozen) -> None:
    run, lock = frozen
    changes = Changes(lock.study, run)
    assert {changes.of(cell) for cell in cells_of(run)} == {Change()}
    assert list(changes.everywhere()) == []


def test_changes_of_a_method_are_listed(frozen: Frozen) -> None:
    run, lock = frozen
    settings = {**lock.study.methods["cut"].settings, "seed": 4}
    inputs = {"recording": "b"}
    study = with_cut(lock.study, use="gaps.old", inputs=inputs, code="0" * 10, settings=settings)
    use, seed, recording, code = Changes(study, run).of(cut_of(run)).own
    assert "gaps.old, now gaps.cut" in use
    assert "seed was 4, now 0" in seed
    assert "recording was 'b', now 'a'" in recording
    assert "code" in code


def test_versions_are_changes_of_the_environment(frozen: Frozen) -> None:
    run, lock = frozen
    changes = Changes(with_versions(lock, platform="Plan 9", scipy="0.1"), run)
    change = changes.of(cut_of(run))
    assert change.own == ()
    assert [text.split(",")[0] for text in change.around] == ["platform was Plan 9"]
    assert "scipy was 0.1" in [text.split(",")[0] for text in changes.everywhere()]


@pytest.mark.parametrize("same_python", [True, False])
def test_code_is_not_compared_across_versions_of_python(frozen: Frozen, same_python: bool) -> None:
    run, lock = frozen
    study = lock.study if same_python else with_versions(lock, python="3.99.1")
    own = Changes(with_cut(study, code="0" * 10), run).of(cut_of(run)).own
    assert bool(own) == same_python
