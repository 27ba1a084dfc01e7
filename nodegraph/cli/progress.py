"""What a person sees in a terminal: progress while a run goes on, and lines otherwise."""

from __future__ import annotations

import sys
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from nodegraph.execute import Event, EventKind
from nodegraph.formatting import name_at
from nodegraph.state import State

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

_MOST_LINES = 20
_MOMENT = 0.1
_COUNTS = ("run", State.STORED, State.REFUSED, State.FAILED, State.SKIPPED)


@contextmanager
def progress() -> Iterator[Shown]:
    """Give what shows a run's progress: a bar in a terminal, else a line now and then.

    It is a listener of a run; its `say` shows a text of its own.
    """
    if sys.stderr.isatty():
        with _bar() as bar, bar.closing():
            yield bar
    else:
        lines = _Lines()
        with lines.closing():
            yield lines


class Shown(ABC):
    """Shows what a run tells; of what goes wrong the first lines, then only how much more."""

    def __init__(self) -> None:
        self._lines = 0
        self._more: Counter[str] = Counter()
        self._planned = 0

    def __call__(self, event: Event) -> None:
        """Hear an event."""
        self.hear(event)

    def hear(self, event: Event) -> None:
        """Show an event; of single steps only those that went wrong."""
        if event.kind == EventKind.PLANNED:
            self._planned = event.detail["steps"]
        if event.kind in (State.FAILED, State.REFUSED):
            self._wrong(event)
        elif event.kind not in (State.DONE, State.STORED, State.SKIPPED):
            self.show(event)

    @abstractmethod
    def say(self, text: str) -> None:
        """Show a line of text."""

    @abstractmethod
    def show(self, event: Event) -> None:
        """Show how far the run is, by an event that tells more than how one step ended."""

    @contextmanager
    def closing(self) -> Iterator[None]:
        """Say in the end, also of a run that is interrupted, how much more went wrong."""
        try:
            yield
        finally:
            for kind, count in self._more.items():
                self.say(f"and {count} more {kind}")

    def settled(self, detail: Mapping[str, Any]) -> tuple[int, int]:
        """Return how many steps are settled, and of how many: what is not needed is in neither."""
        settled = sum(detail[name] for name in _COUNTS)
        # while stored results are looked up, nobody knows yet what is left
        return settled, settled + detail["left"] if detail["left"] else self._planned

    def _wrong(self, event: Event) -> None:
        if self._lines == _MOST_LINES:
            self._more[event.kind] += 1
        else:
            self._lines += 1
            self.say(settled_line(event))


@contextmanager
def _bar() -> Iterator[_Bar]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[counts]}", markup=False),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        yield _Bar(shown, shown.add_task("planning", total=None, counts=""))


class _Bar(Shown):
    """A bar that is drawn anew as seldom as a person can see, however many steps there are."""

    def __init__(self, shown: Progress, task: TaskID) -> None:
        super().__init__()
        self._shown = shown
        self._task = task
        self._named = -_MOMENT

    def say(self, text: str) -> None:
        self._shown.console.print(text, markup=False, highlight=False, soft_wrap=True)

    def show(self, event: Event) -> None:
        if event.kind == EventKind.PLANNED:
            self._shown.update(self._task, total=self._planned)
        elif event.kind == EventKind.PROGRESS:
            settled, total = self.settled(event.detail)
            counts = counts_text(event.detail)
            self._shown.update(self._task, completed=settled, total=total, counts=counts)
        elif event.kind == EventKind.STARTED and event.seconds - self._named >= _MOMENT:
            self._named = event.seconds
            self._shown.update(self._task, description=event.node)


class _Lines(Shown):
    """One line at the start, at each tenth of the way, for what goes wrong, and at the end."""

    def __init__(self) -> None:
        super().__init__()
        self._tenths = 0
        self._computed = 0

    def say(self, text: str) -> None:
        print(text, file=sys.stderr, flush=True)

    def show(self, event: Event) -> None:
        if event.kind == EventKind.PLANNED:
            self.say(f"{self._planned} steps of {event.detail['nodes']} nodes")
        elif event.kind == EventKind.PROGRESS:
            self._advance(event.detail)
        elif event.kind == EventKind.FINISHED:
            counts = {"run": event.detail["done"], **event.detail}
            self.say(f"finished after {event.seconds:.1f} s: {counts_text(counts)}")

    def _advance(self, detail: Mapping[str, Any]) -> None:
        settled, total = self.settled(detail)
        tenths = 10 * settled // total if total else 0
        if tenths > self._tenths:
            self._tenths = tenths
            if not detail["run"] and not detail["failed"]:
                return  # stored results are looked up faster than anybody reads
            computed = detail["run"] + detail["failed"] + detail["refused"]
            if computed == self._computed:
                return  # as where all else is skipped
            self._computed = computed
            self.say(f"{settled} of {total} steps: {counts_text(detail)}")


def counts_text(detail: Mapping[str, Any]) -> str:
    """Return the counts of a ``progress`` event: ``run 120 · failed 2 · left 33 · 0:12 to go``."""
    parts = [f"{name} {detail[name]}" for name in _COUNTS if detail.get(name) or name == "run"]
    parts += [f"left {detail['left']}"] if detail.get("left") else []
    parts += [f"{_clock(detail['to_go'])} to go"] if detail.get("to_go") is not None else []
    return " · ".join(parts)


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


def settled_line(event: Event) -> str:
    """Return one line that says what became of a step."""
    where = name_at(event.node, event.labels)
    return _printable(f"{event.kind}: {where}: {event.detail.get('reason', '')}")


def _printable(text: str) -> str:
    """Return text on one line, without what a terminal would take for a command."""
    return "".join(one if one.isprintable() else " " for one in text)
