from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_files.marker_names import unique_names
from tests.plugins.recordings import quietly


def test_plain_labels_stay() -> None:
    assert unique_names(["a", "b:c", "d"], 3) == ("a", "b:c", "d")


def test_a_subject_that_all_share_is_taken_off() -> None:
    assert unique_names(["Ann:lip", "Ann:nose:tip"], 2) == ("lip", "nose:tip")


def test_a_marker_without_a_label_has_no_other_subject() -> None:
    with pytest.warns(UserWarning, match="'' is now 'unnamed_2'"):
        assert unique_names(["Ann:lip", "", "Ann:nose"], 3) == ("lip", "unnamed_2", "nose")


@pytest.mark.parametrize("labels", [["Ann:lip", "Bob:lip"], ["Ann:lip", "nose"], ["a:", "a:x"]])
def test_a_prefix_that_is_not_shared_stays(labels: list[str]) -> None:
    assert unique_names(labels, 2) == tuple(labels)


def test_names_that_lack_or_repeat_are_made_unique_and_reported() -> None:
    with pytest.warns(UserWarning, match="3 markers had no label, or another's: 'a' is now 'a_2_'"):
        names = unique_names(["a", "a", "a_2", ""], 5)
    assert names == ("a", "a_2_", "a_2", "unnamed_4", "unnamed_5")


def test_labels_beyond_the_markers_are_reported_unless_empty() -> None:
    assert unique_names(["a", "", ""], 1) == ("a",)
    with pytest.warns(UserWarning, match="2 labels beyond the 1 markers were left out: b, c"):
        assert unique_names(["a", "b", "c"], 1) == ("a",)


@given(st.lists(st.sampled_from(["", "a", "a_1", "a_2", "a:b", "unnamed_1"])), st.integers(0, 8))
def test_there_is_one_name_per_marker(labels: list[str], count: int) -> None:
    names = quietly(unique_names, labels, count)
    assert len(names) == count == len(set(names))
    assert all(names)
