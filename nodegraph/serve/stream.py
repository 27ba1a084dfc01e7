"""The page of a stream: what is computed, as it is computed, in browsers on this machine.

The thread that computes only leaves its newest frames where another thread finds them, which packs
them thirty times per second for the process that answers the browsers.
"""

from __future__ import annotations

import json
import pickle
import threading
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from subprocess import TimeoutExpired
from types import TracebackType

from nodegraph.errors import NodegraphError
from nodegraph.execute.processes import kill, start
from nodegraph.live.forms import streamable_of
from nodegraph.live.plan import LivePlan, not_given
from nodegraph.live.session import Session
from nodegraph.plan import Output
from nodegraph.plugin.formats import formats_of
from nodegraph.plugin.hook_results import HookResults
from nodegraph.plugin.streaming import Frame, LiveView
from nodegraph.report.page import SCRIPTS, source
from nodegraph.serve.pages import json_in_script, own_source, page_response
from nodegraph.serve.stream_server import EVERY, FIGURES, State, Update

_PATIENCE = 3.0
"""Seconds for the process to end."""


@dataclass(eq=False)
class _Shown:
    """One output on the page, with its alternatives side by side.

    Attributes
    ----------
    name : str
        The name of the node, or ``node.output``.
    view : LiveView
    panels : mapping of label to Output
    """

    name: str
    view: LiveView
    panels: Mapping[str, Output]
    is_broken: bool = False
    sent: list[Frame] = field(default_factory=list)


class StreamPage:
    """Shows a session while it runs, and its last state as long as the context lasts.

    Parameters
    ----------
    session
        Not yet run.
    title
        The title of the graph.
    facts
        Further lines at the head of the page, such as the source.
    announce
        Called with what cannot be shown.

    Attributes
    ----------
    address : str
        Lets one browser in.
    """

    def __init__(
        self,
        session: Session,
        title: str,
        facts: Sequence[str],
        announce: Callable[[str], None],
    ) -> None:
        self._session = session
        self._announce = announce
        self._registry = session.plan.plan.graph.registry
        self._source = session.plan.source
        shown = list(_shown(session.plan, self._registry.hooks))
        self._to_begin = dict.fromkeys(shown)
        self._begun: list[tuple[_Shown, object]] = []
        """The outputs that are shown, each with the data for scripts."""
        self._sent_begun = 0
        self._newest: dict[Output, Frame] = {}
        self._watched: Collection[str] = ()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._follow, daemon=True)
        self._start = time.monotonic()
        self._process = start("nodegraph.serve.stream_server", pipe_output=True)
        self._send(_content(session.plan, shown, title, facts))
        assert self._process.stdout is not None
        self.address = self._process.stdout.readline().decode().strip()
        if not self.address:
            raise NodegraphError("the page of the stream cannot be served")

    def __enter__(self) -> StreamPage:
        outputs = {output for shown in self._to_begin for output in shown.panels.values()}
        receivers = {output: partial(self._newest.__setitem__, output) for output in outputs}
        self._session.watch({**receivers, self._source: self._take})
        self._thread.start()
        threading.Thread(target=self._listen, daemon=True).start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.end(str(error or ""))
        assert self._process.stdin is not None
        with suppress(OSError):
            self._process.stdin.close()
        with suppress(TimeoutExpired):
            self._process.wait(_PATIENCE)
        kill(self._process)

    def end(self, message: str = "") -> None:
        """Show that the stream has ended, and why it has failed if it has."""
        if self._ended.is_set():
            return
        self._ended.set()
        self._thread.join()
        with formats_of(self._registry), suppress(OSError):
            self._send(self._update("ended", message, with_counts=True))

    def _take(self, frame: Frame) -> None:
        """Take a frame of the source, in the thread that computes.

        What takes longer is done here before the stream is under way: beside it, it would delay
        frames for some time.
        """
        self._newest[self._source] = frame
        for shown in [*self._to_begin]:
            frames = self._frames(shown)
            if not frames:
                continue
            try:
                data = shown.view.begin(dict(self._values(shown, frames)))
            except NodegraphError as error:
                self._announce(f"{shown.name} is not shown: {error}")
                del self._to_begin[shown]
                continue
            if data is not None:
                self._begun.append((shown, data))
                del self._to_begin[shown]

    def _listen(self) -> None:
        """Read which outputs browsers show now."""
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._watched = json.loads(line)

    def _follow(self) -> None:
        with formats_of(self._registry):
            ticks = 0
            while not self._ended.wait(EVERY):
                try:
                    update = self._update(self._state, with_counts=ticks % FIGURES == 0)
                    if update.begun or update.frames or update.counts:
                        self._send(update)
                except OSError:
                    self._announce("the page of the stream is no longer served")
                    return
                ticks += 1

    @property
    def _state(self) -> State:
        if self._session.is_lost:
            return "lost"
        return "receiving" if self._session.counts.received else "waiting"

    def _send(self, message: str | Update) -> None:
        assert self._process.stdin is not None
        # at once, so that no count changes meanwhile
        self._process.stdin.write(pickle.dumps(message, pickle.HIGHEST_PROTOCOL))
        self._process.stdin.flush()

    def _update(self, state: State, message: str = "", *, with_counts: bool) -> Update:
        """Return the new frames of the outputs that browsers show; at the end, of all outputs."""
        frames: dict[str, list[bytes]] = {}
        begun = {shown.name: data for shown, data in self._begun[self._sent_begun :]}
        self._sent_begun += len(begun)
        for shown, _ in self._begun:
            newest = self._frames(shown)
            is_new = [*map(id, newest)] != [*map(id, shown.sent)]
            is_watched = shown.name in self._watched or state == "ended"
            if is_new and is_watched and not shown.is_broken:
                shown.sent = newest
                try:
                    frames[shown.name] = [shown.view.pack(frame.payload) for frame in newest]
                except NodegraphError as error:
                    shown.is_broken = True
                    self._announce(f"{shown.name} is not shown: {error}")
        seconds = time.monotonic() - self._start
        counts = self._session.counts if with_counts else None
        return Update(seconds, begun, frames, state, message, counts)

    def _frames(self, shown: _Shown) -> list[Frame]:
        """Return the newest frame of each panel; none if one has none."""
        frames = [self._newest.get(output) for output in shown.panels.values()]
        return [] if None in frames else [frame for frame in frames if frame]

    def _values(self, shown: _Shown, frames: Sequence[Frame]) -> Iterator[tuple[str, object]]:
        """Yield a frame of each panel as a value."""
        for (label, output), frame in zip(shown.panels.items(), frames, strict=True):
            header = self._session.headers[output]
            yield label, streamable_of(type(header)).join(header, [frame.payload])


