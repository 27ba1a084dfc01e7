"""Graph file -> spec: what may stand where; every mistake is noted with its place."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from nodegraph.errors import GraphError, Place, Problem, Problems, nearest
from nodegraph.spec.axes import read_axis
from nodegraph.spec.node import NodeReader
from nodegraph.spec.parts import GraphSpec, InputSpec, SkipSpec
from nodegraph.spec.reference import read_reference
from nodegraph.spec.yaml_text import Located, read_yaml

FORMAT = 1
_KEYS = (
    "nodegraph", "title", "notes", "inputs", "axes", "nodes", "skip", "known", "requires",
    "outputs", "report",
)  # fmt: skip
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_MOST_BYTES = 50_000_000


def read_spec(text: str, file: str, folder: Path) -> GraphSpec:
    """Return what the text of one graph file says; the graphs that it uses are not read.

    Parameters
    ----------
    text
    file
        Its name in messages.
    folder
        Where relative paths start.

    Raises
    ------
    GraphError
        If the text is not YAML, or not a mapping. Mistakes in its parts are noted in the spec.
    """
    problems = Problems()
    root = read_yaml(text, file, problems)
    try:
        spec = _SpecReader(root, problems).read(text, file, folder)
    except GraphError as error:
        raise GraphError([*problems.all(), *error.problems]) from error
    return replace(spec, problems=problems.all())


def text_of(path: Path) -> str:
    """Return the text of a graph file.

    Raises
    ------
    GraphError
        If it cannot be read.
    """
    try:
        if path.is_dir():
            there = ", ".join(one.name for one in sorted(path.glob("*.y*ml"))) or "there is none"
            problem = Problem(
                Place(str(path)), "is a folder", f"name the graph file in it: {there}"
            )
            raise GraphError([problem])
        if path.stat().st_size > _MOST_BYTES:
            raise GraphError([Problem(Place(str(path)), "too large to be a graph file")])
        return path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        near = nearest(path.name, [one.name for one in sorted(path.parent.glob("*.y*ml"))])
        problem = Problem(Place(str(path)), "no such graph file", f"in that folder {near}")
        raise GraphError([problem]) from error
    except (OSError, ValueError) as error:  # a name may be too long, a text not UTF-8
        raise GraphError([Problem(Place(str(path)), f"cannot be read: {error}")]) from error


class _SpecReader:
    def __init__(self, root: Located, problems: Problems) -> None:
        self._problems = problems
        self._root = root
        self._sections: Mapping[str, Located] = {}

    def read(self, text: str, file: str, folder: Path) -> GraphSpec:
        self._sections = self._read_sections()
        self._check_names()
        return GraphSpec(
            file=file,
            folder=folder,
            text=text,
            title=self._words("title"),
            notes=self._words("notes"),
            inputs=self._each("inputs", self._input),
            axes=self._each("axes", lambda name, item: read_axis(name, item, self._problems)),
            nodes=self._each("nodes", NodeReader(self._problems).read),
            skip=tuple(one for one in map(self._skip, self._items("skip")) if one),
            known=self._references("known"),
            requires=tuple((str(one.plain()), one.place) for one in self._items("requires")),
            outputs=self._each("outputs", lambda _, item: read_reference(item, self._problems)),
            report=self._references("report"),
        )

    def _read_sections(self) -> Mapping[str, Located]:
        root = self._root
        if not isinstance(root.value, dict):
            message = "a graph file is a mapping that begins with 'nodegraph: 1'"
            raise GraphError([Problem(root.place, message, nearest("", _KEYS, what="keys"))])
        for key in root.value:
            if key not in _KEYS:
                self._problems.add(root.keys[key], f"unknown key {key!r}", nearest(key, _KEYS))
        self._check_format(root)
        nodes = root.value.get("nodes")
        if nodes is None or nodes.value in (None, {}):
            place = root.keys.get("nodes", root.place)
            self._problems.add(place, "no 'nodes': a graph needs at least one")
        return {key: one for key, one in root.value.items() if one.value is not None}

    def _check_format(self, root: Located) -> None:
        found = root.value.get("nodegraph")
        if found is None:
            self._problems.add(root.place, "the format's number is missing", "write 'nodegraph: 1'")
        elif found.value != FORMAT or found.value is True:  # which Python holds for 1
            message = f"this program reads format {FORMAT}, not {found.value!r}"
            self._problems.add(found.place, message)

    def _check_names(self) -> None:
        """Check the one namespace of inputs, axes and nodes."""
        seen: dict[str, str] = {}
        for section in ("inputs", "axes", "nodes"):
            for name, place in self._named(section):
                if self._check_name(name, place) and name in seen:
                    message = f"{name!r} is a name in {section!r} and in {seen[name]!r}"
                    self._problems.add(place, message, "they share one namespace")
                seen.setdefault(name, section)
        for name, place in self._named("outputs"):
            self._check_name(name, place)

    def _check_name(self, name: Any, place: Place) -> bool:
        if isinstance(name, str) and _IDENTIFIER.fullmatch(name):
            return True
        instead = "use letters, digits and _, not a digit first"
        self._problems.add(place, f"{name!r} cannot be a name", instead)
        return False

    def _named(self, section: str) -> list[tuple[Any, Place]]:
        item = self._sections.get(section)
        return list(item.keys.items()) if item and isinstance(item.value, dict) else []

    def _words(self, key: str) -> str:
        item = self._sections.get(key)
        if item is None:
            return ""
        if isinstance(item.value, (dict, list)):
            self._problems.add(item.place, f"{key!r} must be text")
            return ""
        return str(item.value)

    def _each(self, key: str, read: Callable[[str, Located], Any]) -> dict[str, Any]:
        item = self._sections.get(key)
        if item is None:
            return {}
        if not isinstance(item.value, dict):
            self._problems.add(item.place, f"{key!r} must be a mapping: name: ...")
            return {}
        made = {str(name): read(str(name), one) for name, one in item.value.items()}
        return {name: one for name, one in made.items() if one is not None}

    def _items(self, key: str) -> list[Located]:
        item = self._sections.get(key)
        if item is None:
            return []
        if not isinstance(item.value, list):
            self._problems.add(item.place, f"{key!r} must be a list: [...]")
            return []
        return item.value

    def _references(self, key: str) -> tuple[Any, ...]:
        found = (read_reference(one, self._problems) for one in self._items(key))
        return tuple(one for one in found if one is not None)

    def _input(self, name: str, item: Located) -> InputSpec:
        return InputSpec(name, item.place, item.plain())

    def _skip(self, item: Located) -> SkipSpec | None:
        if not isinstance(item.value, dict) or not item.value:
            self._problems.add(item.place, "an item of 'skip' is {axis: label or [labels], ...}")
            return None
        labels = {
            str(axis): tuple(
                one.plain() for one in (found.value if isinstance(found.value, list) else [found])
            )
            for axis, found in item.value.items()
        }
        return SkipSpec(item.place, labels)
