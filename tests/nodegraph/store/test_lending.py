"""A reader that changes what it got changes nothing for the others."""

from __future__ import annotations

from nodegraph.store import Packer


def test_lists_and_mappings_are_lent_as_copies() -> None:
    packer = Packer()
    value = [1, {"a": [2]}]
    lent = packer.lend(value)
    lent[1]["a"].append(3)
    assert value == [1, {"a": [2]}]
    assert packer.lend((1, 2)) == (1, 2)
