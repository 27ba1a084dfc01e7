"""The methods of a run: those that gave results, with their settings and sources, and the rest."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import PurePosixPath, PureWindowsPath

from nodegraph.execute.results import Run
from nodegraph.graph import GraphNode, Method
from nodegraph.graphfile.spec import with_leaves
from nodegraph.node.description import (
    ShownSetting,
    describe_declaration,
    describe_settings,
    value_text,
)
from nodegraph.plan import Combination
from nodegraph.plugin.bibliography import bibtex_of, references
from nodegraph.report.study import MethodRow, SettingRow, WithoutResult
from nodegraph.state import State

_MOST_VALUES = 12
_LEFT_OUT = "left out"


@dataclass
class _MethodRun:
    """A method of a node, and how its combinations ended.

    Attributes
    ----------
    node : GraphNode
    method : Method
    settings : set of Combination
        The combinations of the settings' own axes for which there is a result.
    without_result : Counter of str
        How many combinations have no result, by the state of their step.
    """

    node: GraphNode
    method: Method
    settings: set[Combination] = field(default_factory=set)
    without_result: Counter[str] = field(default_factory=Counter)


class Methods:
    """The methods of a run, with the settings for which they gave results."""

    def __init__(self, run: Run) -> None:
        nodes = run.plan.graph.nodes.values()
        self._bibtex = run.plan.graph.registry.hooks.of("bibtex")
        self._all = [method for node in nodes for method in _method_runs(run, node).values()]
        self._used = [used for used in self._all if used.settings]

    def rows(self) -> tuple[MethodRow, ...]:
        """Return the methods that gave a result, with the settings for which they did."""
        texts = references(self._bibtex, self._keys())
        return tuple(_row(used, texts) for used in self._used)

    def without_result(self) -> tuple[WithoutResult, ...]:
        """Return the methods that gave none, and how their combinations ended."""
        return tuple(
            WithoutResult(
                unused.node.name,
                unused.method.node.name,
                unused.method.label,
                ", ".join(f"{count} {state}" for state, count in unused.without_result.items())
                or _LEFT_OUT,
            )
            for unused in self._all
            if not unused.settings
        )

    def bibtex(self) -> str:
        """Return the BibTeX entries that the methods with a result cite."""
        return bibtex_of(self._bibtex, self._keys())

    def seeds(self) -> tuple[tuple[str, str], ...]:
        """Return the seeds of each node."""
        return tuple(
            (used.node.name, _joined(_values(used, "seed")))
            for used in self._used
            if "seed" in used.method.node.settings
        )

    def _keys(self) -> Iterator[str]:
        for used in self._used:
            yield from used.method.node.cite


def _method_runs(run: Run, node: GraphNode) -> Mapping[str, _MethodRun]:
    """Return the methods of a node by label."""
    methods = {label: _MethodRun(node, method) for label, method in node.methods.items()}
    for at, index in run.plan.cells.get(node.name, {}).items():
        of, state = methods[_label(node, at)], run.outcomes[index].state
        if state.has_value:
            labels = dict(zip(node.axes, at, strict=True))
            of.settings.add(tuple(labels[axis] for axis in of.method.settings.axes))
        else:
            of.without_result[_LEFT_OUT if state is State.SKIPPED else state] += 1
    for at in run.plan.skipped.get(node.name, {}):
        methods[_label(node, at)].without_result[_LEFT_OUT] += 1
    return methods


def _label(node: GraphNode, at: Combination) -> str:
    """Return the label of the method that computes a combination."""
    own = node.axes.index(node.name) if node.has_alternatives else None
    return next(iter(node.methods)) if own is None else str(at[own])


def _row(used: _MethodRun, texts: Mapping[str, str]) -> MethodRow:
    method = used.method
    return MethodRow(
        used.node.name,
        method.node.name,
        method.node.summary,
        method.label,
        tuple(_setting(used, setting) for setting in describe_settings(method.node)),
        citation="\n".join(texts[key] for key in method.node.cite),
        plugin=method.distribution or method.plugin,
        keys=tuple(method.node.cite),
        declared=describe_declaration(method.node, _settings(used)),
        damages=method.node.damages and bool(method.node.inputs),
    )


def _setting(used: _MethodRun, setting: ShownSetting) -> SettingRow:
    values = _values(used, setting.name)
    value, in_print = _joined(values), _joined(with_leaves(values, _without_folder))
    return SettingRow(
        setting.name,
        value,
        setting.unit,
        value == setting.default_text,
        setting.meaning,
        in_print if in_print != value else "",
    )


def _settings(used: _MethodRun) -> list[Mapping[str, object]]:
    """Return the settings for which there is a result."""
    shown = used.method.settings.shown.items()
    return [settings for at, settings in shown if at in used.settings]


def _values(used: _MethodRun, name: str) -> list[object]:
    """Return the different values of a setting for which there is a result."""
    values = (settings.get(name) for settings in _settings(used))
    return list({value_text(value): value for value in values}.values())


def _joined(values: Iterable[object]) -> str:
    texts = list(map(value_text, values))
    more = f" and {len(texts) - _MOST_VALUES} more" if len(texts) > _MOST_VALUES else ""
    return ", ".join(texts[:_MOST_VALUES]) + more


def _without_folder(value: object) -> object:
    """Return a file by its name alone: folders belong to one machine."""
    text = str(value)
    for path in (PurePosixPath(text), PureWindowsPath(text)):
        if path.is_absolute() and len(path.parts) > 2:
            return path.name
    return value
