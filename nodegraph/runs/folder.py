"""The folder of a run, which is written so that no earlier result is lost."""

from __future__ import annotations

import gzip
import json
import os
import re
import shutil
import stat
import warnings
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from datetime import datetime
from io import BufferedIOBase, FileIO
from itertools import chain
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.errors import NodegraphError
from nodegraph.filenames import MAX_BYTES, fold, portable_name, shorten
from nodegraph.state import State
from nodegraph.store import files

if TYPE_CHECKING:
    from nodegraph.execute.events import Event

RECORD = "run.json"
STEPS = "steps.jsonl.gz"
EVENTS = "events.jsonl"
STUDY = "study.json.gz"
REPORT = "report.html"
_GRAPH = "graph.yaml"
_MOST_BYTES = 2**29
"""Most bytes of a file as text: more than a million steps need."""
_LONGEST_NUMBER = len(".9999")
_ENDED = "-%Y-%m-%dT%H-%M-%S"
_MOVED = re.compile(r"(?P<name>.+)-\d{4}-\d\d-\d\dT\d\d-\d\d-\d\d(\.\d+)?")
_HOW = ("executor", "jobs", "scheduler")
"""Settings that decide no result."""


def is_run(folder: Path) -> bool:
    """Return whether a folder is that of a run, however it ended."""
    return any((folder / name).is_file() for name in (RECORD, EVENTS, STUDY))


def runs_in(folder: Path) -> Iterator[Path]:
    """Yield the folders of runs in a folder, in no order."""
    with suppress(OSError):
        yield from (each for each in folder.iterdir() if each.is_dir() and is_run(each))


def moved_for(folder: Path) -> Path | None:
    """Return the folder of the later run for which a run was moved; None if it was not."""
    moved = _MOVED.fullmatch(folder.name)
    return folder.with_name(moved["name"]) if moved else None


def graph_name(used: Iterable[str]) -> str:
    """Return the name of the graph file in the folder of its run.

    Parameters
    ----------
    used
        The paths of the graph files that it uses, which keep their names.
    """
    return portable_name(_GRAPH, digest=_GRAPH in map(fold, used))


def content_of(path: Path, most: int = _MOST_BYTES) -> bytes:
    """Return the content of a file of a run folder; what ends in ``.gz`` is decompressed.

    Raises
    ------
    OSError, EOFError, zlib.error
        If it cannot be read or decompressed.
    ValueError
        If it is a device or a pipe, or longer than `most` bytes.
    """
    with _opened(path) as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise _too_long(most)
    return content


def lines_of(path: Path) -> Iterator[bytes]:
    """Yield the lines of a file of a run folder; errors are those of `content_of`."""
    left = _MOST_BYTES
    with _opened(path) as file:
        while line := file.readline(left + 1):
            left -= len(line)
            if left < 0:
                raise _too_long(_MOST_BYTES)
            yield line


def missing(path: Path) -> NodegraphError:
    """Return the error of a file of a run folder that is not there."""
    if (path.parent / RECORD).is_file():
        return NodegraphError(f"{path}: it was not written when the run ended; run the graph again")
    return NodegraphError(
        f"{path.parent}: there is no finished run; run the graph, or name the folder of a run"
    )


def _opened(path: Path) -> BufferedIOBase:
    if not stat.S_ISREG(path.stat().st_mode):
        raise ValueError("it is not a regular file")
    return gzip.open(path) if path.suffix == ".gz" else path.open("rb")


def _too_long(most: int) -> ValueError:
    return ValueError(f"it has more than {most / 1e6:.0f} MB")


