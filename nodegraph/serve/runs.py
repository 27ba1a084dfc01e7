"""The runs that are open: in which state their folders are, and what is read from them."""

from __future__ import annotations

import shlex
import warnings
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path
from threading import Lock, RLock
from typing import Any

from nodegraph.draw import svg
from nodegraph.draw.from_graph import MOST_ON_A_PAGE, picture_of
from nodegraph.errors import NodegraphError
from nodegraph.execute.outcome import Outcome
from nodegraph.execute.results import Run
from nodegraph.execute.resume import open_store
from nodegraph.execute.settings import RunSettings
from nodegraph.filenames import portable_name
from nodegraph.formatting import number_of
from nodegraph.graph import Graph
from nodegraph.plugin.registry import Registry
from nodegraph.report.study import Study, read_study
from nodegraph.runs.folder import EVENTS, RECORD, STUDY, is_run, runs_in
from nodegraph.runs.opened import open_run, open_unfinished, saved_graph
from nodegraph.runs.record import CellKey, Record
from nodegraph.runs.record_files import read_record
from nodegraph.runs.state import RunState, run_state
from nodegraph.serve.progress import (
    Counts,
    EventFile,
    Progress,
    StepState,
    counts_of,
    failures_of,
    states_of,
)
from nodegraph.state import State
from nodegraph.validation_errors import adapter_of

_LONGEST = 1 << 20
_WITHOUT_VALUE = frozenset(state.value for state in State if not state.has_value)
_QUIET = 10
"""After how many looks without a new event a run may have been killed."""


@dataclass(frozen=True)
class Condition:
    """The state of a run, and what the reader must know of it."""

    state: RunState
    message: str = ""
    command: str = ""


