"""What goes into the archive of a run: graph, inputs, results, sources; it runs again elsewhere."""

from __future__ import annotations

import io
import posixpath
import zipfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePath
from typing import Any

from nodegraph.archive.inputs import PLUGINS, Origin, ReadFile, files_read, free_name
from nodegraph.archive.relocate import (
    Elsewhere,
    folders_here,
    graph_elsewhere,
    settings_elsewhere,
)
from nodegraph.errors import NodegraphError, listed
from nodegraph.filenames import fold
from nodegraph.lock.lockfile import read_lock
from nodegraph.plugin.registry import Registry
from nodegraph.report.citing import cited
from nodegraph.report.study import Study, read_study
from nodegraph.runs.folder import graph_name
from nodegraph.runs.record import Record
from nodegraph.runs.saved_run import SavedRun


def readme(contents: Contents) -> str:
    """Return the text of an archive's README, in Markdown."""
    study = contents.study
    versions = dict(study.versions)
    lines = [
        f"# {study.title}",
        "",
        f"A run of `{contents.graph}` by nodegraph {versions.get('nodegraph', '')}, made "
        f"{study.created}. Its report is `run/report.html`; what to cite is in `citation/`; "
        "`ro-crate-metadata.json` describes every file (Workflow Run RO-Crate 0.5).",
        "",
        *study.answer,
        "",
        f"Run it again here, with the same versions of the packages below{_once(contents)}:",
        "",
        f"    {contents.command}",
        "",
        *_verify(contents),
        *_inputs(contents),
        *_lacking(contents),
        "Paths are those in this archive; folders of the machine that ran it are left out.",
        "",
        ", ".join(f"{name} {one}" for name, one in study.versions),
        "",
    ]
    return "\n".join(lines)


def _once(contents: Contents) -> str:
    return ", and with what is not in this archive" if contents.lacking else ""


def _verify(contents: Contents) -> Iterator[str]:
    lock = next((name for name in contents.files if name.endswith(".lock")), "")
    if lock and "/" not in lock:
        yield f"and tell whether it still gives its results: `nodegraph verify {lock}`"
        yield ""


def _inputs(contents: Contents) -> Iterator[str]:
    if contents.inputs:
        yield "It read (with the SHA-256 of the content, and its suffix):"
        yield ""
        for one in contents.inputs:
            shipped = ", which its package ships" if one.is_shipped else ""
            yield f"- `{one.name}`{shipped}: {one.digest}"
        yield ""


def _lacking(contents: Contents) -> Iterator[str]:
    if contents.lacking:
        yield "Not in this archive:"
        yield ""
        yield from (f"- {one}" for one in contents.lacking)
        yield ""


def why_not(path: Path, graph: str, text: str, record: Record) -> str:
    """Return why a lock does not belong to a run; empty if it does.

    Parameters
    ----------
    path
        Of the lock.
    graph, text
        Name and text of the graph file that ran.
    record
    """
    try:
        study = read_lock(path).study
    except NodegraphError as error:
        return str(error)
    if study.text != {graph: text, **record.included}:
        return f"{path}: the lock is of another graph, or of another version of it"
    if study.graph != graph:
        return f"{path}: the lock was not written beside {graph}"
    axes = {name: list(labels) for name, labels in study.axes.items()}
    for part, was, now in (
        ("inputs", study.inputs, record.inputs),
        ("axes", axes, record.axes),
    ):
        names = {**was, **now}
        changed = [name for name in names if _base(was.get(name)) != _base(now.get(name))]
        if changed:
            return f"{path}: the lock has other {part}: {listed(changed)}"
    return ""


def _base(value: Any) -> Any:
    """Return a value with paths reduced to names of files, since a lock has other folders."""
    if isinstance(value, list):
        return [_base(item) for item in value]
    if isinstance(value, Mapping):
        return {str(name): _base(item) for name, item in value.items()}
    return PurePath(value).name if isinstance(value, str) else str(value)


METADATA = "ro-crate-metadata.json"

_LONG_AGO = (1980, 1, 1, 0, 0, 0)
_READABLE = 0o100644 << 16
_UNIX = 3


