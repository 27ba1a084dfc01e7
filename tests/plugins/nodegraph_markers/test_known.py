"""Names that are not there are told, with the nearest."""

from __future__ import annotations

import pytest

from nodegraph_markers.known import check_known, check_once, listed


def test_names_that_are_there_pass() -> None:
    check_known(["b", "a"], ("a", "b"))
    check_once(["a", "b"])


def test_each_unknown_name_is_told_once_with_the_nearest_whatever_its_case() -> None:
    with pytest.raises(ValueError, match=r"no marker 'NOSE1' \(did you mean 'nose1'\?\); 'q'; "):
        check_known(["NOSE1", "q", "q"], ("nose1", "chin"))


def test_names_that_stand_twice() -> None:
    with pytest.raises(ValueError, match="names: listed twice: a, c"):
        check_once(["a", "b", "c", "c", "a"])


def test_long_lists_are_cut() -> None:
    assert listed(f"m{i}" for i in range(23)).endswith("m19, and 3 more")
    assert listed([]) == "none"
