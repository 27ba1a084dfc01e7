"""Names are drawn as they stand in the figures of every installed node, a stranger's as well."""

from __future__ import annotations

import warnings
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from nodegraph import Across, Refusal
from nodegraph.node.decorator import Node
from nodegraph.plugin.registry import Registry
from nodegraph.testing.specimens import cases
from nodegraph_mocap import Figure
from nodegraph_tables.renderers import saved
from tests.test_contracts import found, installed, names, needs

SHOWN = {
    r"$\frac$": r"$\frac$",
    "pay $1 or $2": "pay $1 or $2",
    "$x_1$": "$x_1$",
    "_hidden": "_hidden",
    "two\nlines": "two lines",
    "<b>&": "<b>&",
}
"""Labels, and how they are drawn."""

WITHOUT_LABELS = {"compare.importance"}
"""Nodes whose figures name the axes and no label."""


def figures() -> list[str]:
    return [
        name for name in names() if any(port.type is Figure for port in found(name).node.outputs)
    ]


def relabelled(value: Any) -> Any:
    """Return what is gathered with labels that matplotlib reads in ways of its own."""
    if not isinstance(value, Across):
        return value
    first = value.values()[0]
    return Across(
        value.axes, tuple(({axis: label for axis in value.axes}, first) for label in SHOWN)
    )


def drawn(node: Node, registry: Registry) -> list[Figure]:
    """Return the figures that a node draws of the first specimen that it does not decline."""
    for _, values in cases(node, {}, registry):
        inputs = {port: relabelled(value) for port, value in values.items()}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                made = node.function(**inputs, **needs(node))
            except (Refusal, ValueError):
                continue
        outputs = [made] if isinstance(made, Figure) else list(made)
        return [one for one in outputs if isinstance(one, Figure)]
    return []


def text_of(figure: Figure) -> str:
    """Return what is written in a figure; a name may be broken into lines."""
    root = ET.fromstring(saved(figure, "svg"))
    found = ["".join(one.itertext()) for one in root.iter("{http://www.w3.org/2000/svg}text")]
    return " ".join(" ".join(found).split())


def test_there_are_figures() -> None:
    assert {"plot:plot.faces", "compare:compare.table", "score:score.alignment"} <= set(figures())


@pytest.mark.parametrize("name", figures())
def test_labels_are_drawn_as_they_stand(name: str) -> None:
    node = found(name).node
    made = drawn(node, installed())
    assert made, "draws none of the specimens"
    said = " ".join(map(text_of, made))
    assert all(saved(figure, "pdf").startswith(b"%PDF") for figure in made)
    if node.name not in WITHOUT_LABELS:
        assert [shown for shown in SHOWN.values() if shown not in said] == []
