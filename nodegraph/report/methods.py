"""The methods of a run: those that gave a result, with settings and sources; those without."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import PurePosixPath, PureWindowsPath
from typing import Any

from nodegraph.bibliography import bibtex_of, references
from nodegraph.describe import SettingText, describe_settings, shown
from nodegraph.execute import Run
from nodegraph.graph import GraphNode, Method
from nodegraph.plan import Combination
from nodegraph.report.study import MethodRow, SettingRow, WithoutResult

_MOST_VALUES = 12
_LEFT_OUT = "left out"


@dataclass
class _Ended:
    """How the combinations of a method ended.

    Attributes
    ----------
    settings : set of Combination
        Those of the settings' own axes at which there is a result.
    others : Counter of str
        How many combinations have no result, by what became of them.
    """

    settings: set[Combination] = field(default_factory=set)
    others: Counter[str] = field(default_factory=Counter)


class Methods:
    """What is said of the methods of a run."""

    def __init__(self, run: Run) -> None:
        nodes = run.plan.graph.nodes.values()
        ended = {node.name: _ended(run, node) for node in nodes}
        self._bibtex = run.plan.graph.registry.bibtex
        self._every = [
            (node, one, ended[node.name][label])
            for node in nodes
            for label, one in node.methods.items()
        ]
        self._used = [one for one in self._every if one[2].settings]

    def rows(self) -> tuple[MethodRow, ...]:
        """Return the methods that gave a result, with the settings at which they did."""
        texts = references(self._bibtex, self._keys())
        return tuple(_row(node, one, ended, texts) for node, one, ended in self._used)

    def without_result(self) -> tuple[WithoutResult, ...]:
        """Return the methods that gave none, and what became of them."""
        return tuple(
            WithoutResult(node.name, one.node.name, one.label, _counted(ended.others))
            for node, one, ended in self._every
            if not ended.settings
        )

    def bibtex(self) -> str:
        """Return the BibTeX of what the methods that gave a result cite."""
        return bibtex_of(self._bibtex, self._keys())

    def seeds(self) -> tuple[tuple[str, str], ...]:
        """Return the seeds of each node."""
        return tuple(
            (node.name, _joined(_values(method, "seed", ended)))
            for node, method, ended in self._used
            if "seed" in method.node.settings
        )

    def _keys(self) -> Iterator[str]:
        for _, method, _ in self._used:
            yield from method.node.cite


def _ended(run: Run, node: GraphNode) -> Mapping[str, _Ended]:
    """Return how the combinations of each method of a node ended, by label."""
    found: defaultdict[str, _Ended] = defaultdict(_Ended)
    for at, index in run.plan.cells.get(node.name, {}).items():
        label, state = _label(node, at), run.outcomes[index].state
        if state in ("done", "unneeded"):
            labels = dict(zip(node.axes, at, strict=True))
            axes = node.methods[label].settings.axes
            found[label].settings.add(tuple(labels[axis] for axis in axes))
        else:
            found[label].others[_LEFT_OUT if state == "skipped" else state] += 1
    for at in run.plan.skipped.get(node.name, {}):
        found[_label(node, at)].others[_LEFT_OUT] += 1
    return found


def _label(node: GraphNode, at: Combination) -> str:
    """Return the label of the method that computes a combination."""
    own = node.axes.index(node.name) if node.has_alternatives else None
    return next(iter(node.methods)) if own is None else str(at[own])


def _row(node: GraphNode, method: Method, ended: _Ended, texts: Mapping[str, str]) -> MethodRow:
    settings = tuple(_setting(method, one, ended) for one in describe_settings(method.node))
    return MethodRow(
        node.name,
        method.node.name,
        method.node.summary,
        method.label,
        settings,
        citation="\n".join(texts[key] for key in method.node.cite),
        plugin=method.distribution or method.plugin,
        keys=tuple(method.node.cite),
    )


def _setting(method: Method, one: SettingText, ended: _Ended) -> SettingRow:
    values = _values(method, one.name, ended)
    value, named = _joined(values), _joined(map(_by_name, values))
    in_print = named if named != value else ""
    return SettingRow(one.name, value, one.unit, value == one.default, one.meaning, in_print)


def _values(method: Method, name: str, ended: _Ended) -> list[Any]:
    """Return each value of a setting at which there is a result, once."""
    every = (one.get(name) for at, one in method.settings.shown.items() if at in ended.settings)
    return list({shown(one): one for one in every}.values())


def _joined(values: Iterable[Any]) -> str:
    texts = list(map(shown, values))
    more = f" and {len(texts) - _MOST_VALUES} more" if len(texts) > _MOST_VALUES else ""
    return ", ".join(texts[:_MOST_VALUES]) + more


def _by_name(value: Any) -> Any:
    """Return a value in which files have their names alone: folders are of one machine."""
    if isinstance(value, (list, tuple)):
        return [_by_name(one) for one in value]
    if isinstance(value, Mapping):
        return {name: _by_name(one) for name, one in value.items()}
    text = str(value)
    for path in (PurePosixPath(text), PureWindowsPath(text)):
        if path.is_absolute() and len(path.parts) > 2:
            return path.name
    return value


def _counted(others: Counter[str]) -> str:
    return ", ".join(f"{count} {state}" for state, count in others.items()) or _LEFT_OUT
