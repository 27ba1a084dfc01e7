from __future__ import annotations

from nodegraph.formatting import name_at


def test_a_combination_is_named_by_its_labels() -> None:
    assert name_at("fill", {"fill": "muscle", "length": 5}) == "fill(fill=muscle, length=5)"
    assert name_at("total", {}) == "total"
