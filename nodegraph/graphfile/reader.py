"""Graph file -> spec: what may stand where; every mistake is noted with its place."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path, PurePath
from typing import Any

from nodegraph.errors import GraphError, Place, Problem, Problems, nearest
from nodegraph.gc_pause import no_collection
from nodegraph.graphfile.axes import read_axis
from nodegraph.graphfile.nodes import NodeReader, read_reference
from nodegraph.graphfile.spec import GraphSpec, InputSpec, MethodSpec, SkipSpec
from nodegraph.graphfile.yaml_text import Located, read_yaml

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


MOST_DEPTH = 50
MOST_NODES = 100_000
MOST_LABELS = 5_000_000
_Way = tuple[tuple[Path, str], ...]


def read_graph_file(path: Path) -> GraphSpec:
    """Return what a graph file says, with the graph files that it uses.

    Mistakes in its parts, and in finding the others, are noted in it.

    Raises
    ------
    GraphError
        If the file cannot be read, or is not YAML, or not a mapping.
    """
    return read_graph_text(text_of(path), str(path), path.parent)


@no_collection()
def read_graph_text(
    text: str, file: str, folder: Path, included: Mapping[str, str] | None = None
) -> GraphSpec:
    """Return what the text of a graph file says; relative paths start at `folder`.

    Of graph files that it uses, `included` holds texts that are taken in place of what the files
    say, by their paths from the folder.
    """
    spec = read_spec(text, file, folder)
    texts = {(folder / name).resolve(): one for name, one in (included or {}).items()}
    return _Reader(spec, texts).read() if any(_graph_uses(spec)) else spec


@dataclass(frozen=True)
class _Size:
    """How much a graph unfolds to, and how deep; or that it is too much."""

    nodes: int
    labels: int
    depth: int = 0
    is_refused: bool = False

    def __add__(self, used: _Size) -> _Size:
        depth = max(self.depth, used.depth + 1)
        return _Size(self.nodes + used.nodes, self.labels + used.labels, depth)


class _Reader:
    def __init__(self, root: GraphSpec, texts: Mapping[Path, str]) -> None:
        self._root = root
        self._texts = texts
        self._problems = Problems(root.problems)
        self._specs: dict[Path, GraphSpec] = {}
        self._sizes: dict[Path, _Size | None] = {}  # None for a file that could not be read

    def read(self) -> GraphSpec:
        root = self._root
        path = (root.folder / PurePath(root.file).name).resolve()
        whole, _ = self._followed(root, ((path, root.file),))
        return replace(whole, graphs=self._specs, problems=self._problems.all())

    def _followed(self, spec: GraphSpec, way: _Way) -> tuple[GraphSpec, _Size]:
        """Return a spec that knows where the graphs lie that it uses, and its size.

        One that is too large uses none, nor is it used: that is told once, where it grew so.
        """
        uses: dict[str, Path] = {}
        size = _Size(len(spec.nodes), sum(len(one.labels) for one in spec.axes.values()))
        for method in _graph_uses(spec):
            path = self._path(spec, method)
            used = self._size(spec, method, path, way) if path is not None else None
            if path is None or used is None:
                continue
            size += used
            if used.is_refused or self._is_too_large(method, size, way):
                return spec, replace(size, is_refused=True)
            uses[method.use] = path
        return replace(spec, uses=uses), size

    def _path(self, spec: GraphSpec, method: MethodSpec) -> Path | None:
        try:
            return (spec.folder / method.use).resolve()
        except (OSError, ValueError, RuntimeError) as error:
            self._problems.add(method.place, f"{method.use!r} cannot be read: {error}")
            return None

    def _size(self, spec: GraphSpec, method: MethodSpec, path: Path, way: _Way) -> _Size | None:
        """Return the size of a used graph, which is read when it is met first."""
        paths = [there for there, _ in way]
        if path in paths:
            around = [shown for _, shown in way[paths.index(path) :]]
            names = " -> ".join([*around, around[0]])
            self._problems.add(method.place, f"{around[0]} uses itself: {names}")
            return None
        if len(way) > MOST_DEPTH:
            return _Size(0, 0)  # it is refused for its depth, and not read
        if path not in self._sizes:
            self._read(spec, method, path, way)
        return self._sizes.get(path)

    def _read(self, spec: GraphSpec, method: MethodSpec, path: Path, way: _Way) -> None:
        try:
            text = self._texts[path] if path in self._texts else text_of(path)
        except GraphError as error:
            for one in error.problems:
                self._problems.add(method.place, f"{method.use}: {one.message}", one.instead)
            return
        shown = os.path.normpath(os.path.join(os.path.dirname(spec.file), method.use))
        self._sizes[path] = None
        try:
            found = read_spec(text, shown, path.parent)
        except GraphError as error:
            for one in error.problems:
                self._problems.add(one.place, one.message, one.instead)
            return
        self._specs[path], self._sizes[path] = self._followed(found, (*way, (path, shown)))

    def _is_too_large(self, method: MethodSpec, size: _Size, way: _Way) -> bool:
        said = ""
        if size.depth + len(way) - 1 > MOST_DEPTH:
            said = f"graphs use graphs more than {MOST_DEPTH} deep"
        elif size.nodes > MOST_NODES:
            said = f"more than {MOST_NODES:,} nodes, those of the graphs that it uses included"
        elif size.labels > MOST_LABELS:
            said = f"more than {MOST_LABELS:,} labels on the axes of the graphs that it uses"
        if said:
            self._problems.add(method.place, f"{method.use}: {said}")
        return bool(said)


def _graph_uses(spec: GraphSpec) -> Iterator[MethodSpec]:
    return (one for node in spec.nodes.values() for one in node.methods if one.is_graph)
