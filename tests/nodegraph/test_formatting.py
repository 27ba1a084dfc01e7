from __future__ import annotations

from nodegraph.formatting import first_and_more, name_at


def test_a_combination_is_named_by_its_labels() -> None:
    assert name_at("fill", {"fill": "muscle", "length": 5}) == "fill(fill=muscle, length=5)"
    assert name_at("total", {}) == "total"


def test_the_first_stands_for_the_rest() -> None:
    assert first_and_more("fill(a=1)", 1, "fill") == "fill(a=1)"
    assert first_and_more("fill(a=1)", 3, "fill") == "fill(a=1) and 2 more of fill"
