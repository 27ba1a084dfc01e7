"""The files that a run read, and their names in an archive."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path, PurePosixPath

from nodegraph.cache_key import FileDigests
from nodegraph.filenames import fold, portable_name
from nodegraph.runs.record import Record, RecordedStep

FOLDER, PLUGINS = "inputs", "plugins"


@dataclass(frozen=True)
class ArchivedInput:
    """A file, or a folder of files, that a run read.

    Attributes
    ----------
    written : str
        The path in the settings of the run.
    digest : str
        Digest of the content during the run: the SHA-256 and the suffix of a file; the SHA-256 of
        those of all files for a folder.
    name : str
        In the archive; the written path for ``scheme:name``.
    path : Path or None
        Where it is, if the content is the same.
    is_shipped : bool
        Whether it is not in the archive, since ``scheme:name`` finds it anywhere.
    """

    written: str
    digest: str
    name: str
    path: Path | None = None
    is_shipped: bool = False

    def contents(self) -> Iterator[tuple[str, Path]]:
        """Yield name in the archive and path of each file."""
        if self.path is None or self.is_shipped:
            return
        if not self.path.is_dir():
            yield self.name, self.path
            return
        for path in sorted(self.path.rglob("*")):
            if path.is_file():
                yield f"{self.name}/{path.relative_to(self.path).as_posix()}", path

    @property
    def size(self) -> int:
        """The size in bytes."""
        return sum(path.stat().st_size for _, path in self.contents())


def files_read(
    steps: Iterable[RecordedStep],
    folders: Sequence[Path],
    reserved: Collection[str],
    is_shipped: Callable[[str], bool],
) -> tuple[ArchivedInput, ...]:
    """Return the files that a run read.

    Parameters
    ----------
    steps
        The steps of the run.
    folders
        Where relative paths may start, the folder of the graph first.
    reserved
        Names in the archive that are not free.
    is_shipped
        Whether a path is ``scheme:name``.
    """
    named = dict.fromkeys(
        (str(step.settings.get(setting)), digest)
        for step in steps
        for setting, digest in step.files.items()
    )
    digests = FileDigests()
    files: list[ArchivedInput] = []
    reserved = {fold(name) for name in (*reserved, FOLDER)}
    used: set[str] = set()
    # files that keep their names come first, so that the rest are renamed
    for written, digest in sorted(named, key=lambda item: not _stays(item[0], reserved)):
        if is_shipped(written):
            files.append(ArchivedInput(written, digest, written, is_shipped=True))
            continue
        path = _located(written, digest, folders, digests)
        stays = _stays(written, reserved) and (path is None or path == folders[0] / written)
        there = path and path.resolve()
        same = next((file for file in files if file.path and file.path.resolve() == there), None)
        name = same.name if same is not None else _name(written, used, stays=stays)
        files.append(ArchivedInput(written, digest, name, path))
    return tuple(files)


def _stays(written: str, reserved: Collection[str]) -> bool:
    """Return whether a file can have its path relative to the graph in the archive."""
    path = PurePosixPath(written)
    return (
        not path.is_absolute()
        and ".." not in path.parts
        and ":" not in written
        and "\\" not in written
        and bool(path.parts)
        and fold(path.parts[0]) not in reserved
    )


def _name(written: str, used: set[str], *, stays: bool) -> str:
    if not stays:
        last = PurePosixPath(written.replace("\\", "/")).name
        return free_name(f"{FOLDER}/{last or 'file'}", used)
    name = str(PurePosixPath(written))
    if fold(name) in used:
        return free_name(name, used)
    used.add(fold(name))
    return name


def _located(
    written: str, digest: str, folders: Sequence[Path], digests: FileDigests
) -> Path | None:
    for folder in folders:
        path = folder / written
        try:
            if digests.digest(path) == digest:
                return path
        except (OSError, ValueError):  # the text in a record may not be a valid path
            continue
    return None


def free_name(name: str, used: set[str]) -> str:
    """Return a portable path in an archive, numbered if it is in use, and add it to `used`.

    Parameters
    ----------
    name
        The path with slashes.
    used
        Paths in use, with the case of letters folded.
    """
    path = PurePosixPath(*map(portable_name, PurePosixPath(name).parts))
    numbered = (path.with_name(f"{path.stem}-{number}{path.suffix}") for number in count(2))
    free = next(text for text in map(str, chain([path], numbered)) if fold(text) not in used)
    used.add(fold(free))
    return free


@dataclass(frozen=True)
class ArchivedPlugin:
    """A plugin file that a run used.

    Attributes
    ----------
    written : str
        The path in the settings of the run.
    name : str
        In the archive.
    path : Path
        Where it was.
    content : bytes or None
        The content that the run imported, if it is still there.
    """

    written: str
    name: str
    path: Path
    content: bytes | None


class RunFolders:
    """The folders of a run, in which its files are searched.

    Attributes
    ----------
    folder : Path
        The working directory.
    graph : Path
        The path in the settings of the run.
    home : Path
        The folder of the graph file.
    """

    def __init__(self, record: Record) -> None:
        self._record = record
        self.folder = Path(record.folder)
        self.graph = Path(record.settings.graph)
        self._starts = list(dict.fromkeys((self.folder, Path.cwd())))
        with_graph = (start for start in self._starts if (start / self.graph).is_file())
        self.home = (next(with_graph, self.folder) / self.graph).parent

    def folders(self) -> list[Path]:
        """Return where relative paths may start, the folder of the graph first."""
        homes = [self.home, *((start / self.graph).parent for start in self._starts)]
        used = [home / Path(name).parent for home in homes for name in self._record.included]
        return list(dict.fromkeys([*homes, *used, *self._starts]))

    def plugins(self) -> Iterator[ArchivedPlugin]:
        """Yield each plugin file that the run used."""
        used: set[str] = set()
        for written, plugin in zip(
            self._record.settings.plugins, self._record.plugins, strict=False
        ):
            path = Path(plugin.path)
            content = _content([path, *(start / written for start in self._starts)], plugin.sha256)
            name = free_name(f"{PLUGINS}/{path.name}", used)
            yield ArchivedPlugin(written, name, path, content)

    def why_missing(self, path: str) -> str:
        """Return why a file is not in the archive, and where it was."""
        if Path(path).is_absolute():
            return f"{path} is missing or was edited after the run"
        if self.folder.is_dir():
            return f"missing from {self.folder}, or edited after the run"
        return f"not on this machine; archive the run where it ran, in {self.folder}"


def _content(paths: Iterable[Path], digest: str) -> bytes | None:
    """Return the content with this digest, from the first file that has it."""
    for path in paths:
        try:
            content = path.read_bytes()
        except (OSError, ValueError):  # the text in a record may not be a valid path
            continue
        if hashlib.sha256(content).hexdigest() == digest:
            return content
    return None
