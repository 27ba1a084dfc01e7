"""The files that a run read: which they are, where they lie, and where an archive has them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path, PurePosixPath

from nodegraph.filenames import fold, portable_name
from nodegraph.fingerprint.keys import Files
from nodegraph.runs.record import Record, RecordedStep

FOLDER = "inputs"


@dataclass(frozen=True)
class ReadFile:
    """A file, or a folder of files, that a run read.

    Attributes
    ----------
    written : str
        As the settings of the run have it.
    digest : str
        Of its content then: SHA-256 of a file with its suffix after it; of a folder, over those
        of all files in it.
    name : str
        In the archive; as it is written for what plugins ship.
    path : Path or None
        Where it lies, if it does so with the same content.
    is_shipped : bool
        Whether a plugin brings it.
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
        for one in sorted(self.path.rglob("*")):
            if one.is_file():
                yield f"{self.name}/{one.relative_to(self.path).as_posix()}", one

    @property
    def size(self) -> int:
        """Bytes of all of it."""
        return sum(path.stat().st_size for _, path in self.contents())


def files_read(
    steps: Iterable[RecordedStep],
    folders: Sequence[Path],
    taken: Collection[str],
    is_shipped: Callable[[str], bool],
) -> tuple[ReadFile, ...]:
    """Return the files that a run read.

    Parameters
    ----------
    steps
        Those of the run.
    folders
        From which relative paths may be meant, that of the graph first.
    taken
        First parts of names that files cannot have in the archive.
    is_shipped
        Whether a path names what a plugin brings.
    """
    named = dict.fromkeys(
        (str(step.settings.get(setting)), digest)
        for step in steps
        for setting, digest in step.files.items()
    )
    digests = Files()
    found: list[ReadFile] = []
    taken = {fold(name) for name in (*taken, FOLDER)}
    used: set[str] = set()
    # those that keep their names come first, so that the others give way
    for written, digest in sorted(named, key=lambda one: not _stays(one[0], taken)):
        if is_shipped(written):
            found.append(ReadFile(written, digest, written, is_shipped=True))
            continue
        path = _located(written, digest, folders, digests)
        stays = _stays(written, taken) and (path is None or path == folders[0] / written)
        same = next((one for one in found if path is not None and _same(one.path, path)), None)
        name = same.name if same is not None else _name(written, used, stays=stays)
        found.append(ReadFile(written, digest, name, path))
    return tuple(found)


def _stays(written: str, taken: Collection[str]) -> bool:
    """Return whether a file can lie in the archive as it does beside the graph."""
    path = PurePosixPath(written)
    return (
        not path.is_absolute()
        and ".." not in path.parts
        and ":" not in written
        and "\\" not in written
        and bool(path.parts)
        and fold(path.parts[0]) not in taken
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


def _located(written: str, digest: str, folders: Sequence[Path], digests: Files) -> Path | None:
    for folder in folders:
        path = folder / written
        try:
            if digests.digest(path) == digest:
                return path
        except (OSError, ValueError):  # a record may say what is no path at all
            continue
    return None


def _same(one: Path | None, other: Path) -> bool:
    return one is not None and one.resolve() == other.resolve()


def free_name(name: str, used: set[str]) -> str:
    """Return a portable path in an archive, with a number if it is taken, and note its use.

    Parameters
    ----------
    name
        The path as it should be, with slashes.
    used
        Those in use, folded as by disks that ignore the case of letters.
    """
    path = PurePosixPath(*map(portable_name, PurePosixPath(name).parts))
    numbered = (path.with_name(f"{path.stem}-{number}{path.suffix}") for number in count(2))
    free = next(str(each) for each in chain([path], numbered) if fold(str(each)) not in used)
    used.add(fold(free))
    return free


PLUGINS = "plugins"


@dataclass(frozen=True)
class PluginFile:
    """A plugin file that a run used.

    Attributes
    ----------
    written : str
        As the settings of the run have it.
    name : str
        In the archive.
    path : Path
        Where it lay.
    content : bytes or None
        What the run imported, if it is still found.
    """

    written: str
    name: str
    path: Path
    content: bytes | None


class Origin:
    """Where a run was made.

    Parameters
    ----------
    record

    Attributes
    ----------
    folder : Path
        The working directory.
    graph : Path
        As the settings of the run have it.
    home : Path
        The folder of the graph file.
    """

    def __init__(self, record: Record) -> None:
        self._record = record
        self.folder = Path(record.folder)
        self.graph = Path(record.settings.graph)
        self._starts = list(dict.fromkeys((self.folder, Path.cwd())))
        with_graph = (one for one in self._starts if (one / self.graph).is_file())
        self.home = (next(with_graph, self.folder) / self.graph).parent

    def folders(self) -> list[Path]:
        """Return from where relative paths may be meant, the folder of the graph first."""
        homes = [self.home, *((one / self.graph).parent for one in self._starts)]
        used = [home / Path(name).parent for home in homes for name in self._record.included]
        return list(dict.fromkeys([*homes, *used, *self._starts]))

    def plugins(self) -> Iterator[PluginFile]:
        """Yield each plugin file that the run used."""
        used: set[str] = set()
        for written, plugin in zip(
            self._record.settings.plugins, self._record.plugins, strict=False
        ):
            path = Path(plugin.path)
            content = self._found(
                [path, *(start / written for start in self._starts)], plugin.sha256
            )
            name = free_name(f"{PLUGINS}/{path.name}", used)
            yield PluginFile(written, name, path, content)

    def lacks(self, path: str) -> str:
        """Return that a file is not found as it was, and where it would be."""
        if Path(path).is_absolute():
            return f"{path} is gone, or is no longer as the run used it"
        if self.folder.is_dir():
            return f"it is gone from {self.folder}, or is no longer as the run used it"
        return f"it is not here; archive the run where it was made, in {self.folder}"

    @staticmethod
    def _found(paths: list[Path], digest: str) -> bytes | None:
        for path in paths:
            try:
                content = path.read_bytes()
            except (OSError, ValueError):  # a record may say what is no path at all
                continue
            if hashlib.sha256(content).hexdigest() == digest:
                return content
        return None