class OpenRun:
    """A run in a folder, which may be in progress.

    Parameters
    ----------
    number, name
        By which addresses name its files, and the run itself.
    folder
    registry
        The plugins that are installed.
    store
        Where results are stored; by default where the run stored them.
    """

    def __init__(
        self, number: int, name: str, folder: Path, registry: Registry, store: Path | None
    ) -> None:
        self.number = number
        self.name = name
        self.folder = folder
        self._registry = registry
        self._store = store
        self._events = EventFile(folder / EVENTS)
        self._quiet = 0
        self._state = RunState.RUNNING
        # the last version of each
        self._study_at = lru_cache(1)(lambda version: read_study(folder))
        self._record_at = lru_cache(1)(lambda version: read_record(folder))
        self._values: tuple[_Version, Run] | None = None
        self._lock = RLock()
        self._opening = Lock()  # of values, which takes longer than a look at the events

    def condition(self) -> Condition:
        """Return in which state the folder is now."""
        try:
            state = run_state(self.folder)
            if state is RunState.INTERRUPTED:
                return self._interrupted()
            if not state.is_final:
                return Condition(state)
            self.study()
        except OSError as error:
            return Condition(RunState.UNREADABLE, f"{self.folder} cannot be read: {error}")
        except NodegraphError as error:
            record = self._record_if_any()
            return Condition(RunState.UNREADABLE, str(error), record.command if record else "")
        return Condition(RunState.FINISHED)

    def snapshot(self, state: RunState | None = None) -> dict[str, Any]:
        """Return how far the run is as plain data.

        Parameters
        ----------
        state
            If it is known; by default it is looked up from time to time.
        """
        with self._lock:
            news = self._read_events()
            self._quiet = 0 if news else self._quiet + 1
        if state is not None or news:
            self._state = state or RunState.RUNNING
        elif self._quiet % _QUIET == 0:
            # seldom, as it holds for a moment the lock that a run takes when it begins
            self._state = self.condition().state
        progress, record = self._events.progress, self._record_if_any()
        if record is None:
            counts: Counts = progress.counts(is_over=self._state.is_final)
            failures = progress.failures
        else:
            states = self.states()
            counts = {node: Counter() for node in record.nodes} | counts_of(states)
            failures = failures_of(states)
        return {
            "state": self._state,
            **states_of(counts),
            "seconds": round(progress.seconds, 1),
            "to_go": progress.to_go,
            "failures": failures,
        }

    def states(self) -> Sequence[StepState]:
        """Return the states of all combinations; of an unfinished run, of those that have begun."""
        record = self._record_if_any()
        if record is None:
            with self._lock:
                self._read_events()
                return list(self._events.progress.states.values())
        return [
            StepState(cell, step.status, step.reason, step.place)
            for step in record.steps
            for cell in step.cells
        ]

    def left_out(self, node: str) -> Mapping[str, int]:
        """Return why combinations of a node were not planned, and how many; known at the end."""
        record = self._record_if_any()
        skipped = record.skipped if record is not None else ()
        return {each.reason: each.counts[node] for each in skipped if node in each.counts}

    def study(self) -> Study:
        """Return the study that the report shows.

        Raises
        ------
        NodegraphError
            If the run has none, or it cannot be read.
        """
        with self._lock:
            return self._study_at(version_of(self.folder / STUDY))

    def record(self) -> Record | None:
        """Return the record of the run; None as long as it has none.

        Raises
        ------
        NodegraphError
            If it cannot be read.
        """
        version = version_of(self.folder / RECORD)
        with self._lock:
            return None if version == ABSENT else self._record_at(version)

    def graph(self) -> Graph:
        """Return the graph of the run.

        Raises
        ------
        NodegraphError
            If it cannot be read, or does not fit what is installed.
        """
        record = self.record()
        if record is None:
            settings, origin = self._begun()
            return saved_graph(self.folder, settings, origin, self._registry)
        self._refuse_missing_plugins(record)
        return saved_graph(
            self.folder,
            record.settings,
            Path(record.folder),
            self._registry,
            included=record.included,
            only=record.axes,  # no methods that were installed later
        )

    def values(self) -> tuple[Run, Record | None]:
        """Return the run with its values, and its record if it has one.

        Raises
        ------
        NodegraphError
            If its record cannot be read, or its graph does not fit what is installed.
        """
        record = self.record()
        version = version_of(self.folder / (EVENTS if record is None else RECORD))
        with self._opening:
            if self._values is None or self._values[0] != version:
                settings, origin = (
                    self._begun() if record is None else (record.settings, Path(record.folder))
                )
                graph, folder = self.graph(), self._store or _store_of(settings, origin)
                store = open_store(self._registry, folder, partial(warnings.warn, stacklevel=2))
                run = (
                    open_unfinished(graph, settings, self._ended(), store)
                    if record is None
                    else open_run(graph, record, store)
                )
                self._values = version, run
            return self._values[1], record

    def drawing(self) -> dict[str, str]:
        """Return the graph as SVG, or a message that says why it is not drawn."""
        try:
            graph = self.graph()
        except NodegraphError as error:
            return {"drawing": "", "message": f"The graph is not drawn: {error}"}
        if len(graph.nodes) > MOST_ON_A_PAGE:
            return {"drawing": "", "message": "The graph is too large to draw."}
        return {
            "drawing": svg(picture_of(graph, whole=True), sockets=True, heading=False),
            "message": "",
        }

    def described(self, node: str) -> str:
        """Return the methods of a node and its place in the graph; empty if they are unknown."""
        known = None
        with suppress(NodegraphError):
            known = self.graph().nodes.get(node)
        if known is None:
            return ""
        methods = list(known.methods.values())
        what = methods[0].node.name if len(methods) == 1 else number_of(len(methods), "method")
        return f"{what}, {known.place}"

    def files(self) -> Mapping[str, Path]:
        """Return the files that the report links, by the names under which it links them."""
        study = self.study()
        links = [*study.files, *(link for section in study.sections for link in section.files)]
        inside = self.folder.resolve()
        paths = {link.path: (inside / link.path).resolve() for link in links}
        # a folder that somebody sent may name any file
        return {name: path for name, path in paths.items() if path.is_relative_to(inside)}

    @property
    def title(self) -> str:
        """The title of the study."""
        record = self._record_if_any()
        self._read_events()
        planned = self._events.progress.planned
        return record.title if record is not None else str(planned.get("title", ""))

    def _begun(self) -> tuple[RunSettings, Path]:
        """Return the settings of an unfinished run and its working directory."""
        from pydantic import ValidationError

        self._read_events()
        planned = self._events.progress.planned
        try:
            settings: RunSettings = adapter_of(RunSettings).validate_python(planned.get("settings"))
        except ValidationError as error:
            raise NodegraphError(
                f"{self.folder / EVENTS} does not begin with the settings of a run"
            ) from error
        return settings, Path(str(planned.get("folder", "")))

    def _ended(self) -> Mapping[CellKey, Outcome]:
        """Return how steps of an unfinished run ended that have no value."""
        return {
            each.cell.key: Outcome(State(each.state), reason=each.reason)
            for each in self.states()
            if each.state in _WITHOUT_VALUE
        }

    def _read_events(self) -> bool:
        with self._lock, suppress(OSError):
            return self._events.update()
        return False

    def _interrupted(self) -> Condition:
        self._read_events()
        message = f"the run ended after {self._events.progress.seconds:.0f} s without a result"
        try:
            settings, origin = self._begun()
        except NodegraphError:
            return Condition(RunState.INTERRUPTED, message)
        if settings.cache:
            message += "; finished steps are stored, and the same command continues from there"
        return Condition(
            RunState.INTERRUPTED, message, _command(settings, origin, self.folder.resolve())
        )

    def _record_if_any(self) -> Record | None:
        """Return the record; None if there is none that can be read."""
        try:
            return self.record()
        except NodegraphError:
            return None

    def _refuse_missing_plugins(self, record: Record) -> None:
        """Raise an error if the run used plugin files; only the user may name what is imported."""
        files = [plugin.module.__file__ for plugin in self._registry.loaded if plugin.digest]
        names = {Path(str(file)).name for file in files}
        missing = [each for each in record.plugins if Path(each.path).name not in names]
        if missing:
            options = shlex.join(part for each in missing for part in ("--plugin", each.path))
            raise NodegraphError(f"the run used nodes of other files; open it with {options}")


