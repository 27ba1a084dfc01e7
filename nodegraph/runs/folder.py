"""The folder of a run, which is written so that no earlier result is lost."""

from __future__ import annotations

import json
import shutil
import warnings
from collections.abc import Mapping
from contextlib import suppress
from datetime import datetime
from io import TextIOWrapper
from pathlib import Path

from nodegraph.errors import NodegraphError
from nodegraph.execute import Event
from nodegraph.state import State

RECORD = "run.json"
EVENTS = "events.jsonl"
GRAPH = "graph.yaml"


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
        try:
            self.moved = _make_room(path)
            path.mkdir(parents=True, exist_ok=True)
            self._events: TextIOWrapper = (path / EVENTS).open("a", encoding="utf-8", buffering=1)
            if not _locked(self._events):
                self._events.close()
                raise _busy(path)
            _write_graph(path, {GRAPH: graph, **(used or {})})
        except OSError as error:
            raise NodegraphError(f"{path}: the run cannot be written there: {error}") from error

    def hear(self, event: Event) -> None:
        """Write an event as a line of JSON; where that fails, the run goes on without."""
        self._begun |= event.kind in (State.DONE, State.FAILED)
        if self._events.closed:
            return
        try:
            self._events.write(json.dumps(event.as_dict()) + "\n")
        except OSError as error:
            warnings.warn(f"{self.path / EVENTS} ends here: {error}", stacklevel=2)
            with suppress(OSError):
                self._events.close()

    def abandon(self) -> None:
        """Remove the folder of a run that could not begin, and move the earlier run back."""
        self._events.close()
        if not self._begun:
            shutil.rmtree(self._place)
            if self.moved is not None:
                self._place.with_name(self.moved.name).rename(self._place)

    def finish(self, files: Mapping[str, bytes], record: str) -> None:
        """Write the files of a finished run, and last its record."""
        try:
            for name, content in files.items():
                target = self._place / name
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(content)
            unfinished = self._place / f"{RECORD}.part"
            unfinished.write_text(record, encoding="utf-8")
            unfinished.replace(self._place / RECORD)
        finally:
            self._events.close()


def _write_graph(path: Path, texts: Mapping[str, str]) -> None:
    """Write a graph, and those that it uses where it looks for them, if that is in the folder."""
    for name, text in reversed(list(texts.items())):
        target = path / name
        if target.resolve().is_relative_to(path.resolve()):
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")


def _make_room(path: Path) -> Path | None:
    if not path.exists() or (path.is_dir() and not any(path.iterdir())):
        return None
    if _is_written(path / EVENTS):
        raise _busy(path)
    marks = [file for file in (path / RECORD, path / EVENTS) if file.is_file()]
    if marks and {file.name for file in path.iterdir()} <= {EVENTS, GRAPH}:
        shutil.rmtree(path)  # an interrupted run without results
        return None
    if marks:
        ended = datetime.fromtimestamp(marks[0].stat().st_mtime).strftime("%Y-%m-%dT%H-%M-%S")
        return path.rename(_free(path.with_name(f"{path.name}-{ended}")))
    raise NodegraphError(f"{path} exists and is not a run folder; name another folder with --out")


def _is_written(events: Path) -> bool:
    """Return whether a run that has not ended writes these events."""
    if not events.is_file():
        return False
    with events.open(encoding="utf-8") as file:
        return not _locked(file)


def _locked(file: TextIOWrapper) -> bool:
    """Lock a file for as long as it is open; return False if another run holds it."""
    try:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except (ImportError, OSError):
        pass  # this system or this disk has no locks
    return True


def _busy(path: Path) -> NodegraphError:
    return NodegraphError(f"{path}: another run is writing there; name another folder with --out")


def _free(path: Path) -> Path:
    numbered = (path.with_name(f"{path.name}.{number}") for number in range(2, 10_000))
    return next(free for free in (path, *numbered) if not free.exists())
