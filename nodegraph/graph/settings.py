"""Validate settings for every combination of the axes that they name."""

from __future__ import annotations

import itertools
import json
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nodegraph.errors import NodegraphError, Problems, listed, nearest, quoted
from nodegraph.graph.methods import ResolvedMethod
from nodegraph.graph.model import (
    Gather,
    Graph,
    GraphNode,
    Method,
    Settings,
    method_name,
    sources_of,
)
from nodegraph.graph.namespace import Namespace
from nodegraph.graphfile.spec import Variable, Written, with_leaves
from nodegraph.node.decorator import Node
from nodegraph.node.description import setting_kind, value_text
from nodegraph.node.ports import ColumnOf, Label, LabelOf, Port
from nodegraph.plugin.registry import Registry

if TYPE_CHECKING:
    from pydantic import ValidationError

_LIST_TYPES = {"list_type", "tuple_type", "set_type", "frozen_set_type"}
_MOST_VALUES = 3
"""Wrong values of a setting that are shown, where an axis gives it several."""
_encode = json.JSONEncoder(default=str).encode
_REASONS = {
    "missing": "must be given",
    "extra_forbidden": "is not a setting of this node",
}


@dataclass(frozen=True, slots=True)
class _Pending:
    """Settings of one method whose values are not validated yet.

    Attributes
    ----------
    where : str
        Names the method in messages.
    written : mapping of name to Written
        The settings that the node has.
    values, shown : dict of labels to settings
        To be filled; see `Settings`.
    """

    where: str
    method: ResolvedMethod
    node: Node
    written: Mapping[str, Written]
    axes: tuple[str, ...]
    values: dict[tuple[Label, ...], Mapping[str, object]]
    shown: dict[tuple[Label, ...], Mapping[str, object]]


class SettingsReader:
    """Reads the settings of methods: first their axes, and then, with `fill`, the values.

    Values are read last, because a graph with too many combinations must be known before.
    """

    def __init__(self, namespace: Namespace, registry: Registry, problems: Problems) -> None:
        self._namespace = namespace
        self._registry = registry
        self._problems = problems
        self._defaults: dict[Node, Settings] = {}
        self._pending: list[_Pending] = []

    def read(self, where: str, method: ResolvedMethod, node: Node) -> Settings:
        """Return the settings of a method, without values; `where` names it in messages."""
        if method.settings:
            return self._read(where, method, node)
        settings = self._defaults.get(node)
        if settings is None:
            settings = self._read(where, method, node)
            if not any(setting.required for setting in node.settings.values()):
                self._defaults[node] = settings
        return settings

    def fill(self, *, in_full: bool) -> None:
        """Validate the settings that were read, at every combination or at the first one."""
        for pending in self._pending:
            self._fill(pending, in_full=in_full)
        self._pending.clear()

    def _read(self, where: str, method: ResolvedMethod, node: Node) -> Settings:
        written = {
            name: value
            for name, value in method.settings.items()
            if self._is_setting(where, name, value, node)
        }
        axes = self._axes(written.values())
        pending = _Pending(where, method, node, written, axes, {}, {})
        self._pending.append(pending)
        return Settings(axes, pending.values, pending.shown)

    def _fill(self, pending: _Pending, *, in_full: bool) -> None:
        written, axes = pending.written, pending.axes
        if self._namespace.invalid:
            written = {
                name: value
                for name, value in written.items()
                if self._namespace.invalid.isdisjoint(value.variables())
            }
            axes = self._axes(written.values())
        combinations = itertools.product(*(self._namespace.axes[axis].labels for axis in axes))
        plain = {name: value.value for name, value in written.items()}
        varying = {name: plain[name] for name, value in written.items() if value.variables()}
        wrong: defaultdict[str, dict[str, str]] = defaultdict(dict)
        for labels in combinations if in_full else itertools.islice(combinations, 1):
            at = dict(zip(axes, labels, strict=True))
            known = partial(self._known, labels=at)
            shown = plain | {name: with_leaves(value, known) for name, value in varying.items()}
            # settings without a valid value: their errors are recorded already
            invalid = pending.written.keys() - written.keys()
            values = self._validated(pending, shown, invalid, wrong)
            files = self._files(pending, shown, [name for name in written if name not in invalid])
            pending.values[labels] = {**values, **files}
            pending.shown[labels] = {**values, **shown}
        for name, messages in wrong.items():
            setting = pending.method.settings.get(name)
            place = self._namespace.place(setting) if setting else pending.method.place
            for message, hint in itertools.islice(messages.items(), _MOST_VALUES):
                self._problems.add(place, message, hint)
            if len(messages) > _MOST_VALUES:
                more = f"{len(messages) - _MOST_VALUES} more values of {quoted(name)} are not valid"
                self._problems.add(place, f"{pending.where}: {more}")

    def _is_setting(self, where: str, name: str, written: Written, node: Node) -> bool:
        if name in node.settings:
            return True
        hint = partial(nearest, name, node.settings, what="settings")
        message = f"{where}: {node.name} has no setting {quoted(name)}"
        self._problems.add(written.place, message, hint)
        self._namespace.use([written])
        return False

    def _known(self, part: object, labels: Mapping[str, Label]) -> object:
        return self._namespace.value(part, labels) if isinstance(part, Variable) else part

    def _axes(self, settings: Iterable[Written]) -> tuple[str, ...]:
        variables = [variable for written in settings for variable in written.variables()]
        names = {self._namespace.axis_of(variable) for variable in variables}
        return tuple(axis for axis in self._namespace.axes if axis in names) if names else ()

    def _validated(
        self,
        pending: _Pending,
        settings: Mapping[str, object],
        invalid: set[str],
        wrong: defaultdict[str, dict[str, str]],
    ) -> Mapping[str, object]:
        """Return settings with defaults; if any is not valid, none, and add it to `invalid`.

        What is wrong with a setting, and what it is, are added to `wrong`.
        """
        from pydantic import ValidationError

        node = pending.node
        if not node.settings:
            return {}
        try:
            model = node.model.model_validate_json(_encode(settings))
        except ValidationError as error:
            for name, message, hint in _messages(pending.where, pending.method, node, error):
                if name not in invalid:
                    wrong[name][message] = hint
            invalid |= {str(detail["loc"][0]) for detail in error.errors() if detail["loc"]}
            return {}
        return {name: getattr(model, name) for name in node.settings}

    def _files(
        self, pending: _Pending, settings: Mapping[str, object], names: Iterable[str]
    ) -> Mapping[str, Path]:
        """Return the paths of those settings that name a file."""
        files: dict[str, Path] = {}
        for name in names:
            if pending.node.settings[name].is_file and settings[name] is not None:
                path = self._file(pending.where, pending.written[name], str(settings[name]))
                if path is not None:
                    files[name] = path
        return files

    def _file(self, where: str, written: Written, text: str) -> Path | None:
        try:
            shipped = self._registry.hooks.place(text)
        except NodegraphError as error:
            self._problems.add(self._namespace.place(written), f"{where}: {error}")
            return None
        path = shipped or self._namespace.folder(written) / text
        if _exists(path):
            if path.is_file() or path.is_dir():
                return path.resolve()
            message = f"{where}: not a regular file, but a device or a pipe: {text}"
            self._problems.add(self._namespace.place(written), message)
            return None
        hint = nearest(path.name, _names_beside(path), what="in that folder there is")
        if any(sign in text for sign in "*?"):
            hint = f'a pattern is an axis with a label for each file: {{files: "{text}"}}'
        self._problems.add(self._namespace.place(written), f"{where}: no such file: {text}", hint)
        return None


