from __future__ import annotations

from nodegraph_tables.style import looks


def test_a_label_looks_the_same_in_every_order() -> None:
    assert looks(["b", "a", "c"]) == looks(["c", "b", "a"])


def test_the_first_seventy_differ_in_colour_or_marker() -> None:
    dealt = looks(range(70)).values()
    assert len({(look.colour, look.marker) for look in dealt}) == 70


def test_up_to_seven_methods_each_have_their_own_colour_and_marker() -> None:
    dealt = looks(range(7)).values()
    assert len({look.colour for look in dealt}) == len({look.marker for look in dealt}) == 7