def packed(files: Mapping[str, bytes], metadata: bytes) -> bytes:
    """Return an archive; equal files give equal bytes."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as file:
        for name, content in {METADATA: metadata, **dict(sorted(files.items()))}.items():
            entry = zipfile.ZipInfo(name, _LONG_AGO)
            entry.compress_type, entry.create_system = zipfile.ZIP_DEFLATED, _UNIX
            entry.external_attr = _READABLE
            file.writestr(entry, content)
    return made.getvalue()


README = "README.md"
MOST_BYTES = 100_000_000
"""Inputs up to this size go into an archive."""

_RUN, _CITATION, _GRAPHS = "run", "citation", "graphs"


@dataclass
class Contents:
    """What goes into an archive.

    Attributes
    ----------
    graph : str
        The name of the graph.
    study : Study
    record : Record
    files : dict of name to bytes
    inputs : tuple of ReadFile
    command : str
        Runs the graph again, where the archive is unpacked.
    lacking : list of str
        What could not be put in, and why.
    elsewhere : Elsewhere
        Takes what is of this machine out of a text.
    """

    graph: str
    study: Study
    record: Record
    command: str = ""
    files: dict[str, bytes] = field(default_factory=dict)
    inputs: tuple[ReadFile, ...] = ()
    lacking: list[str] = field(default_factory=list)
    elsewhere: Elsewhere = field(default_factory=lambda: Elsewhere({}, ()))

    @property
    def results(self) -> list[str]:
        """The names of what the run has made."""
        return sorted(name for name in self.files if name.startswith(f"{_RUN}/"))


def contents_of(
    folder: Path, registry: Registry, *, lock: Path | None = None, with_inputs: bool = True
) -> Contents:
    """Return what goes into the archive of a run.

    Parameters
    ----------
    folder
        Of the run.
    registry
        Says what plugins ship.
    lock
        Goes in beside the graph; by default the one that lies beside the graph, if there is one.
    with_inputs
        Whether files that the run read go in, and not only what they are.

    Raises
    ------
    NodegraphError
        If there is no finished run, or the lock is not there, or not one of this run.
    """
    record, study = SavedRun(folder).record, read_study(folder)
    return _Packing(folder, record, study, registry, with_inputs=with_inputs).contents(lock)


class _Packing:
    """Puts the contents of an archive together."""

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
        self._origin = Origin(record)
        self._graph, self._home = self._origin.graph, self._origin.home
        self._plugins = list(self._origin.plugins())
        self._graphs = _used_graphs(record.included)
        taken = {_RUN, _CITATION, PLUGINS, _GRAPHS, README, METADATA, self._graph.name}
        self._inputs = files_read(
            record.steps, self._origin.folders(), taken, lambda one: bool(registry.hooks.place(one))
        )
        self._made = Contents(self._graph.name, study, record, inputs=self._inputs)

    def contents(self, lock: Path | None) -> Contents:
        made = self._made
        said = {one.written: one.name for one in self._inputs}
        said |= {one.written: one.name for one in self._plugins}
        settings = settings_elsewhere(self._record.settings, self._graph.name, said)
        made.command = settings.command
        elsewhere = Elsewhere(
            self._moved(made.command), folders_here(self._record, self._texts(), self._places())
        )
        made.elsewhere = elsewhere
        self._add_graphs(elsewhere)
        self._add_plugins()
        self._add_inputs()
        self._add_lock(lock)
        for path in sorted(self._folder.rglob("*")):
            name = path.relative_to(self._folder).as_posix()
            if path.is_file() and name not in (graph_name(self._graphs), *self._graphs):
                made.files[f"{_RUN}/{name}"] = self._checked(elsewhere, name, path.read_bytes())
        made.lacking += [
            f"{_RUN}/{lost.file}: it could not be written when the run ended: {lost.reason}"
            for lost in self._record.not_written
        ]
        for name, text in cited(self._study).items():
            made.files[f"{_CITATION}/{name}"] = elsewhere.text(text).encode(
                errors="backslashreplace"
            )
        made.files[README] = elsewhere.text(readme(made)).encode(errors="backslashreplace")
        return made

    def _moved(self, command: str) -> dict[str, str]:
        absolute = {
            one.written: one.name for one in self._inputs if Path(one.written).is_absolute()
        }
        found = {str(one.path.absolute()): one.name for one in self._inputs if one.path}
        plugins = {str(one.path): one.name for one in self._plugins}
        return {self._record.command: command, **plugins, **found, **absolute}

    def _texts(self) -> tuple[str, ...]:
        return (self._study.graph_text, *self._record.included.values())

    def _places(self) -> Iterator[Path]:
        yield from (self._home, self._origin.folder, self._folder, self._folder.parent)
        yield from (Path(plugin.path).parent for plugin in self._record.plugins)
        if self._record.settings.store:
            yield Path(self._record.settings.store)

    def _add_graphs(self, elsewhere: Elsewhere) -> None:
        moved = {
            str(Path(self._home / one.written)): one.name
            for one in self._inputs
            if not one.is_shipped
        }
        moved |= {str(one.path): one.name for one in self._inputs if one.path}
        moved |= {str(self._home / name): there for name, there in self._graphs.items()}
        moved = {posixpath.normpath(path): name for path, name in moved.items()}
        texts = {"": (self._study.graph_text, self._graph.name)} | {
            name: (text, self._graphs[name]) for name, text in self._record.included.items()
        }
        for was, (text, name) in texts.items():
            home = self._home / Path(was).parent
            there = graph_elsewhere(text, home, name, moved)
            self._made.files[name] = elsewhere.text(there).encode()

    def _add_plugins(self) -> None:
        for one in self._plugins:
            if one.content is None:
                self._made.lacking.append(f"plugin {one.name}: {self._origin.lacks(one.written)}")
            else:
                self._made.files[one.name] = one.content

    def _add_inputs(self) -> None:
        for one in self._inputs:
            why = self._why_not(one)
            if why:
                self._made.lacking.append(f"input {one.name}: {why}")
            elif not one.is_shipped:
                self._made.files |= {name: path.read_bytes() for name, path in one.contents()}
        if not self._record.code:
            self._made.lacking.append(
                "inputs: the run stored nothing, and so has not noted which files it read"
            )

    def _why_not(self, one: ReadFile) -> str:
        if one.is_shipped:
            return ""
        if one.path is None:
            return self._origin.lacks(one.written)
        if not self._with_inputs:
            return "left out, as was asked for"
        return f"larger than {MOST_BYTES // 10**6} MB" if one.size > MOST_BYTES else ""

    def _add_lock(self, lock: Path | None) -> None:
        path = lock or self._home / f"{self._graph.stem}.lock"
        if lock is None and not path.exists():
            if not (self._home / self._graph.name).is_file():
                gone = self._origin.lacks(str(self._graph))
                self._made.lacking.append(
                    f"lock {path.name}: if there was one beside the graph, {gone}"
                )
            return
        wrong = why_not(path, self._graph.name, self._study.graph_text, self._record)
        if wrong and lock is not None:
            raise NodegraphError(wrong)
        if wrong:
            self._made.lacking.append(f"lock {wrong}")
        else:
            self._made.files[f"{self._graph.stem}.lock"] = path.read_bytes()

    def _checked(self, elsewhere: Elsewhere, name: str, content: bytes) -> bytes:
        made = elsewhere.content(name, content)
        if made is content and elsewhere.still_in(content):
            self._made.lacking.append(f"run/{name}: has a path of this machine in it, still")
        return made


def _used_graphs(names: Iterable[str]) -> dict[str, str]:
    """Return where the graphs that the graph uses lie in the archive."""
    paths = {name: posixpath.normpath(name) for name in names}
    outside = {name: path for name, path in paths.items() if path.startswith(("..", "/"))}
    used = {fold(path) for name, path in paths.items() if name not in outside}
    return paths | {
        name: free_name(f"{_GRAPHS}/{posixpath.basename(path)}", used)
        for name, path in outside.items()
    }
