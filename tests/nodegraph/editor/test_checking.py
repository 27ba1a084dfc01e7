"""A check that takes long keeps nobody from editing."""

from __future__ import annotations

from collections.abc import Iterator
from threading import Event

import pytest

from nodegraph.editor import checking
from nodegraph.editor.checking import Checking
from nodegraph.editor.view import View


@pytest.fixture
def ending() -> Iterator[Event]:
    """Ends the checks that take long."""
    event = Event()
    yield event
    event.set()


def test_a_check_that_takes_long_is_not_waited_for(
    ending: Event, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(checking, "_PATIENCE", 0.01)
    begun: list[str] = []

    def check(text: str) -> View:
        begun.append(text)
        if text.startswith("long"):
            ending.wait()
        return View(None, [], text, "", {})

    checks = Checking(check)
    assert checks.view_of("long 1") is None
    assert checks.view_of("long 1") is None  # it goes on, and is not begun again
    monkeypatch.setattr(checking, "_PATIENCE", 60)
    assert svg(checks.view_of("short")) == "short"
    monkeypatch.setattr(checking, "_PATIENCE", 0.01)
    for number in (2, 3, 4):
        assert checks.view_of(f"long {number}") is None
    assert checks.view_of("waits") is None  # for one of the four
    assert begun == ["long 1", "short", "long 2", "long 3", "long 4"]
    ending.set()
    while (view := checks.view_of("waits")) is None:
        pass
    assert svg(view) == "waits"


def test_a_text_is_checked_once() -> None:
    begun: list[str] = []

    def check(text: str) -> View:
        begun.append(text)
        return View(None, [], text, "", {})

    checks = Checking(check)
    for text in ("a", "a", "b", "a"):
        assert svg(checks.view_of(text)) == text
    assert begun == ["a", "b", "a"]


def svg(view: View | None) -> str:
    assert view is not None
    return view.svg
