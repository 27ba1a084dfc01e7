"""A difference begins where nothing upstream differs, or where the step itself changed."""

from __future__ import annotations

from nodegraph.runs.diff import Spread


def test_a_difference_begins_where_nothing_upstream_differs_and_where_a_step_changed() -> None:
    spread: Spread[str] = Spread()
    spread.add("first", "a", 0, (), ())
    spread.add("fed by it", "b", 1, (0,), ())
    spread.add("fed by it, and edited", "c", 2, (1,), ["edited"])
    spread.add("fed by others", "d", 4, (3,), ())
    spread.add("fed by one that follows", "b", 5, (3, 1), ())
    assert spread.origins == ["first", "fed by it, and edited", "fed by others"]
    assert spread.followers == {"b": 2}
    assert spread.beyond == 5
    assert spread.reaches([3, 2])
    assert not spread.reaches([3])


def test_a_step_that_stands_for_two_combinations_does_not_feed_itself() -> None:
    spread: Spread[str] = Spread()
    spread.add("one", "a", 1, (0,), ())
    spread.add("other", "a", 1, (0,), ())
    assert spread.origins == ["one", "other"]
