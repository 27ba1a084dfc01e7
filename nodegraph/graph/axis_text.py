"""The meaning of the labels of an axis: unit and description of the settings that take them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

from nodegraph.graph.model import Graph, Method
from nodegraph.node.decorator import Setting
from nodegraph.node.description import meanings


class AxisText(NamedTuple):
    """An axis in words.

    Attributes
    ----------
    unit : str
        The unit of its labels; empty where they are names, or settings with several units take
        them.
    meaning : str
        The documentation of most of the settings that take its values.
    """

    unit: str = ""
    meaning: str = ""


def axis_text(graph: Graph, name: str) -> AxisText:
    """Return the meaning of an axis from the settings that take its values unchanged."""
    taken = _settings(graph, name)
    texts = Counter(meanings(method.node).get(setting.name, "") for method, setting in taken)
    return AxisText(axis_unit(graph, name), texts.most_common(1)[0][0] if texts else "")


def axis_unit(graph: Graph, name: str) -> str:
    """Return the unit of an axis alone, for which no documentation is read."""
    units = {setting.unit for _, setting in _settings(graph, name)}
    if len(units) != 1:
        return ""
    axis = graph.axes[name]
    return units.pop() if all(axis.values[label] == label for label in axis.labels) else ""


def _settings(graph: Graph, name: str) -> Iterator[tuple[Method, Setting]]:
    """Yield each setting whose value is that of the axis in every combination."""
    axis = graph.axes.get(name)
    if axis is None or not axis.values:
        return
    for node in graph.nodes.values():
        for method in node.methods.values():
            if name not in method.settings.axes:
                continue
            place = method.settings.axes.index(name)
            for setting in method.node.settings.values():
                pairs = method.settings.shown.items()
                # of a single label, another setting may have the value by chance
                if (len(axis.labels) > 1 or setting.name == name) and all(
                    shown.get(setting.name) == axis.values[at[place]] for at, shown in pairs
                ):
                    yield method, setting
