"""Names are drawn as they stand in the figures of every installed node."""

from __future__ import annotations

import warnings
from xml.etree import ElementTree as ET

import pytest

from nodegraph import Across, Refusal
from nodegraph.node.decorator import Node
from nodegraph.testing.specimens import cases
from nodegraph_mocap import Figure
from nodegraph_tables.figures import StoredFigure, store_figure
from tests.test_contracts import INSTALLED, required

SHOWN = {
    r"$\frac$": r"$\frac$",
    "pay $1 or $2": "pay $1 or $2",
    "$x_1$": "$x_1$",
    "_hidden": "_hidden",
    "two\nlines": "two lines",
    "<b>&": "<b>&",
}
"""Labels, and how they are drawn."""

WITHOUT_LABELS = {"score.calibration", "score.realism"}
"""Nodes whose figures name axes, levels of coverage or measures, and no label."""


FIGURES = [
    registered.full_name
    for registered in INSTALLED
    if any(port.type is Figure for port in registered.node.outputs)
]


def relabelled(value: object, *, truth: bool) -> object:
    """Return what is gathered with labels that matplotlib reads in ways of its own."""
    if not isinstance(value, Across):
        return value
    first = value.values()[0]
    if truth:  # one for all, or its labels would tell takes apart, and not methods
        return Across((), (({}, first),))
    return Across(
        value.axes, tuple(({axis: label for axis in value.axes}, first) for label in SHOWN)
    )


def drawn(node: Node) -> list[Figure]:
    """Return the figures that a node draws of the first specimen that it does not decline."""
    for _, values in cases(node, {}, INSTALLED):
        truths = {port.name for port in node.inputs if port.truth}
        inputs = {port: relabelled(value, truth=port in truths) for port, value in values.items()}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                returned = node.function(**inputs, **required(node))
            except (Refusal, ValueError):
                continue
        outputs = [returned] if isinstance(returned, Figure) else list(returned)
        return [output for output in outputs if isinstance(output, Figure)]
    return []


def text_of(drawing: StoredFigure) -> str:
    """Return what is written in a figure; a name may be broken into lines."""
    root = ET.fromstring(drawing.svg)
    texts = ["".join(text.itertext()) for text in root.iter("{http://www.w3.org/2000/svg}text")]
    return " ".join(" ".join(texts).split())


def test_there_are_figures() -> None:
    assert {"plot:plot.faces", "compare:compare.table", "score:plot.alignment"} <= set(FIGURES)


@pytest.mark.parametrize("name", FIGURES)
def test_labels_are_drawn_as_they_stand(name: str) -> None:
    node = INSTALLED.find(name).node
    figures = drawn(node)
    assert figures, "draws none of the specimens"
    drawings = [store_figure(figure) for figure in figures]
    text = " ".join(map(text_of, drawings))
    assert all(drawing.pdf.startswith(b"%PDF") for drawing in drawings)
    if node.name not in WITHOUT_LABELS:
        assert [shown for shown in SHOWN.values() if shown not in text] == []
