"""Settings as written -> settings checked, for every combination of the axes they name."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nodegraph.errors import NodegraphError, Problems, nearest
from nodegraph.graph.choices import Names
from nodegraph.graph.methods import Chosen
from nodegraph.graph.model import Gather, Graph, GraphNode, Method, Settings, sources_of
from nodegraph.graphfile.spec import Reference, Variable, Written
from nodegraph.node.decorator import Node
from nodegraph.node.description import setting_kind
from nodegraph.node.ports import ColumnOf, Label, LabelOf, Port
from nodegraph.plugin.registry import Registry

if TYPE_CHECKING:
    from pydantic import ValidationError


_encode = json.JSONEncoder(default=str).encode
_ADVICE = {
    "missing": "must be given",
    "extra_forbidden": "is not a setting of this node",
}


@dataclass(frozen=True, slots=True)
class _Unread:
    """Settings of one method, with where their values go."""

    where: str
    chosen: Chosen
    node: Node
    known: Mapping[str, Written]
    axes: tuple[str, ...]
    values: dict[tuple[Label, ...], Mapping[str, Any]]
    shown: dict[tuple[Label, ...], Mapping[str, Any]]


class SettingsReader:
    """Checks settings and notes every mistake with its place."""

    def __init__(self, names: Names, registry: Registry, problems: Problems) -> None:
        self._names = names
        self._registry = registry
        self._problems = problems
        self._defaults: dict[Node, Settings] = {}
        self._unread: list[_Unread] = []

    def read(self, where: str, chosen: Chosen, node: Node) -> Settings:
        """Return the settings of one method, whose values are still to come.

        `where` names it in messages.
        """
        if chosen.settings or any(one.required for one in node.settings.values()):
            return self._read(where, chosen, node)
        if node not in self._defaults:
            self._defaults[node] = self._read(where, chosen, node)
        return self._defaults[node]

    def _read(self, where: str, chosen: Chosen, node: Node) -> Settings:
        known = {
            n: one for n, one in chosen.settings.items() if self._is_known(where, n, one, node)
        }
        axes = self._axes(known)
        unread = _Unread(where, chosen, node, known, axes, {}, {})
        self._unread.append(unread)
        return Settings(axes, unread.values, unread.shown)

    def fill(self, *, in_full: bool) -> None:
        """Check the values of all settings that were read, at every label.

        Of more combinations than can be run, which is told, the first alone shows other mistakes.
        """
        for unread in self._unread:
            self._fill(unread, in_full=in_full)
        self._unread.clear()

    def _fill(self, unread: _Unread, *, in_full: bool) -> None:
        known, axes = unread.known, unread.axes
        sound, along = known, axes
        if self._names.unknown:
            sound = {name: one for name, one in known.items() if self._is_sound(one)}
            along = self._axes(sound)
        every = itertools.product(*(self._names.axes[axis].labels for axis in along))
        for labels in every if in_full else itertools.islice(every, 1):
            given = {
                name: self._substituted(one.value, dict(zip(along, labels, strict=True)))
                for name, one in sound.items()
            }
            wrong = known.keys() - sound.keys()
            checked = self._checked(unread.where, unread.chosen, unread.node, given, wrong)
            files = self._files(unread.where, unread.node, sound, given, wrong)
            unread.values[labels] = {**checked, **files}
            unread.shown[labels] = {**checked, **given}

    def _is_sound(self, written: Written) -> bool:
        return self._names.unknown.isdisjoint(written.variables())

    def _is_known(self, where: str, name: str, written: Written, node: Node) -> bool:
        if name in node.settings:
            return True
        hint = nearest(name, node.settings, what="settings")
        self._problems.add(written.place, f"{where}: {node.name} has no setting {name!r}", hint)
        self._names.use([written])
        return False

    def _axes(self, known: Mapping[str, Written]) -> tuple[str, ...]:
        variables = [one for written in known.values() for one in written.variables()]
        named = {self._names.axis_of(variable) for variable in variables}
        return tuple(axis for axis in self._names.axes if axis in named)

    def _substituted(self, value: Any, labels: Mapping[str, Label]) -> Any:
        if isinstance(value, Variable):
            return self._names.value(value, labels)
        if isinstance(value, dict):
            return {key: self._substituted(one, labels) for key, one in value.items()}
        if isinstance(value, list):
            return [self._substituted(one, labels) for one in value]
        return value

    def _checked(
        self, where: str, chosen: Chosen, node: Node, given: Mapping[str, Any], wrong: set[str]
    ) -> Mapping[str, Any]:
        """Return settings checked, or none; add to `wrong` those that are."""
        from pydantic import ValidationError

        if not node.settings:
            return {}
        try:
            model = node.model.model_validate_json(_encode(given))
        except ValidationError as error:
            for name, message, hint in _complaints(where, node, error):
                if name in wrong:
                    continue
                written = chosen.settings.get(name)
                place = self._names.place(written) if written else chosen.place
                self._problems.add(place, message, hint)
            wrong |= {str(one["loc"][0]) for one in error.errors() if one["loc"]}
            return {}
        return {name: getattr(model, name) for name in node.settings}

    def _files(
        self,
        where: str,
        node: Node,
        written: Mapping[str, Written],
        given: Mapping[str, Any],
        wrong: set[str],
    ) -> Mapping[str, Path]:
        found: dict[str, Path] = {}
        for name, one in written.items():
            if node.settings[name].is_file and name not in wrong and given[name] is not None:
                path = self._file(where, one, str(given[name]))
                if path is not None:
                    found[name] = path
        return found

    def _file(self, where: str, written: Written, text: str) -> Path | None:
        try:
            placed = self._registry.hooks.place(text)
        except NodegraphError as error:
            self._problems.add(self._names.place(written), f"{where}: {error}")
            return None
        path = placed or self._folder(written) / text
        if _exists(path):
            return path.resolve()
        hint = nearest(path.name, _names_beside(path), what="in that folder there is")
        self._problems.add(self._names.place(written), f"{where}: no such file: {text}", hint)
        return None

    def _folder(self, written: Written) -> Path:
        if isinstance(written.value, Variable):
            return self._names.folder(written.value)
        return written.folder or self._names.graph_folder


def _complaints(where: str, node: Node, error: ValidationError) -> Iterator[tuple[str, str, str]]:
    """Yield the setting that pydantic complains of, what is wrong, and what there is."""
    for one in error.errors():
        if not one["loc"]:
            yield "", f"{where}: settings of {node.name}: {one['msg']}", ""
            continue
        name = str(one["loc"][0])
        said = _ADVICE.get(one["type"]) or f"{_lower(one['msg'])}, got {one['input']!r}"
        setting = node.settings.get(name)
        unit = f" {setting.unit}" if setting is not None and setting.unit else ""
        hint = f"it is {setting_kind(node, name)}{unit}" if setting is not None else ""
        yield name, f"{where}: setting {name!r} of {node.name} {said}", hint


def _lower(message: str) -> str:
    return message.removeprefix("Input ") if message.startswith("Input ") else message.lower()


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:  # a name that is too long, or a folder that may not be read
        return False


def _names_beside(path: Path) -> list[str]:
    try:
        return sorted(one.name for one in path.parent.iterdir())
    except OSError:
        return []


def check_named(graph: Graph, problems: Problems) -> None:
    """Note settings that name a column, an axis or a label which is known not to be there."""
    for node in graph.nodes.values():
        for method in node.methods.values():
            for name, setting in method.node.settings.items():
                mark = setting.names
                if mark is not None and mark.port in method.inputs:
                    _Named(graph, node, method, name, mark.port, problems).check(mark)


def columns_of(ports: Iterable[Port]) -> tuple[str, ...]:
    """Return the columns of all tables that come from these; none if one does not declare its."""
    declared = [port.columns for port in ports]
    if not all(declared):
        return ()
    return tuple(dict.fromkeys(name for columns in declared for name in columns))


@dataclass(frozen=True)
class _Named:
    """A setting of a method, and what the port gets whose columns, axes or labels it names."""

    graph: Graph
    node: GraphNode
    method: Method
    setting: str
    port: str
    problems: Problems

    def check(self, mark: ColumnOf | LabelOf) -> None:
        if isinstance(mark, ColumnOf):
            self._check_columns(self._labels if mark.or_axis else {})
        else:
            self._check_labels(mark.axis)

    def _check_columns(self, axes: Iterable[str]) -> None:
        columns = columns_of(self._sources())
        what = ("axis or column", "axes and columns") if axes else ("column", "columns")
        known = (*axes, *columns)
        for values in self._values() if columns else ():
            for name in _texts(values, self.setting):
                if name not in known:
                    self._note(what[0], name, nearest(name, known, what=what[1]))

    def _check_labels(self, axis: str) -> None:
        every = tuple(label for labels in self._labels.values() for label in labels)
        for values in self._values():
            chosen = values.get(axis)
            there = self._labels.get(str(chosen), ()) if chosen is not None else every
            for name in _texts(values, self.setting):
                if there and name not in there:
                    self._note("label", name, nearest(name, there, what="labels"))

    def _note(self, what: str, name: str, there: str) -> None:
        label = self.method.label
        where = f"{self.node.name} ({label})" if label else self.node.name
        place = self.method.places.get(self.setting, self.method.place)
        message = f"{where}: {self.setting}: port {self.port!r} has no {what} {name!r}"
        self.problems.add(place, message, there)

    def _values(self) -> Iterable[Mapping[str, Any]]:
        return self.method.settings.values.values()

    @property
    def _fed(self) -> Reference | Gather:
        return self.method.inputs[self.port]

    def _sources(self) -> Iterator[Port]:
        """Yield the outputs that may feed the port."""
        for source in sources_of(self._fed):
            for method in self.graph.nodes[source.node].methods.values():
                yield method.node.output(source.port) or method.node.outputs[0]

    @cached_property
    def _labels(self) -> Mapping[str, tuple[str, ...]]:
        """The labels of each axis that the port gathers, as the node sees it.

        What the command has taken away is no mistake of who wrote the graph.
        """
        if not isinstance(self._fed, Gather):
            return {}
        found = {self._fed.axis: tuple(self._fed.sources)} if self._fed.axis else {}
        for source in sources_of(self._fed):
            for name in self.graph.nodes[source.node].axes:
                if name in self.node.gathered and name not in source.at:
                    axis = self.graph.axes[name]
                    found[self.node.inside(name)] = tuple(map(str, (*axis.labels, *axis.removed)))
        return found


def _texts(values: Mapping[str, Any], setting: str) -> tuple[str, ...]:
    """Return what a setting names: nothing, one or several."""
    given = values.get(setting) or ()
    return (given,) if isinstance(given, str) else tuple(given)
