"""The progress of a run, from the events that it writes."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from nodegraph.execute.events import EventKind
from nodegraph.formatting import name_at
from nodegraph.state import State

WAITING, RUNNING = "waiting", "running"
COUNTED = (WAITING, RUNNING, *(state.value for state in State if state is not State.UNNEEDED))
"""The states that steps are counted by; unneeded steps count as waiting."""

_MOST_BYTES = 1 << 24
_MOST_FAILURES = 20


@dataclass
class Progress:
    """The progress of a run according to its events.

    Attributes
    ----------
    planned : dict
        The first event: title, settings, number of steps of each node.
    last : str
        Kind of the last event.
    seconds : float
        From the begin of the run to the last event.
    left : int or None
        How many steps are still to be settled; None if that is not known yet.
    to_go : float or None
        Estimated seconds to the end.
    failures : list of str
        The first failures.
    unreadable : int
        Number of lines that are not events.
    """

    planned: dict[str, object] = field(default_factory=dict)
    last: str = ""
    seconds: float = 0.0
    left: int | None = None
    to_go: float | None = None
    failures: list[str] = field(default_factory=list)
    unreadable: int = 0
    _states: dict[int, tuple[str, str]] = field(default_factory=dict, repr=False)

    @property
    def nodes(self) -> dict[str, int]:
        """The number of steps of each node."""
        nodes = self.planned.get("nodes")
        return {
            str(name): steps
            for name, steps in (nodes.items() if isinstance(nodes, dict) else ())
            if isinstance(steps, int)
        }

    def read(self, line: bytes) -> None:
        """Take a line of the file of events."""
        try:
            self._take(
                json.loads(line, parse_int=_finite, parse_float=_finite, parse_constant=_finite)
            )
        except (ValueError, TypeError, LookupError, AttributeError, RecursionError):
            self.unreadable += 1

    def _take(self, event: Mapping[str, Any]) -> None:
        kind, seconds = str(event["event"]), float(event["seconds"])
        if kind == EventKind.PLANNED:
            self.planned = dict(event)
        elif kind in (EventKind.PROGRESS, EventKind.INTERRUPTED):
            self.left, self.to_go = _number(event.get("left")), _number(event.get("to_go"))
        elif "step" in event:
            self._settle(event, RUNNING if kind == EventKind.STARTED else kind)
        self.last, self.seconds = kind, seconds

    def counts(self, *, is_over: bool = False) -> dict[str, dict[str, int]]:
        """Return the number of steps of each node by state; states without any are absent.

        Parameters
        ----------
        is_over
            Whether nothing is running any more, whatever the events say.
        """
        counts: dict[str, Counter[str]] = {name: Counter() for name in self.nodes}
        for node, state in self._states.values():
            if not (is_over and state == RUNNING):
                counts.setdefault(node, Counter())[state] += 1
        for node, steps in self.nodes.items():
            counts[node][WAITING] = max(0, steps - counts[node].total())
        return {
            node: {state: states[state] for state in COUNTED if states[state]}
            for node, states in counts.items()
        }

    def _settle(self, event: Mapping[str, Any], state: str) -> None:
        node = str(event["node"])
        if state == State.FAILED and len(self.failures) < _MOST_FAILURES:
            self.failures.append(f"{name_at(node, event['labels'])}: {event['reason']}")
        self._states[int(event["step"])] = node, state


def _finite(text: str) -> float:
    """Return a number; one that is no finite 64-bit floating-point number is a ValueError."""
    if not math.isfinite(float(text)):
        raise ValueError(f"{text[:40]} is not a finite number")
    return float(text) if set(text) & set(".eE") else int(text)


def _number(value: object) -> Any:
    return value if isinstance(value, (int, float)) else None


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
        self._identity = 0
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
            status = self._path.stat()
            if status.st_ino != self._identity or status.st_size < self._read:  # another run
                self._identity, self._read, self._rest = status.st_ino, 0, b""
                self.progress = Progress()
            file.seek(self._read)
            while content := file.read(_MOST_BYTES):
                self._read += len(content)
                *lines, self._rest = (self._rest + content).split(b"\n")
                yield from lines
