"""What happens during a run, as a stream that progress, logs and other programs draw from."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Event:
    """One thing that happened.

    Attributes
    ----------
    kind : str
        ``planned``, ``started``, ``done``, ``refused``, ``failed``, ``skipped`` or ``finished``.
    seconds : float
        Since the run began.
    step : int
        The step's index in the plan, or -1 for the run as a whole.
    node : str
    labels : mapping of axis to label
    detail : mapping
        What else there is to say: a reason, warnings, counts.
    """

    kind: str
    seconds: float
    step: int = -1
    node: str = ""
    labels: Mapping[str, Any] = field(default_factory=dict)
    detail: Mapping[str, Any] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """Return the event as plain data, for a line of JSON."""
        plain: dict[str, Any] = {"event": self.kind, "seconds": round(self.seconds, 6)}
        if self.step >= 0:
            plain |= {"step": self.step, "node": self.node, "labels": dict(self.labels)}
        return plain | dict(self.detail)


Listener = Callable[[Event], None]


class Clock:
    """Seconds since the run began."""

    def __init__(self) -> None:
        self._began = time.perf_counter()

    def seconds(self) -> float:
        """Return the seconds since the run began."""
        return time.perf_counter() - self._began
