from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph_files.text.vicon import count_triples, labels_over

PATH = Path("take.trc")


def test_names_stand_over_every_third_column() -> None:
    assert list(labels_over(PATH, 4, ["Frame#", "Time", "a", "", "", "b"])) == ["a", "b"]
    assert list(labels_over(PATH, 4, ["Frame#", "Time"])) == []


@pytest.mark.parametrize("axes", [["X1", "Y1", "Z1", "X2", "Y2", "Z2", ""], ["x", "y", "z"] * 2])
def test_three_columns_make_a_marker(axes: list[str]) -> None:
    assert count_triples(PATH, 5, ["", "", *axes]) == 2


@pytest.mark.parametrize("axes", [[], ["X1", "Y1"], ["X1", "Y1", "Z1", "X2"]])
def test_columns_that_make_no_whole_number_are_refused(axes: list[str]) -> None:
    with pytest.raises(ValueError, match=rf"take\.trc:5: {len(axes)} columns X1, Y1, Z1"):
        count_triples(PATH, 5, ["", "", *axes])


def test_what_is_out_of_place_is_refused_with_its_place() -> None:
    with pytest.raises(ValueError, match=r"take\.trc:4:4: the name 'b' is out of place"):
        labels_over(PATH, 4, ["Frame#", "Time", "a", "b"])
    with pytest.raises(ValueError, match=r"take\.trc:5:4: 'Z1' where Y1 is expected"):
        count_triples(PATH, 5, ["", "", "X1", "Z1", "Y1"])
