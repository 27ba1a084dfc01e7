"""The progress of a run, from the events that it writes, and the states of its steps."""

from __future__ import annotations

import json
import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple, TypedDict

from nodegraph.execute.events import EventKind
from nodegraph.runs.record import Cell
from nodegraph.state import State

WAITING, RUNNING = "waiting", "running"
"""The states of steps that have not ended; in an unfinished run, unneeded steps are waiting."""

Counts = dict[str, Counter[str]]
"""The number of steps by state: of each node, and of each alternative, such as ``fill=muscle``."""

IN_ORDER = (
    State.FAILED, RUNNING, State.REFUSED, State.SKIPPED, State.DONE, State.STORED, State.UNNEEDED,
    WAITING,
)  # fmt: skip
"""All states, in the order in which a reader wants to know of them."""

_MARKED = (State.FAILED, RUNNING, WAITING, State.REFUSED, State.SKIPPED)
"""The states by which a node is marked, the first that any of its steps is in."""

_WITH_VALUE = frozenset(state.value for state in State if state.has_value)
_MOST_BYTES = 1 << 24
_HEAD = 1 << 16
"""Bytes with which events begin, by which runs in one folder are told apart: when each began."""
_MOST_FAILURES = 20


class StepState(NamedTuple):
    """The state of the step of one combination of a node.

    Attributes
    ----------
    cell : Cell
    state : str
        `WAITING`, `RUNNING`, or how the step ended.
    reason : str
        Why there is no value.
    place : str
        The line in the code of the node where it failed.
    """

    cell: Cell
    state: str
    reason: str = ""
    place: str = ""

    @property
    def has_value(self) -> bool:
        """Whether there is a value, which may have to be computed first."""
        return self.state in _WITH_VALUE

    @property
    def message(self) -> str:
        """The reason with its place."""
        return f"{self.reason} ({self.place})" if self.place else self.reason


def counts_of(states: Iterable[StepState]) -> defaultdict[str, Counter[str]]:
    """Return how many combinations of each node and alternative are in each state."""
    counts: defaultdict[str, Counter[str]] = defaultdict(Counter)
    for each in states:
        _count(counts, each, 1)
    return counts


def _count(counts: defaultdict[str, Counter[str]], state: StepState, steps: int) -> None:
    for name in {state.cell.node, state.cell.group}:
        counts[name][state.state] += steps


class NodeState(TypedDict):
    """The states of the steps of a node or an alternative together, as plain data.

    Attributes
    ----------
    counts : dict of state to int
    text : str
        The same in words: ``4 of 408 refused, 404 done``.
    mark : str
        The state that matters most; ``done`` if every step has a value.
    settled : float
        Share of the steps that have ended.
    """

    counts: dict[str, int]
    text: str
    mark: str
    settled: float


def node_state(counts: Mapping[str, int]) -> NodeState:
    """Return the states of the steps of a node or an alternative together."""
    known = {str(state): counts[state] for state in IN_ORDER if counts.get(state)}
    total = sum(known.values())
    texts = [f"{count:,} {state}" for state, count in known.items()]
    if len(known) > 1:
        texts[0] = texts[0].replace(" ", f" of {total:,} ")
    open_steps = known.get(RUNNING, 0) + known.get(WAITING, 0)
    return {
        "counts": known,
        "text": ", ".join(texts) or "no steps",
        "mark": str(next((state for state in _MARKED if state in known), State.DONE)),
        "settled": 1 - open_steps / max(total, 1),
    }


def states_of(counts: Counts) -> dict[str, dict[str, NodeState]]:
    """Return the states of the nodes, and those of the alternatives."""
    states: dict[str, dict[str, NodeState]] = {"nodes": {}, "alternatives": {}}
    for name, each in counts.items():
        states["alternatives" if "=" in name else "nodes"][name] = node_state(each)
    return states


def failures_of(states: Iterable[StepState]) -> list[str]:
    """Return the first failures."""
    failed = (each for each in states if each.state == State.FAILED)
    return [f"{each.cell.name}: {each.message}" for each in islice(failed, _MOST_FAILURES)]