class RunFolder:
    """The folder that a run writes to; events are written as they happen.

    Parameters
    ----------
    path
        An earlier run there is moved: its folder is renamed to end with the time at which it was
        written. A run that was interrupted before it had a result is replaced.
    graph
        The text of the graph file.
    used
        The texts of the graph files that it uses, by their paths from its own.

    Attributes
    ----------
    moved : Path or None
        The new path of the earlier run.
    replaced : bool
        Whether the earlier run was the same and is gone.

    Raises
    ------
    NodegraphError
        If the folder is not a run folder, another run is writing to it, or it cannot be made.
    """

    def __init__(self, path: Path, graph: str, used: Mapping[str, str] | None = None) -> None:
        self.path = path
        # a node may change the working directory while it runs
        self._place = path.absolute()
        self._begun = False
        self.replaced = False
        try:
            self.moved = _make_room(path)
        except OSError as error:
            raise _unwritable(path, error) from error
        try:
            path.mkdir(parents=True, exist_ok=True)
            with files.Folder(os.path.realpath(path)) as folder:
                events = folder.open(EVENTS, os.O_WRONLY | os.O_APPEND | os.O_CREAT)
            self._events = FileIO(events, "ab")
        except OSError as error:
            self._undo()
            raise _unwritable(path, error) from error
        self._size = 0
        if not files.lock(self._events):
            self._events.close()
            raise _busy(path)
        try:
            self._write_graphs({**(used or {}), graph_name(used or ()): graph})
        except OSError as error:
            self.abandon()
            raise _unwritable(path, error) from error

    def hear(self, event: Event) -> None:
        """Write an event as a line of JSON; where that fails, the run continues without."""
        self._begun |= event.kind in (State.DONE, State.FAILED)
        if self._events.closed:
            return
        line = left = memoryview(f"{json.dumps(event.as_dict())}\n".encode())
        try:
            while left:
                left = left[self._events.write(left) :]
        except OSError as error:
            reason = error.strerror or error
            warnings.warn(f"{self.path / EVENTS} ends here: {reason}", stacklevel=2)
            with suppress(OSError):
                self._events.truncate(self._size)  # lines are whole
            self._events.close()
        self._size += len(line)

    def write(self, name: str, content: bytes) -> None:
        """Write a file whole or not at all, over an existing one.

        Parameters
        ----------
        name
            The path from the folder, with slashes.
        content

        Raises
        ------
        OSError
            If it cannot be written.
        """
        *inner, last = name.split("/")
        # a folder of several users may hold a link by now
        with files.Folder(os.path.realpath(self._place), *inner, make=True) as folder:
            folder.write(last, content)

    def replace_same(self) -> None:
        """Remove the earlier run if this one, which is written by now, is the same.

        That is, if graph, settings and the keys of all results are equal, and its folder has no
        file that this one lacks.
        """
        if self.moved is None:
            return
        earlier = self._place.with_name(self.moved.name)
        if _files_in(earlier) <= _files_in(self._place):
            identity = _identity(earlier)
            if identity is not None and identity == _identity(self._place):
                shutil.rmtree(earlier, ignore_errors=True)
                self.replaced = True

    def close(self) -> None:
        """End the events, after which others may write to the folder."""
        self._events.close()

    def abandon(self) -> None:
        """Remove the folder of a run that could not begin, and move the earlier run back."""
        self.close()
        if not self._begun:
            self._undo()

    def _write_graphs(self, texts: Mapping[str, str]) -> None:
        """Write a graph, and those that it uses where it looks for them, if that is in the folder.

        Raises
        ------
        OSError
            If one cannot be written, with its path.
        """
        for name, text in texts.items():
            inside = os.path.normpath(name)
            if not os.path.isabs(inside) and Path(inside).parts[:1] != (os.pardir,):
                try:
                    self.write(Path(inside).as_posix(), text.encode())
                except OSError as error:
                    reason = error.strerror or str(error)
                    raise OSError(error.errno, reason, str(self.path / name)) from error

    def _undo(self) -> None:
        shutil.rmtree(self._place, ignore_errors=True)
        if self.moved is not None:
            self._place.with_name(self.moved.name).rename(self._place)


def _files_in(folder: Path) -> set[Path]:
    return {path.relative_to(folder) for path in folder.rglob("*")}


def _identity(folder: Path) -> object | None:
    """Return the identity of a run, equal in copies; None if a result has no key or is lost."""
    try:
        record = json.loads(content_of(folder / RECORD))
        settings = {name: value for name, value in record["settings"].items() if name not in _HOW}
        steps = [
            itemgetter("node", "labels", "key")(json.loads(line))
            for line in lines_of(folder / STEPS)
        ]
        lost = record.get("not_shown") or record.get("not_written")
        graph = content_of(folder / graph_name(record["included"]))
    except (OSError, EOFError, zlib.error, ValueError, LookupError):
        return None
    except (TypeError, AttributeError, RecursionError):  # JSON, but no record
        return None
    return None if lost else (graph, record["included"], settings, record["versions"], steps)


def _make_room(path: Path) -> Path | None:
    if not path.exists() or (path.is_dir() and not any(path.iterdir())):
        return None
    if is_written(path / EVENTS):
        raise _busy(path)
    marks = [file for file in (path / RECORD, path / EVENTS) if file.is_file()]
    if marks and _has_no_result(path):
        shutil.rmtree(path)
        return None
    if marks:
        ended = datetime.fromtimestamp(marks[0].stat().st_mtime).strftime(_ENDED)
        name = shorten(path.name, MAX_BYTES - len(ended) - _LONGEST_NUMBER)
        return path.rename(_free(path.with_name(f"{name}{ended}")))
    raise NodegraphError(f"{path} exists and is not a run folder; name another folder with --out")


def _has_no_result(path: Path) -> bool:
    """Return whether a run was interrupted, or ended with no step done, and nobody added a file."""
    names = {file.name for file in path.iterdir()}
    if names <= {EVENTS, _GRAPH}:
        return True
    try:
        counts = json.loads(content_of(path / RECORD))["counts"]
        done = counts["done"] + counts["stored"] + counts["refused"]
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return False
    return done == 0 and names <= {EVENTS, _GRAPH, RECORD, STEPS, STUDY, REPORT}


def is_written(events: Path) -> bool:
    """Return whether a run that has not ended writes these events."""
    if not events.is_file():
        return False
    with events.open("rb", buffering=0) as file:
        return not files.lock(file)


def _unwritable(path: Path, error: OSError) -> NodegraphError:
    return NodegraphError(f"{path}: the run cannot be written there: {error}")


def _busy(path: Path) -> NodegraphError:
    return NodegraphError(f"{path}: another run is writing there; name another folder with --out")


def _free(path: Path) -> Path:
    numbered = (path.with_name(f"{path.name}.{number}") for number in range(2, 10_000))
    return next(free for free in chain([path], numbered) if not free.exists())
