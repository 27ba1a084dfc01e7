from __future__ import annotations

import pytest

from nodegraph.draw import Arrow, Box, Picture, Socket

BOXES = (Box("a", outputs=(Socket("out"),)), Box("b", inputs=(Socket("in"),)))


@pytest.mark.parametrize(
    ("arrow", "message"),
    [
        (Arrow("c", "out", "b", "in"), "no box is named 'c'; there is a, b"),
        (Arrow("a", "out", "b", "on"), "'b' has no such port 'on'; there is in"),
        (Arrow("b", "out", "a", "in"), "'b' has no such port 'out'; there is none"),
    ],
)
def test_an_arrow_needs_its_ends(arrow: Arrow, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Picture("wrong", BOXES, (arrow,))


def test_names_are_unique() -> None:
    with pytest.raises(ValueError, match="several boxes are named 'a'"):
        Picture("twice", (*BOXES, Box("a")))


def test_an_arrow_as_text() -> None:
    arrow = Arrow("a", "out", "b", "in", gathers=True, truth=True, fixed="k=3")
    assert str(arrow) == "a.out to b.in (at k=3, truth, gathers)"
    assert str(Arrow("a", "out", "b", "in")) == "a.out to b.in"