@dataclass
class Progress:
    """The progress of a run according to its events.

    Attributes
    ----------
    planned : dict
        The first event: title, settings, number of steps of each node.
    seconds : float
        From the begin of the run to the last event.
    to_go : float or None
        Estimated seconds to the end.
    states : dict of step to StepState
        States of the steps that have begun or ended.
    failures : list of str
        The first failures.
    """

    planned: dict[str, object] = field(default_factory=dict)
    seconds: float = 0.0
    to_go: float | None = None
    states: dict[int, StepState] = field(default_factory=dict, repr=False)
    failures: list[str] = field(default_factory=list)
    _counts: defaultdict[str, Counter[str]] = field(
        default_factory=lambda: defaultdict(Counter), repr=False
    )

    def read(self, line: bytes) -> None:
        """Take a line of the file of events."""
        # what is no event is passed over
        with suppress(ValueError, TypeError, LookupError, AttributeError, RecursionError):
            self._take(
                json.loads(line, parse_int=_finite, parse_float=_finite, parse_constant=_finite)
            )

    def _take(self, event: Mapping[str, Any]) -> None:
        kind, seconds = str(event["event"]), float(event["seconds"])
        if kind == EventKind.PLANNED:
            self.planned = dict(event)
        elif kind in (EventKind.PROGRESS, EventKind.INTERRUPTED):
            to_go = event.get("to_go")
            self.to_go = to_go if isinstance(to_go, (int, float)) else None
        elif "step" in event:
            self._settle(event, RUNNING if kind == EventKind.STARTED else kind)
        self.seconds = seconds

    def counts(self, *, is_over: bool = False) -> Counts:
        """Return the number of steps of each node and alternative by state.

        Parameters
        ----------
        is_over
            Whether nothing is running any more, whatever the events say.
        """
        counts: Counts = {}
        kinds = [self.planned.get(kind) for kind in ("nodes", "alternatives")]
        planned = {
            str(name): steps
            for kind in kinds
            if isinstance(kind, dict)
            for name, steps in kind.items()
            if isinstance(steps, int)
        }
        for name in {**planned, **self._counts}:
            states = Counter(self._counts[name])
            if is_over:
                del states[RUNNING]
            states[WAITING] = max(0, planned.get(name, 0) - states.total())
            counts[name] = +states
        return counts

    def _settle(self, event: Mapping[str, Any], state: str) -> None:
        index, cell = int(event["step"]), Cell(str(event["node"]), dict(event.get("labels", {})))
        now = StepState(cell, state, str(event.get("reason", "")), str(event.get("place", "")))
        before = self.states.get(index)
        if before is not None:
            _count(self._counts, before, -1)
        _count(self._counts, now, 1)
        self.states[index] = now
        if len(self.failures) < _MOST_FAILURES:
            self.failures += failures_of([now])


def _finite(text: str) -> float:
    """Return a number; one that is no finite 64-bit floating-point number is a ValueError."""
    if not math.isfinite(float(text)):
        raise ValueError(f"{text[:40]} is not a finite number")
    return float(text) if set(text) & set(".eE") else int(text)


class EventFile:
    """A file of events that is being written.

    Parameters
    ----------
    path

    Attributes
    ----------
    progress : Progress
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._head = b""
        self._read = 0
        self._rest = b""
        self.progress = Progress()

    def update(self) -> bool:
        """Read what was written since; return whether there was any.

        Raises
        ------
        OSError
            If the file cannot be read.
        """
        lines = list(self._lines())
        for line in lines:
            self.progress.read(line)
        return bool(lines)

    def _lines(self) -> Iterator[bytes]:
        """Yield the lines that are complete."""
        with self._path.open("rb") as file:
            head = file.read(_HEAD)
            if not head.startswith(self._head):  # another run; its file may have the same number
                self._read, self._rest = 0, b""
                self.progress = Progress()
            self._head = head
            file.seek(self._read)
            while content := file.read(_MOST_BYTES):
                self._read += len(content)
                *lines, self._rest = (self._rest + content).split(b"\n")
                yield from lines
