"""Graph file -> spec, with the graph files that it uses; every error is noted with its place."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path, PurePath
from typing import Any

from nodegraph.errors import GraphError, Hint, Place, Problem, Problems, nearest, quoted
from nodegraph.gc_pause import gc_paused
from nodegraph.graphfile.axes import read_axis
from nodegraph.graphfile.keys import FORMAT, IDENTIFIER, IDENTIFIER_HINT, TOP_LEVEL, Form
from nodegraph.graphfile.nodes import (
    NodeReader,
    instead_of_key,
    read_reference,
    read_report_entry,
    read_text,
)
from nodegraph.graphfile.spec import (
    GraphSpec,
    InputSpec,
    MethodSpec,
    Reference,
    ReportEntry,
    SkipSpec,
)
from nodegraph.graphfile.yaml_text import Located, read_yaml

MOST_DEPTH = 50
MOST_NODES = 100_000
MOST_LABELS = 5_000_000
_MOST_BYTES = 50_000_000
_IDENTIFIER = re.compile(IDENTIFIER)
_Chain = tuple[tuple[Path, str], ...]
"""Graph files that use each other, from the outermost: path, and name in messages."""


def read_graph_file(path: Path) -> GraphSpec:
    """Return the spec of a graph file, with those of the graph files that it uses.

    Errors in its parts, and in the files that it uses, are noted in the spec.

    Raises
    ------
    GraphError
        If the file cannot be read, or is not YAML, or not a mapping.
    """
    return read_graph_text(_text_of(path), str(path), path.parent)


@gc_paused()
def read_graph_text(
    text: str, file: str, folder: Path, included: Mapping[str, str] | None = None
) -> GraphSpec:
    """Return the spec of a graph file's text; see `read_graph_file`.

    Parameters
    ----------
    text
    file
        Its name in messages.
    folder
        Where relative paths start.
    included
        Texts of graph files that it uses, by path from the folder, which replace the files' own.
    """
    spec = _read_spec(text, file, folder)
    texts = {(folder / name).resolve(): each for name, each in (included or {}).items()}
    return _UsedGraphs(spec, texts).read() if any(_graph_uses(spec)) else spec


def _text_of(path: Path) -> str:
    """Return the text of a graph file, or raise a `GraphError` that names what there is instead."""
    place = Place(str(path))
    try:
        if path.is_dir():
            names = ", ".join(file.name for file in _graph_files(path)) or "there is none"
            problem = Problem(place, "is a folder", f"name the graph file in it: {names}")
            raise GraphError([problem])
        if path.exists() and not path.is_file():
            raise GraphError([Problem(place, "is not a regular file, but a device or a pipe")])
        if path.stat().st_size > _MOST_BYTES:
            raise GraphError([Problem(place, "too large to be a graph file")])
        return path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise GraphError([Problem(place, "no such graph file", partial(_beside, path))]) from error
    except UnicodeDecodeError as error:
        raise GraphError([not_utf8(path, error)]) from error
    except (OSError, ValueError) as error:  # a name may be too long
        raise GraphError([Problem(place, f"cannot be read: {error}")]) from error


def not_utf8(path: Path, error: UnicodeDecodeError) -> Problem:
    """Return the error of a file with a byte that no text in UTF-8 has there."""
    before = error.object[: error.start]
    column = len(before[before.rfind(b"\n") + 1 :].decode()) + 1
    place = Place(str(path), before.count(b"\n") + 1, column)
    byte = error.object[error.start]
    return Problem(place, f"not text in UTF-8: byte 0x{byte:02x}", "save the file in UTF-8")


def _beside(path: Path) -> str:
    """Return the graph files in the folder of a file that is not there, and the nearest name."""
    files = _graph_files(path.parent)
    name = next((file.name for file in files if file.stem == path.name), path.name)
    return nearest(name, [file.name for file in files], what="in that folder there is")


def _graph_files(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.y*ml"))


def _read_spec(text: str, file: str, folder: Path) -> GraphSpec:
    """Return the spec of one text; the graph files that it uses are not read."""
    problems = Problems()
    root = read_yaml(text, file, problems)
    try:
        spec = _SpecReader(root, problems).read(text, file, folder)
    except GraphError as error:
        raise GraphError([*problems.all(), *error.problems]) from error
    return replace(spec, problems=problems.all())


def _has_nodes(root: Located) -> bool:
    nodes = root.value.get("nodes")
    return nodes is not None and nodes.value not in (None, {})


class _SpecReader:
    def __init__(self, root: Located, problems: Problems) -> None:
        self._root = root
        self._problems = problems
        self._sections: Mapping[str, Located] = {}
        self._folder = Path()

    def read(self, text: str, file: str, folder: Path) -> GraphSpec:
        self._sections = self._read_sections()
        self._folder = folder
        self._check_names()
        readers: Mapping[Form, Callable[[str], Any]] = {
            Form.TEXT: self._text,
            Form.INPUTS: lambda key: self._mapping(key, self._input),
            Form.AXES: lambda key: self._mapping(key, self._axis),
            Form.NODES: lambda key: self._mapping(key, NodeReader(self._problems).read),
            Form.COMBINATIONS: lambda key: self._list(key, self._combination),
            Form.REFERENCES: lambda key: self._list(key, self._reference),
            Form.REPORT: lambda key: self._list(key, self._report_entry),
            Form.DISTRIBUTIONS: lambda key: self._list(key, self._distribution),
            Form.OUTPUTS: lambda key: self._mapping(key, lambda _, item: self._reference(item)),
        }
        sections = {
            name: readers[key.form](name)
            for name, key in TOP_LEVEL.items()
            if key.form is not Form.NUMBER  # which is checked, and not part of the spec
        }
        return GraphSpec(file=file, folder=folder, text=text, **sections)

    def _read_sections(self) -> Mapping[str, Located]:
        root = self._root
        if not isinstance(root.value, dict):
            message = "a graph file is a mapping that begins with 'nodegraph: 1'"
            raise GraphError([Problem(root.place, message, nearest("", TOP_LEVEL, what="keys"))])
        for key in root.value:
            if key not in TOP_LEVEL:
                hint: Hint = partial(instead_of_key, key, TOP_LEVEL)
                if isinstance(root.value[key].value, dict) and not _has_nodes(root):
                    hint = "indent it, if it is one of 'nodes'"
                self._problems.add(root.keys[key], f"unknown key {quoted(key)}", hint)
        self._check_format(root)
        if not _has_nodes(root):
            place = root.keys.get("nodes", root.place)
            self._problems.add(place, "no 'nodes': a graph needs at least one")
        return {key: item for key, item in root.value.items() if item.value is not None}

    def _check_format(self, root: Located) -> None:
        number = root.value.get("nodegraph")
        if number is None:
            hint = f"write 'nodegraph: {FORMAT}'"
            self._problems.add(root.place, "the format's number is missing", hint)
        elif number.value != FORMAT or number.value is True:  # which Python takes for 1
            message = f"this version reads format {FORMAT}, not {quoted(number.value)}"
            self._problems.add(number.place, message)

    def _check_names(self) -> None:
        """Check the names of inputs, axes and nodes, which share a namespace, and of outputs."""
        seen: dict[str, str] = {}
        for section in ("inputs", "axes", "nodes"):
            for name, place in self._names(section):
                if self._check_name(name, place) and name in seen:
                    message = (
                        f"{quoted(name)} is a name in {quoted(section)} and in {quoted(seen[name])}"
                    )
                    self._problems.add(place, message, "they share one namespace")
                seen.setdefault(name, section)
        for name, place in self._names("outputs"):
            self._check_name(name, place)

    def _check_name(self, name: object, place: Place) -> bool:
        if isinstance(name, str) and _IDENTIFIER.fullmatch(name):
            return True
        self._problems.add(place, f"{quoted(name)} cannot be a name", IDENTIFIER_HINT)
        return False

    def _names(self, section: str) -> list[tuple[Any, Place]]:
        item = self._sections.get(section)
        return list(item.keys.items()) if item and isinstance(item.value, dict) else []

    def _text(self, key: str) -> str:
        return read_text(key, self._sections.get(key), self._problems)

    def _mapping(self, key: str, read: Callable[[str, Located], object]) -> dict[str, object]:
        section = self._sections.get(key)
        if section is None:
            return {}
        if not isinstance(section.value, dict):
            self._problems.add(section.place, f"{quoted(key)} must be a mapping: name: ...")
            return {}
        items = {str(name): read(str(name), item) for name, item in section.value.items()}
        return {name: item for name, item in items.items() if item is not None}

    def _list(self, key: str, read: Callable[[Located], object]) -> tuple[object, ...]:
        section = self._sections.get(key)
        if section is None:
            return ()
        if not isinstance(section.value, list):
            self._problems.add(section.place, f"{quoted(key)} must be a list: [...]")
            return ()
        return tuple(item for item in map(read, section.value) if item is not None)

    def _input(self, name: str, item: Located) -> InputSpec:
        return InputSpec(name, item.place, item.plain())

    def _axis(self, name: str, item: Located) -> object:
        return read_axis(name, item, self._folder, self._problems)

    def _reference(self, item: Located) -> Reference | None:
        return read_reference(item, self._problems)

    def _report_entry(self, item: Located) -> ReportEntry | None:
        return read_report_entry(item, self._problems)

    def _distribution(self, item: Located) -> tuple[str, Place]:
        return str(item.plain()), item.place

    def _combination(self, item: Located) -> SkipSpec | None:
        if not isinstance(item.value, dict) or not item.value:
            self._problems.add(item.place, "an item of 'skip' is {axis: label or [labels], ...}")
            return None
        labels = {
            str(axis): tuple(
                label.plain()
                for label in (value.value if isinstance(value.value, list) else [value])
            )
            for axis, value in item.value.items()
        }
        return SkipSpec(item.place, labels)


@dataclass(frozen=True)
class _Size:
    """The size of a graph with those that it uses, and their depth; or that it is too much."""

    nodes: int
    labels: int
    depth: int = 0
    is_refused: bool = False

    def __add__(self, used: _Size) -> _Size:
        depth = max(self.depth, used.depth + 1)
        return _Size(self.nodes + used.nodes, self.labels + used.labels, depth)


class _UsedGraphs:
    """Reads the graph files that a graph uses, each once, and refuses circles and giants."""

    def __init__(self, root: GraphSpec, texts: Mapping[Path, str]) -> None:
        self._root = root
        self._texts = texts
        self._problems = Problems(root.problems)
        self._specs: dict[Path, GraphSpec] = {}
        self._sizes: dict[Path, _Size | None] = {}  # None for a file that could not be read

    def read(self) -> GraphSpec:
        root = self._root
        path = (root.folder / PurePath(root.file).name).resolve()
        spec, _ = self._resolved(root, ((path, root.file),))
        return replace(spec, graphs=self._specs, problems=self._problems.all())

    def _resolved(self, spec: GraphSpec, chain: _Chain) -> tuple[GraphSpec, _Size]:
        """Return a spec with the paths of the graph files that it uses, and its size.

        A spec that is too large uses none, nor is it used: the error is noted once, where the
        limit is passed.
        """
        uses: dict[str, Path] = {}
        size = _Size(len(spec.nodes), sum(len(axis.labels) for axis in spec.axes.values()))
        for method in _graph_uses(spec):
            path = self._path(spec, method)
            used = self._size(spec, method, path, chain) if path is not None else None
            if path is None or used is None:
                continue
            size += used
            if used.is_refused or self._is_too_large(method, size, chain):
                return spec, replace(size, is_refused=True)
            uses[method.use] = path
        return replace(spec, uses=uses), size

    def _path(self, spec: GraphSpec, method: MethodSpec) -> Path | None:
        try:
            return (spec.folder / method.use).resolve()
        except (OSError, ValueError, RuntimeError) as error:
            self._problems.add(method.place, f"{quoted(method.use)} cannot be read: {error}")
            return None

    def _size(self, spec: GraphSpec, method: MethodSpec, path: Path, chain: _Chain) -> _Size | None:
        """Return the size of a used graph, which is read at its first use."""
        paths = [each for each, _ in chain]
        if path in paths:
            circle = [name for _, name in chain[paths.index(path) :]]
            names = " -> ".join([*circle, circle[0]])
            self._problems.add(method.place, f"{circle[0]} uses itself: {names}")
            return None
        if len(chain) > MOST_DEPTH:
            return _Size(0, 0)  # it is refused for its depth, and not read
        if path not in self._sizes:
            self._read(spec, method, path, chain)
        return self._sizes.get(path)

    def _read(self, spec: GraphSpec, method: MethodSpec, path: Path, chain: _Chain) -> None:
        try:
            text = self._texts[path] if path in self._texts else _text_of(path)
        except GraphError as error:
            for problem in error.problems:
                message = f"{problem.place._replace(file=method.use)}: {problem.message}"
                self._problems.add(method.place, message, problem.hint)
            return
        name = os.path.normpath(os.path.join(os.path.dirname(spec.file), method.use))
        self._sizes[path] = None
        try:
            used = _read_spec(text, name, path.parent)
        except GraphError as error:
            self._problems.extend(error.problems)
            return
        self._specs[path], self._sizes[path] = self._resolved(used, (*chain, (path, name)))

    def _is_too_large(self, method: MethodSpec, size: _Size, chain: _Chain) -> bool:
        message = ""
        if size.depth + len(chain) - 1 > MOST_DEPTH:
            message = f"graphs use graphs more than {MOST_DEPTH} deep"
        elif size.nodes > MOST_NODES:
            message = f"more than {MOST_NODES:,} nodes, those of the graphs that it uses included"
        elif size.labels > MOST_LABELS:
            message = f"more than {MOST_LABELS:,} labels on the axes of the graphs that it uses"
        if message:
            self._problems.add(method.place, f"{method.use}: {message}")
        return bool(message)


def _graph_uses(spec: GraphSpec) -> Iterator[MethodSpec]:
    return (method for node in spec.nodes.values() for method in node.methods if method.is_graph)
