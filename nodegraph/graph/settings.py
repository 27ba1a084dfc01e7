"""Settings as written -> settings checked, for every combination of the axes they name."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nodegraph.describe import setting_kind
from nodegraph.errors import NodegraphError, Problems, nearest
from nodegraph.graph.choices import Names
from nodegraph.graph.methods import Chosen
from nodegraph.graph.model import Settings
from nodegraph.node import Node
from nodegraph.ports import Label
from nodegraph.registry import Registry
from nodegraph.spec.parts import Variable, Written

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
            placed = self._registry.place(text)
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
