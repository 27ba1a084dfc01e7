"""The process that answers the browsers of a stream's page, so that they cannot slow the stream."""

from __future__ import annotations

import asyncio
import base64
import json
import os
import pickle
import sys
import threading
from collections import Counter, deque
from collections.abc import AsyncIterator, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any, Literal, NamedTuple

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.routing import Route

from nodegraph.live.counts import NUMBERS, Counts
from nodegraph.live.running_numbers import Latest
from nodegraph.serve.pages import html_response
from nodegraph.serve.server import LocalServer

State = Literal["waiting", "receiving", "lost", "ended"]

EVERY = 1 / 30
"""Seconds between two frames of the page."""
FIGURES = 8
"""Frames of the page between two looks at its figures."""

LAST = 5.0
"""Seconds over which rates and latencies are those of the last frames."""

_LONGEST = 300
"""Moments of the numbers over time; of more, every second is left out."""

_BEHIND = 10
"""Difference of its priority to that of the process that computes the stream."""

_SILENT = 1.0
"""Seconds without a frame after which a source is waited for."""


class Update(NamedTuple):
    """The changes since the previous message.

    Attributes
    ----------
    seconds : float
        Since the stream began.
    begun : mapping of group to data
        Data that scripts need before the first frame of a group.
    frames : mapping of group to sequence of bytes
        A frame for each panel.
    state : State
    message : str
        Why the stream has failed.
    counts : Counts or None
    """

    seconds: float
    begun: Mapping[str, object]
    frames: Mapping[str, Sequence[bytes]]
    state: State
    message: str = ""
    counts: Counts | None = None


def main() -> None:
    """Answer until standard input, on which messages come, is closed."""
    if sys.platform != "win32":
        os.nice(_BEHIND)
    messages = sys.stdin.buffer
    content: str = pickle.load(messages)
    shown = _Shown()
    server = LocalServer(lambda: _application(content, shown))
    print(server.address, flush=True)
    answering = threading.Thread(target=server.run)
    answering.start()
    try:
        with suppress(EOFError):
            while True:
                shown.take(pickle.load(messages))
    finally:
        server.end()


def _application(content: str, shown: _Shown) -> Starlette:
    def home(request: Request) -> Response:
        return html_response(content)

    def stream(request: Request) -> Response:
        names = request.query_params.getlist("show")
        return StreamingResponse(shown.events(names), media_type="text/event-stream")

    return Starlette(routes=[Route("/", home), Route("/stream", stream)])


