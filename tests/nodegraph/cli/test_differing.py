"""Long lists of differences are told in short."""

from __future__ import annotations

from collections import Counter

from nodegraph.cli.output import MOST, counted, few, first_and_more


def test_counts_are_told_by_node() -> None:
    assert counted(Counter({"fill": 4, "one": 0, "total": 1})) == "fill (4), total (1)"


def test_the_first_stands_for_the_rest() -> None:
    assert first_and_more("fill(a=1)", 1, "fill") == "fill(a=1)"
    assert first_and_more("fill(a=1)", 3, "fill") == "fill(a=1) and 2 more of fill"


def test_what_is_not_told_is_counted() -> None:
    lines = [str(one) for one in range(MOST + 2)]
    assert list(few(lines[:MOST])) == lines[:MOST]
    assert list(few(lines))[MOST:] == ["and 2 more"]
    assert list(few(lines, "changes"))[MOST:] == ["and 2 more changes"]