def _messages(
    where: str, method: ResolvedMethod, node: Node, error: ValidationError
) -> Iterator[tuple[str, str, str]]:
    """Yield the name of each invalid setting, what is wrong, and what the setting is."""
    names = set()
    for detail in error.errors():
        if not detail["loc"]:
            yield "", f"{where}: settings of {node.name}: {detail['msg']}", ""
            continue
        name = str(detail["loc"][0])
        if name in names:  # a setting of several types does not fit any of them
            continue
        names.add(name)
        value = detail["input"]
        if detail["type"] == "value_error":  # of a check that the node's author has written
            text = f"{detail['ctx']['error']}".rstrip(".")
            yield name, f"{where}: setting {quoted(name)} of {node.name} is not valid: {text}", ""
            continue
        reason = _REASONS.get(detail["type"]) or f"{_clause(detail['msg'])}, got {quoted(value)}"
        setting = node.settings.get(name)
        unit = f", {setting.unit}" if setting is not None and setting.unit else ""
        hint = f"expected: {setting_kind(node, name)}{unit}" if setting is not None else ""
        kinds = {other["type"] for other in error.errors() if other["loc"][:1] == (name,)}
        if kinds & _LIST_TYPES and isinstance(value, (str, int, float)):
            reason = "is a list" if kinds <= _LIST_TYPES else reason
            written = method.settings[name].value
            hint = (
                f"{hint}; write [{listed([written if isinstance(written, Variable) else value])}]"
            )
        elif isinstance(value, list) and len(detail["loc"]) == 1:
            axis = f"{name}: {value_text(value)}"
            hint = f"{hint}; several values are an axis: axes: {{{axis}}}, and ${name} here"
        yield name, f"{where}: setting {quoted(name)} of {node.name} {reason}", hint


def _clause(message: str) -> str:
    """Return a message of pydantic as the rest of a sentence about a setting."""
    return message.removeprefix("Input ") if message.startswith("Input ") else message.lower()


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:  # a name that is too long, or a folder that may not be read
        return False


def _names_beside(path: Path) -> list[str]:
    try:
        return sorted(entry.name for entry in path.parent.iterdir())
    except OSError:
        return []


def check_names_in_settings(graph: Graph, problems: Problems) -> None:
    """Record settings that name a column, an axis or a label that is known not to exist."""
    for node in graph.nodes.values():
        for method in node.methods.values():
            for name, setting in method.node.settings.items():
                mark = setting.names
                if mark is not None and mark.port in method.inputs:
                    _NameCheck(graph, node, method, name, mark.port, problems).check(mark)


