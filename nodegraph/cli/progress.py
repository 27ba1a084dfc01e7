"""The progress of a run on standard error: a bar in a terminal, else a line now and then."""

from __future__ import annotations

import re
import sys
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any

from nodegraph.execute.events import Event, EventKind
from nodegraph.formatting import name_at, number_of
from nodegraph.state import State

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

_MOST_LINES = 20
_INTERVAL = 0.1
_SOON = 2.0
"""Seconds after which a line says how long the run will take, as soon as that is known."""
_LONGEST = 40
_COUNTS = {
    "run": "computed",
    State.STORED: "already stored",
    State.REFUSED: "refused",
    State.FAILED: "failed",
    State.SKIPPED: "skipped",
}
_NUMBER = re.compile(r"\d+(?:\.\d+)?")


@contextmanager
def progress(*, quiet: bool = False) -> Iterator[Display]:
    """Show the progress of a run, whose listener is the display that is returned.

    Parameters
    ----------
    quiet
        Whether to show nothing but steps that fail.
    """
    with ExitStack() as ending:
        if sys.stderr.isatty() and not quiet:
            display: Display = ending.enter_context(_bar())
        else:
            display = _Quiet() if quiet else _Lines()
        ending.callback(display.close)
        yield display


class Display(ABC):
    """Shows events: how far the run is, and the first step of each kind of failure or refusal."""

    def __init__(self) -> None:
        self._kinds: set[tuple[str, str, str]] = set()
        self._more: Counter[str] = Counter()
        self._planned = 0

    def __call__(self, event: Event) -> None:
        """Show an event."""
        if event.kind == EventKind.PLANNED:
            self._planned = event.detail["steps"]
        if event.kind in (State.FAILED, State.REFUSED):
            self._show_step(event)
        self.show(event)

    @abstractmethod
    def say(self, text: str) -> None:
        """Show a line of text."""

    @abstractmethod
    def show(self, event: Event) -> None:
        """Show what an event says of the whole run."""

    def close(self) -> None:
        """Show at the end, also of an interrupted run, how many more steps failed."""
        for kind, count in self._more.items():
            self.say(f"and {count} more {kind}")

    def settled(self, detail: Mapping[str, Any]) -> tuple[int, int]:
        """Return the number of ended steps and of all steps, both without unneeded ones."""
        settled = sum(detail[name] for name in _COUNTS)
        # while stored results are looked up, the number of steps left is not known
        return settled, settled + detail["left"] if detail["left"] else self._planned

    def _show_step(self, event: Event) -> None:
        reason = _NUMBER.sub("", str(event.detail.get("reason", "")))
        kind = (event.kind, event.node, reason)
        if kind in self._kinds or len(self._kinds) == _MOST_LINES:
            self._more[event.kind] += 1
        else:
            self._kinds.add(kind)
            self.say(settled_line(event))


@contextmanager
def _bar() -> Iterator[_Bar]:
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
    )

    from nodegraph.cli.output import console

    columns = (
        TimeElapsedColumn(),
        BarColumn(bar_width=20),
        MofNCompleteColumn(),
        TextColumn("{task.fields[counts]}", markup=False),
        TextColumn("{task.description}", markup=False),
    )
    with Progress(*columns, console=console(sys.stderr), transient=True) as bar:
        yield _Bar(bar, bar.add_task("planning", total=None, counts=""))


class _Bar(Display):
    """A bar, which is not updated for every step: there may be many in a second."""

    def __init__(self, bar: Progress, task: TaskID) -> None:
        super().__init__()
        self._bar = bar
        self._task = task
        self._running: dict[int, str] = {}
        self._named = -_INTERVAL

    def say(self, text: str) -> None:
        self._bar.console.print(text, markup=False, highlight=False, soft_wrap=True)

    def show(self, event: Event) -> None:
        if event.kind == EventKind.PLANNED:
            self._bar.update(self._task, total=self._planned)
        elif event.kind == EventKind.PROGRESS:
            settled, total = self.settled(event.detail)
            counts = counts_text(event.detail)
            self._bar.update(self._task, completed=settled, total=total, counts=counts)
        elif event.kind == EventKind.STARTED:
            self._running[event.step] = name_at(event.node, event.labels)
            if event.seconds - self._named >= _INTERVAL:
                self._named = event.seconds
                self._bar.update(self._task, description=self._now())
        else:
            self._running.pop(event.step, None)

    def _now(self) -> str:
        """Return the step that has run for longest, and the number of others that run."""
        first = next(iter(self._running.values()))
        short = first if len(first) <= _LONGEST else f"{first[: _LONGEST - 1]}…"
        others = len(self._running) - 1
        return f"{short} and {others} more" if others else short


class _Lines(Display):
    """A line at the start, a few seconds later, after each tenth of the steps, and at the end."""

    def __init__(self) -> None:
        super().__init__()
        self._tenths = -1
        self._computed = 0

    def say(self, text: str) -> None:
        print(text, file=sys.stderr, flush=True)

    def show(self, event: Event) -> None:
        if event.kind == EventKind.PLANNED:
            nodes = number_of(len(event.detail["nodes"]), "node")
            self.say(f"{number_of(self._planned, 'step')} of {nodes}")
        elif event.kind == EventKind.PROGRESS:
            self._advance(event)
        elif event.kind == EventKind.FINISHED:
            counts = {"run": event.detail[State.DONE], **event.detail}
            self.say(f"finished after {event.seconds:.1f} s: {counts_text(counts)}")

    def _advance(self, event: Event) -> None:
        detail = event.detail
        settled, total = self.settled(detail)
        tenths = 10 * settled // total if total else 0
        is_soon = event.seconds < _SOON or detail["to_go"] is None
        if tenths <= self._tenths or (not tenths and is_soon):
            return
        self._tenths = tenths
        computed = detail["run"] + detail[State.FAILED] + detail[State.REFUSED]
        is_slow = detail["run"] or detail[State.FAILED]  # stored results take no time
        if is_slow and computed > self._computed:
            self._computed = computed
            after = _clock(event.seconds)
            self.say(f"{after}  {settled:,} of {number_of(total, 'step')}: {counts_text(detail)}")


class _Quiet(_Lines):
    """A line for each kind of failure, and no other."""

    def __call__(self, event: Event) -> None:
        if event.kind == State.FAILED:
            super().__call__(event)


def counts_text(detail: Mapping[str, Any]) -> str:
    """Return the counts of a ``progress`` event: ``120 computed, 33 left, 0:12 to go``."""
    parts = [f"{detail[name]:,} {word}" for name, word in _COUNTS.items() if detail.get(name)]
    parts += [f"{detail['left']:,} left"] if detail.get("left") else []
    parts += [f"{_clock(detail['to_go'])} to go"] if detail.get("to_go") else []
    return ", ".join(parts) or "nothing to do"


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


def settled_line(event: Event) -> str:
    """Return one line on the end of a step: ``failed: fill(length=5): no frame (mine.py:12)``."""
    where, place = name_at(event.node, event.labels), event.detail.get("place", "")
    text = f"{event.kind}: {where}: {event.detail.get('reason', '')}"
    text += f" ({place})" if place else ""
    # control characters would be commands to the terminal
    return "".join(character if character.isprintable() else " " for character in text)