def _shown(plan: LivePlan, hooks: HookResults) -> Iterator[_Shown]:
    """Yield each output that a view shows, beside that of the source if that has the same view."""
    outputs = [plan.source]
    outputs += [
        Output(step.step.index, position)
        for step in plan.steps
        for position in range(len(step.step.method.node.outputs))
    ]
    names: dict[str, LiveView] = {}
    for output in outputs:
        step = plan.plan.steps[output.step]
        port = step.method.node.outputs[output.position]
        kind = hooks.kind(port.type, "live_view")
        view = kind.live_view() if kind is not None and kind.live_view is not None else None
        if view is not None and not not_given(plan.plan, output):
            names[f"{step.node}.{port.name}" if output.position else step.node] = view
    first: tuple[LiveView | None, Mapping[str, Output]] = (None, {})
    for name, view in names.items():
        panels = _by_label(plan, name)
        if plan.source in panels.values():
            first = (view, panels)
        yield _Shown(name, view, {**first[1], **panels} if view is first[0] else panels)


def _by_label(plan: LivePlan, name: str) -> Mapping[str, Output]:
    """Return the outputs side by side that a name means, in the order of the graph's labels."""
    axes = plan.plan.graph.axes
    outputs = sorted(
        plan.outputs(name).items(),
        key=lambda pair: [axes[axis].labels.index(label) for axis, label in pair[1].items()],
    )
    return {", ".join(map(str, labels.values())) or name: output for output, labels in outputs}


def _running(plan: LivePlan) -> Iterator[Mapping[str, object]]:
    """Yield each node in whose place numbers are kept current, with its steps by their labels."""
    nodes = {plan.plan.steps[output.step].node: form for output, form in plan.running.items()}
    for node, form in nodes.items():
        outputs = _by_label(plan, node)
        steps = {label: plan.plan.steps[output.step].name for label, output in outputs.items()}
        yield {"name": node, "units": dict(form.numbers), "steps": steps}


def _content(plan: LivePlan, shown: Sequence[_Shown], title: str, facts: Sequence[str]) -> str:
    """Return the page, which gets everything else from the stream of events."""
    behind = {live.step.index: live.behind for live in plan.steps}
    views = list({id(each.view): each.view for each in shown}.values())
    groups = [
        {
            "name": each.name,
            "view": next(place for place, view in enumerate(views) if view is each.view),
            "module": each.view.module,
            "labels": list(each.panels),
            "behind": max(behind.get(output.step, 0) for output in each.panels.values()),
        }
        for each in shown
    ]
    modules = json_in_script(list(dict.fromkeys(view.module for view in views)))
    scripts = [*(source(f"{name}.js") for name in SCRIPTS), own_source("lines.js")]
    scripts += [script for view in views for script in view.scripts]
    scripts.append(
        own_source("stream.js")
        .replace("__MODULES__", modules)
        .replace("__GROUPS__", json_in_script(groups))
        .replace("__RUNNING__", json_in_script(list(_running(plan))))
    )
    styles = (style for view in views for style in view.styles)
    response = page_response(
        "stream.html",
        title=title,
        facts=facts,
        scripts=scripts,
        styles=[own_source("stream.css"), *styles],
    )
    return bytes(response.body).decode()
