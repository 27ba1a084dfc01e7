from __future__ import annotations

import pytest

from nodegraph.node.ports import Across, Port, label_text, mismatch


@pytest.mark.parametrize(
    ("source", "target", "fits"),
    [
        (Port("a", int), Port("b", int), True),
        (Port("a", bool), Port("b", int), True),
        (Port("a", int), Port("b", bool), False),
        (Port("a", int), Port("b", float), False),
        (Port("a", int), Port("b", int, truth=True), True),
        (Port("a", int, truth=True), Port("b", int, truth=True), True),
        (Port("a", int, truth=True), Port("b", int), False),
        (Port("a", int), Port("b", int, across=True), True),
    ],
)
def test_a_port_takes_its_type_and_subclasses_and_truth_only_where_marked(
    source: Port, target: Port, fits: bool
) -> None:
    assert (mismatch(source, target) is None) is fits


def test_a_mismatch_names_both_types() -> None:
    assert mismatch(Port("a", int), Port("b", str)) == "'b' takes str, not int"


def test_a_port_shows_itself_as_it_is_annotated() -> None:
    shown = str(Port("x", int, truth=True, across=True, optional=True))
    assert shown == "x: Truth[Across[int]] | None"


def test_across_can_be_made_by_hand() -> None:
    gathered = Across.of({"a": 1.0, "b": 2.0}, axis="fill")
    assert gathered.axes == ("fill",)
    assert list(gathered) == [({"fill": "a"}, 1.0), ({"fill": "b"}, 2.0)]
    assert len(gathered) == 2
    assert gathered.values() == (1.0, 2.0)
    assert gathered.names() == ("a", "b")


def test_an_empty_label_is_not_shown() -> None:
    assert label_text({"stage": "captured", "fill": "", "trial": 0}) == "captured, 0"
