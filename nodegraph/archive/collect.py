"""Collect the contents of an archive: graph, inputs, results and plugins of a run."""

from __future__ import annotations

import posixpath
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path, PurePath

from nodegraph.archive.contents import CITATION, METADATA, README, RUN, Contents, readme
from nodegraph.archive.inputs import PLUGINS, ArchivedInput, RunFolders, files_read, free_name
from nodegraph.archive.relocate import Relocation, local_folders, relocate_graph, relocate_settings
from nodegraph.errors import NodegraphError, listed
from nodegraph.filenames import fold, portable_paths
from nodegraph.lock.lockfile import read_lock
from nodegraph.plugin.registry import Registry
from nodegraph.report.paper_texts import cited
from nodegraph.report.study import Study, read_study
from nodegraph.runs.folder import graph_name
from nodegraph.runs.record import Record
from nodegraph.runs.record_files import read_record

MOST_BYTES = 100_000_000
"""Size of the largest input in an archive."""

_GRAPHS = "graphs"


def contents_of(
    folder: Path, registry: Registry, *, lock: Path | None = None, with_inputs: bool = True
) -> Contents:
    """Return the contents of the archive of a run.

    Parameters
    ----------
    folder
        The folder of the run.
    registry
        Knows the files that plugins ship.
    lock
        A lock to include; by default the one beside the graph, if it exists.
    with_inputs
        Whether to include the files that the run read, or only their digests.

    Raises
    ------
    NodegraphError
        If there is no finished run, or if the lock is missing or of another run.
    """
    record, study = read_record(folder), read_study(folder)
    return _Collector(folder, record, study, registry, with_inputs=with_inputs).contents(lock)


