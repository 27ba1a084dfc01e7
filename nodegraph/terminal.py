"""What a person sees in a terminal: progress while a run goes on, and lines otherwise."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from nodegraph.execute import Event, Listener

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

_STATES = ("done", "refused", "failed", "skipped")


@contextmanager
def progress() -> Iterator[Listener]:
    """Give a listener that shows progress: a bar in a terminal, else a line now and then."""
    if sys.stderr.isatty():
        with _bar() as listener:
            yield listener
    else:
        yield _Lines(lambda line: print(line, file=sys.stderr, flush=True)).hear


@contextmanager
def _bar() -> Iterator[Listener]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeRemainingColumn as TimeToGo

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeToGo())
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        yield _Bar(shown, shown.add_task("planning", total=None)).hear


class _Bar:
    def __init__(self, shown: Progress, task: TaskID) -> None:
        self._shown = shown
        self._task = task
        self._counts: Counter[str] = Counter()

    def hear(self, event: Event) -> None:
        if event.kind == "planned":
            self._shown.update(self._task, total=event.detail["steps"])
        elif event.kind == "started":
            self._shown.update(self._task, description=event.node)
        elif event.kind in _STATES:
            self._counts[event.kind] += 1
            self._shown.advance(self._task)
            if event.kind in ("failed", "refused"):
                self._shown.console.print(settled_line(event), markup=False, highlight=False)


class _Lines:
    """One line at the start, at each tenth of the way, and for whatever goes wrong."""

    def __init__(self, write: Callable[[str], None]) -> None:
        self._write = write
        self._total = 0
        self._settled = 0

    def hear(self, event: Event) -> None:
        if event.kind == "planned":
            self._total = event.detail["steps"]
            self._write(f"{self._total} steps of {event.detail['nodes']} nodes")
        elif event.kind in _STATES:
            self._settle(event)

    def _settle(self, event: Event) -> None:
        if event.kind in ("failed", "refused"):
            self._write(settled_line(event))
        before = 10 * self._settled // self._total
        self._settled += 1
        if 10 * self._settled // self._total > before:
            self._write(f"{self._settled} of {self._total} steps, {event.seconds:.1f} s")


def settled_line(event: Event) -> str:
    """Return one line that says what became of a step."""
    labels = ", ".join(f"{axis}={label}" for axis, label in event.labels.items())
    where = f"{event.node}({labels})" if labels else event.node
    return f"{event.kind}: {where}: {event.detail.get('reason', '')}"


def columns(rows: Sequence[Sequence[str]]) -> str:
    """Return rows as aligned columns."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))] if rows else []
    lines = (
        "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    )
    return "\n".join(lines)
