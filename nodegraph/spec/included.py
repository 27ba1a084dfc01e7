"""The graph files that a graph file uses, at any depth: all are read before anything is checked."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path, PurePath

from nodegraph.collection import no_collection
from nodegraph.errors import GraphError, Problems
from nodegraph.spec.file import read_spec, text_of
from nodegraph.spec.parts import GraphSpec, MethodSpec

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