class _Collector:
    def __init__(
        self,
        folder: Path,
        record: Record,
        study: Study,
        registry: Registry,
        *,
        with_inputs: bool,
    ) -> None:
        self._folder = folder
        self._record = record
        self._study = study
        self._with_inputs = with_inputs
        self._origin = RunFolders(record)
        self._graph, self._home = self._origin.graph, self._origin.home
        self._plugins = list(self._origin.plugins())
        self._graphs = _used_graphs(record.included)
        reserved = {RUN, CITATION, PLUGINS, _GRAPHS, README, METADATA, self._graph.name}
        self._inputs = files_read(
            record.steps,
            self._origin.folders(),
            reserved,
            registry.hooks.is_place,
        )
        self._contents = Contents(self._graph.name, study, record, inputs=self._inputs)

    def contents(self, lock: Path | None) -> Contents:
        contents = self._contents
        names = {file.written: file.name for file in self._inputs}
        names |= {plugin.written: plugin.name for plugin in self._plugins}
        settings = relocate_settings(self._record.settings, self._graph.name, names)
        contents.command = settings.command
        texts = (self._study.graph_text, *self._record.included.values())
        relocation = Relocation(
            self._replacements(contents.command),
            local_folders(self._record, texts, self._folders()),
        )
        contents.relocation = relocation
        self._add_graphs(relocation)
        self._add_plugins()
        self._add_inputs()
        self._add_lock(lock)
        paths = {
            path.relative_to(self._folder).as_posix(): path
            for path in sorted(self._folder.rglob("*"))
        }
        portable = portable_paths(name for name, path in paths.items() if path.is_file())
        for name, path in paths.items():
            if path.is_symlink():  # which may lead to any file of the user
                contents.missing.append(f"{RUN}/{name}: a symbolic link, left out")
            elif portable.get(name, name) != name:
                shown = repr(f"{RUN}/{name}")
                contents.missing.append(f"{shown}: a name that not every system takes, left out")
            elif path.is_file() and name not in (graph_name(self._graphs), *self._graphs):
                contents.files[f"{RUN}/{name}"] = self._relocated(name, path.read_bytes())
        contents.missing += [
            f"{RUN}/{file.file}: not written at the end of the run: {file.reason}"
            for file in self._record.not_written
        ]
        for name, text in cited(self._study).items():
            contents.files[f"{CITATION}/{name}"] = relocation.encoded(text)
        contents.files[README] = relocation.encoded(readme(contents))
        return contents

    def _replacements(self, command: str) -> dict[str, str]:
        """Return texts of the archive by texts of the run."""
        plugins = {str(plugin.path): plugin.name for plugin in self._plugins}
        paths = {str(file.path.absolute()): file.name for file in self._inputs if file.path}
        absolute = {
            file.written: file.name for file in self._inputs if Path(file.written).is_absolute()
        }
        return {self._record.command: command, **plugins, **paths, **absolute}

    def _folders(self) -> Iterator[Path]:
        yield from (self._home, self._origin.folder, self._folder, self._folder.parent)
        yield from (Path(plugin.path).parent for plugin in self._record.plugins)
        if self._record.settings.store:
            yield Path(self._record.settings.store)

    def _add_graphs(self, relocation: Relocation) -> None:
        names = {
            str(Path(self._home / file.written)): file.name
            for file in self._inputs
            if not file.is_shipped
        }
        names |= {str(file.path): file.name for file in self._inputs if file.path}
        names |= {str(self._home / written): name for written, name in self._graphs.items()}
        names = {posixpath.normpath(path): name for path, name in names.items()}
        texts = {"": (self._study.graph_text, self._graph.name)} | {
            name: (text, self._graphs[name]) for name, text in self._record.included.items()
        }
        for written, (text, name) in texts.items():
            folder = self._home / Path(written).parent
            relocated = relocate_graph(text, folder, name, names)
            self._contents.files[name] = relocation.text(relocated).encode()

    def _add_plugins(self) -> None:
        for plugin in self._plugins:
            if plugin.content is None:
                reason = self._origin.why_missing(plugin.written)
                self._contents.missing.append(f"plugin {plugin.name}: {reason}")
            else:
                self._contents.files[plugin.name] = plugin.content

    def _add_inputs(self) -> None:
        for file in self._inputs:
            if reason := self._why_missing(file):
                self._contents.missing.append(f"input {file.name}: {reason}")
            elif not file.is_shipped:
                self._contents.files |= {name: path.read_bytes() for name, path in file.contents()}
        if not self._record.code:
            self._contents.missing.append(
                "inputs: the run had no store, and so did not record which files it read"
            )

    def _why_missing(self, file: ArchivedInput) -> str:
        if file.is_shipped:
            return ""
        if file.path is None:
            return self._origin.why_missing(file.written)
        if not self._with_inputs:
            return "left out"
        return f"larger than {MOST_BYTES // 10**6} MB" if file.size > MOST_BYTES else ""

    def _add_lock(self, lock: Path | None) -> None:
        path = lock or self._home / f"{self._graph.stem}.lock"
        if lock is None and not path.exists():
            if not (self._home / self._graph.name).is_file():
                reason = self._origin.why_missing(str(self._graph))
                self._contents.missing.append(
                    f"lock {path.name}: if there was one beside the graph, {reason}"
                )
            return
        mismatch = _lock_mismatch(path, self._graph.name, self._study.graph_text, self._record)
        if mismatch and lock is not None:
            raise NodegraphError(mismatch)
        if mismatch:
            self._contents.missing.append(f"lock {mismatch}")
        else:
            self._contents.files[f"{self._graph.stem}.lock"] = path.read_bytes()

    def _relocated(self, name: str, content: bytes) -> bytes:
        relocation = self._contents.relocation
        relocated = relocation.content(name, content)
        if relocated is content and relocation.matches(content):
            self._contents.missing.append(f"run/{name}: still contains a path of this machine")
        return relocated


def _used_graphs(names: Iterable[str]) -> dict[str, str]:
    """Return the names in the archive of the graphs that the graph uses."""
    paths = {name: posixpath.normpath(name) for name in names}
    outside = {name: path for name, path in paths.items() if path.startswith(("..", "/"))}
    used = {fold(path) for name, path in paths.items() if name not in outside}
    return paths | {
        name: free_name(f"{_GRAPHS}/{posixpath.basename(path)}", used)
        for name, path in outside.items()
    }


def _lock_mismatch(path: Path, graph: str, text: str, record: Record) -> str:
    """Return why a lock does not belong to a run of this graph; empty if it does."""
    try:
        lock = read_lock(path)
    except NodegraphError as error:
        return str(error)
    if lock.text != {graph: text, **record.included}:
        return f"{path}: the lock is of another graph, or of another version of it"
    if lock.record.settings.graph != graph:
        return f"{path}: the lock was not written beside {graph}"
    for part, was, now in (
        ("inputs", lock.record.inputs, record.inputs),
        ("axes", lock.record.axes, record.axes),
    ):
        names = {**was, **now}
        changed = [name for name in names if _base(was.get(name)) != _base(now.get(name))]
        if changed:
            return f"{path}: the lock has other {part}: {listed(changed)}"
    return ""


def _base(value: object) -> object:
    """Return a value with paths reduced to names of files, since a lock has other folders."""
    if isinstance(value, list):
        return [_base(item) for item in value]
    if isinstance(value, Mapping):
        return {str(name): _base(item) for name, item in value.items()}
    return PurePath(value).name if isinstance(value, str) else str(value)