def common_columns(ports: Iterable[Port]) -> tuple[str, ...]:
    """Return the columns of all tables from these outputs; none if one does not declare its."""
    declared = [port.columns for port in ports]
    if not all(declared):
        return ()
    return tuple(dict.fromkeys(name for columns in declared for name in columns))


@dataclass(frozen=True)
class _NameCheck:
    """A setting of a method, and the port whose columns, axes or labels it names."""

    graph: Graph
    node: GraphNode
    method: Method
    setting: str
    port: str
    problems: Problems

    def check(self, mark: ColumnOf | LabelOf) -> None:
        if isinstance(mark, ColumnOf):
            self._check_columns(self._axes if mark.or_axis else ())
            self._check_apart(mark.apart_from)
            if mark.independent:
                self._check_independent()
        else:
            self._check_labels(mark.axis)

    def _check_columns(self, axes: Iterable[str]) -> None:
        columns = common_columns(self._outputs())
        kind, kinds = ("axis or column", "axes and columns") if axes else ("column", "columns")
        known = (*axes, *columns)
        for values in self._values() if columns else ():
            for name in _names(values, self.setting):
                if name not in known:
                    self._add_problem(kind, name, nearest(name, known, what=kinds))

    def _check_apart(self, others: tuple[str, ...]) -> None:
        for values in self._values() if others else ():
            for name in _names(values, self.setting):
                for other in others:
                    if name in _names(values, other):
                        self._add(f"{self.setting} and {other} share a name: {quoted(name)}")

    def _check_independent(self) -> None:
        feed = self.method.inputs[self.port]
        nodes = {source.node for source in sources_of(feed)}
        axes = {self.node.local_name(axis): axis for axis in self.node.gathered}
        differing = {axis for node in nodes for axis in self.graph.source_axes(node)}
        for name in dict.fromkeys(
            name for values in self._values() for name in _names(values, self.setting)
        ):
            if name not in axes:
                continue
            labels = self.graph.axes[axes[name]].labels
            known = [local for local, axis in axes.items() if axis in differing]
            if len(labels) < 2:
                self._add(f"{self.setting}: axis {quoted(name)} has one label, {labels[0]}")
            elif axes[name] not in differing:
                message = f"{self.setting}: the same data are treated along {quoted(name)}"
                self._add(message, f"axes along which they differ: {listed(known)}")

    def _check_labels(self, axis_setting: str) -> None:
        all_labels = tuple(label for labels in self._labels.values() for label in labels)
        for values in self._values():
            axis = values.get(axis_setting)
            labels = self._labels.get(str(axis), ()) if axis is not None else all_labels
            for name in _names(values, self.setting):
                if labels and name not in labels:
                    self._add_problem("label", name, nearest(name, labels, what="labels"))

    def _add_problem(self, kind: str, name: str, hint: str) -> None:
        message = f"{self.setting}: port {quoted(self.port)} has no {kind} {quoted(name)}"
        self._add(message, hint)

    def _add(self, message: str, hint: str = "") -> None:
        where = method_name(self.node.name, self.method.label)
        place = self.method.places.get(self.setting, self.method.place)
        self.problems.add(place, f"{where}: {message}", hint)

    def _values(self) -> Iterable[Mapping[str, object]]:
        return self.method.settings.values.values()

    def _outputs(self) -> Iterator[Port]:
        """Yield the outputs that may feed the port."""
        for source in sources_of(self.method.inputs[self.port]):
            for method in self.graph.nodes[source.node].methods.values():
                yield method.node.output(source.port) or method.node.outputs[0]

    @property
    def _axes(self) -> tuple[str, ...]:
        """The axes that the port gathers, and their fields, by the names that the node sees."""
        axes = {self.node.local_name(axis): axis for axis in self.node.gathered}
        fields = (
            f"{name}.{field}"
            for name in self._labels
            if name in axes
            for field in self.graph.axes[axes[name]].fields
        )
        return (*self._labels, *fields)

    @cached_property
    def _labels(self) -> Mapping[str, tuple[str, ...]]:
        """The labels of each axis that the port gathers, by the name that the node sees.

        Those that the choices have removed are included: a graph may name them.
        """
        feed = self.method.inputs[self.port]
        if not isinstance(feed, Gather):
            return {}
        labels = {feed.axis: tuple(feed.sources)} if feed.axis else {}
        for source in feed.sources.values():
            for name in self.graph.nodes[source.node].axes:
                if name in self.node.gathered and name not in source.at:
                    axis = self.graph.axes[name]
                    known = (*axis.labels, *axis.removed)
                    labels[self.node.local_name(name)] = tuple(map(str, known))
        return labels


def _names(values: Mapping[str, Any], setting: str) -> tuple[str, ...]:
    """Return the names in a setting: none, one or several."""
    value = values.get(setting) or ()
    return (value,) if isinstance(value, str) else tuple(value)