def _command(settings: RunSettings, origin: Path, folder: Path) -> str:
    """Return the command that continues a run in its folder."""
    default = origin / "runs" / portable_name(Path(settings.graph).stem)
    if default.resolve() == folder:
        return settings.command
    out = folder.relative_to(origin) if folder.is_relative_to(origin) else folder
    return f"{settings.command} {shlex.join(['--out', str(out)])}"


def _store_of(settings: RunSettings, origin: Path) -> Path | None:
    """Return the folder in which a run stored results; None for the default."""
    folder = origin / settings.store
    return folder if settings.store and folder.is_dir() else None


_Version = tuple[int, int]
ABSENT = 0, 0
"""The version of a file that is not there."""


def version_of(path: Path) -> _Version:
    """Return the stamp of a file, which changes when the file is replaced or grows."""
    try:
        status = path.stat()
    except OSError:
        return ABSENT
    return status.st_mtime_ns, status.st_size


def entry_of(run: OpenRun) -> dict[str, object]:
    """Return the entry of a run in a list of runs, without reading all of it."""
    progress, state = Progress(), RunState.UNREADABLE
    with suppress(OSError):
        state = run_state(run.folder)
        with (run.folder / EVENTS).open("rb") as file:
            progress.read(file.readline(_LONGEST))
    began = str(progress.planned.get("began", ""))[: len("2026-11-22T15:42")]
    title = str(progress.planned.get("title", ""))
    return {"run": run, "state": state, "title": title, "begun": began.replace("T", " ")}


class OpenRuns:
    """The runs that were named, and those beside them.

    Parameters
    ----------
    paths
        Folders of runs, or folders that hold runs or will.
    registry, store
        As for each run.

    Attributes
    ----------
    first : tuple of str
        The names of the runs that were named themselves.
    """

    def __init__(self, paths: Iterable[Path], registry: Registry, store: Path | None) -> None:
        self._registry = registry
        self._store = store
        self._runs: dict[Path, OpenRun] = {}
        self._lock = Lock()
        folders = list(dict.fromkeys(path.absolute() for path in paths))
        self._named = [folder for folder in folders if is_run(folder)]
        self._around = list(
            dict.fromkeys(each.parent if each in self._named else each for each in folders)
        )
        self.first = tuple(name for name, run in self.all().items() if run.folder in self._named)

    def all(self) -> Mapping[str, OpenRun]:
        """Return the runs by name, those that were named first, then by date, the latest first."""
        beside = sorted(
            {run for folder in self._around for run in runs_in(folder)} - {*self._named},
            key=lambda run: version_of(run / EVENTS),
            reverse=True,
        )
        folders = [*self._named, *beside]
        counts = Counter(folder.name for folder in folders)
        with self._lock:
            for folder in folders:
                name = folder.name if counts[folder.name] == 1 else str(folder)
                if folder not in self._runs:
                    number = len(self._runs)
                    self._runs[folder] = OpenRun(number, name, folder, self._registry, self._store)
                self._runs[folder].name = name
            return {self._runs[folder].name: self._runs[folder] for folder in folders}