class _Shown:
    """The current content of the page, which browsers take when they can.

    Nothing waits for a browser: each gets what is newest when it has taken what it had got.
    """

    def __init__(self) -> None:
        self._begun: dict[str, object] = {}
        self._frames: dict[str, list[str]] = {}
        self._figures: Mapping[str, Any] = {}
        """The counts in an event: a new mapping each time, so that no thread changes it."""
        self._is_over = False
        self._past: deque[tuple[float, Counts]] = deque()
        self._received_at = 0.0
        self._began_at: float | None = None
        self._history = _History()
        self._watched: Counter[str] = Counter()

    def take(self, update: Update) -> None:
        """Take a message."""
        self._begun |= update.begun
        for name, frames in update.frames.items():
            self._frames[name] = [base64.b64encode(frame).decode() for frame in frames]
        if update.counts is not None:
            if self._began_at is None and update.counts.received:
                self._began_at = update.seconds
            if self._began_at is not None:
                self._history.add(update.seconds - self._began_at, update.counts.running)
            self._figures = {
                "figures": self._figures_of(update, update.counts),
                "history": self._history.data,
            }
            self._is_over = update.state == "ended"

    def _figures_of(self, update: Update, counts: Counts) -> Mapping[str, object]:
        past = self._past
        if not past or counts.received > past[-1][1].received:
            self._received_at = update.seconds
        past.append((update.seconds, counts))
        while len(past) > 2 and past[1][0] <= update.seconds - LAST:
            past.popleft()
        before, earlier = past[0]
        seconds = update.seconds - before

        def rate(now: int, then: int) -> float:
            return round((now - then) / seconds, 1) if seconds else 0.0

        state = update.state
        if state == "receiving" and update.seconds - self._received_at > _SILENT:
            state = "waiting"
        return {
            "state": state,
            "message": update.message,
            "seconds": 0.0 if self._began_at is None else round(update.seconds - self._began_at, 1),
            "numbers": {name: getattr(counts, name) for name in NUMBERS},
            "rates": {
                "in": rate(counts.received, earlier.received),
                "out": rate(counts.computed, earlier.computed),
            },
            "latency": {
                "last": counts.latencies.since(earlier.latencies).milliseconds(),
                "all": counts.latencies.milliseconds(),
            },
            "sinks": {
                sink: {
                    "written": counts.written[sink],
                    "unsent": counts.unsent[sink],
                    "rate": rate(counts.written[sink], earlier.written[sink]),
                }
                for sink in {**counts.written, **counts.unsent}
            },
            "refused": counts.refused.as_json(),
            "warnings": counts.warnings.as_json(),
        }

    async def events(self, names: Sequence[str]) -> AsyncIterator[str]:
        """Yield the data for a page that shows some groups, until the stream ends."""
        self._watch(Counter(names))
        try:
            async for event in self._events(names):
                yield event
        finally:
            self._watch(Counter({name: -count for name, count in Counter(names).items()}))

    def _watch(self, names: Counter[str]) -> None:
        """Print which groups browsers show now: the others need no frames."""
        self._watched.update(names)
        print(json.dumps([name for name, count in self._watched.items() if count]), flush=True)

    async def _events(self, names: Sequence[str]) -> AsyncIterator[str]:
        yield "retry: 1000\n\n"
        sent: dict[str, object] = {}
        while True:
            is_over = self._is_over
            event = {
                "begun": self._unsent(sent, "begun", self._begun, names),
                "frames": self._unsent(sent, "frames", self._frames, names),
            }
            if self._figures is not sent.get("figures"):
                sent["figures"] = self._figures
                event |= self._figures
            if any(event.values()):
                yield f"data: {json.dumps(event)}\n\n"
            if is_over:
                return
            await asyncio.sleep(EVERY)

    def _unsent(
        self, sent: dict[str, object], kind: str, values: Mapping[str, object], names: Sequence[str]
    ) -> Mapping[str, object]:
        """Return the values of some names that were not sent yet, and note them."""
        new = {
            name: values[name]
            for name in names
            if name in values and values[name] is not sent.get(f"{kind} {name}")
        }
        sent.update({f"{kind} {name}": value for name, value in new.items()})
        return new


class _History:
    """Numbers that are kept current, over the time of a stream, thinned out as they become many."""

    def __init__(self) -> None:
        self._seconds: list[float] = []
        self._steps: dict[str, dict[str, list[float | None]]] = {}
        self._apart = 0.0
        """Seconds between two moments at least."""

    @property
    def data(self) -> Mapping[str, object]:
        """A copy: the moments, and at each the numbers of each step by their names."""
        steps = {
            step: {name: [*values] for name, values in numbers.items()}
            for step, numbers in self._steps.items()
        }
        return {"seconds": [*self._seconds], "steps": steps}

    def add(self, seconds: float, running: Mapping[str, Latest]) -> None:
        """Add what the numbers of each step are now, in place of the last if that is too near."""
        is_near = len(self._seconds) > 1 and self._seconds[-1] - self._seconds[-2] < self._apart
        for moments, value in self._with_values(round(seconds, 2), running):
            moments[len(moments) - is_near :] = [value]
        if len(self._seconds) > _LONGEST:
            for moments, _ in self._with_values(0.0, running):
                del moments[1:-1:2]
            self._apart = 2.0 * (self._apart or FIGURES * EVERY)

    def _with_values(
        self, seconds: float, running: Mapping[str, Latest]
    ) -> Iterator[tuple[list[Any], float | None]]:
        yield self._seconds, seconds
        for step, latest in running.items():
            numbers = self._steps.setdefault(step, {})
            for name, value in latest.as_json().items():
                rounded = None if value is None else float(f"{value:.4g}")
                yield numbers.setdefault(name, []), rounded
