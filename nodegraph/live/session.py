"""A stream from its source through the live part of a graph to the sinks.

One thread receives packets, and computes what is in them: waking another thread would take longer
than many a node. While it does not keep up, frames wait, up to a limit, for another thread.
"""

from __future__ import annotations

import gc
import signal
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from contextvars import copy_context
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any, Literal

from nodegraph.equality import difference
from nodegraph.errors import NodegraphError
from nodegraph.execute.numeric_threads import one_thread_each, one_thread_here
from nodegraph.execute.run import execute
from nodegraph.gc_pause import gc_paused
from nodegraph.graph import Graph
from nodegraph.live.addresses import (
    RETRY_SECONDS,
    Outlet,
    check_addresses,
    open_end,
    outlets_of,
    reason_of,
    source_of,
)
from nodegraph.live.counts import Causes, Counts
from nodegraph.live.engine import Engine, Receiver, Tap
from nodegraph.live.forms import streamable_of
from nodegraph.live.packet_file import PacketFileWriter
from nodegraph.live.plan import LivePlan, live_plan
from nodegraph.live.running_numbers import Latest
from nodegraph.plan import Output, plan
from nodegraph.plugin.formats import formats_of
from nodegraph.plugin.loading import error_text
from nodegraph.plugin.streaming import JUMP, Frame, Sink, Source
from nodegraph.store import Store

Policy = Literal["every", "newest"]

_QUEUE = 1024
"""Frames that wait at most; then the receiving thread waits."""
_BACKLOG = 16
"""Frames that wait at most with the policy ``newest``; then all but the last are dropped."""
_RESTART = 16
"""Number of consecutive repeated frame numbers that mean that the source restarted."""
_POLL, _FULL = 0.1, 0.0005  # seconds
_LARGEST = 1 << 63
"""Frames have numbers and times in nanoseconds that fit into 64 bits with sign."""
_TIDY = 5_000
"""Frames between collections of garbage, which wait for a moment without frames, but not long."""


class _Reconnection:
    """Among what waits: what follows comes from another connection."""


@dataclass
class _End:
    """Among what waits: no frame follows; the error is why, if there is one."""

    error: NodegraphError | None = None
    is_of_node: bool = False
    """Whether the error is one of computing, not of the source."""


def session_of(
    graph: Graph,
    source: tuple[str, str | Source],
    sinks: Sequence[tuple[str, str | Sink]] = (),
    *,
    hold: Collection[str] = (),
    policy: Policy = "every",
    record: Path | None = None,
    store: Store | None = None,
    announce: Callable[[str], None] = lambda text: None,
) -> Session:
    """Return a session that runs what a stream can feed of a graph; what is held is computed.

    Parameters
    ----------
    graph
    source
        The place where the stream enters, see `live_plan`, and its address.
    sinks
        Nodes, or outputs, each with an address. Where alternatives run side by side, the address
        has their label: ``file:{fill}.npz``; a `Sink` takes one of them.
    hold
        As in `live_plan`.
    policy, announce
        As of `Session`.
    record
        File for the packets of the source.
    store
        Where what is held is looked up and stored.

    Raises
    ------
    GraphError, NodegraphError
        If the graph cannot run on the stream, a name is not known, or an address is not valid.
    """
    name, end = source
    planned = live_plan(graph, name, sinks=[node for node, _ in sinks], hold=hold)
    with formats_of(graph.registry):
        source_end = source_of(end) if isinstance(end, str) else end
        outlets = [outlet for node, sink in sinks for outlet in outlets_of(planned, node, sink)]
        check_addresses(outlets)
        values = _held_values(planned, store)
        address = end if isinstance(end, str) else type(end).__name__
        return Session(
            planned,
            values,
            source_end,
            address,
            outlets,
            policy=policy,
            record=PacketFileWriter(record, address) if record is not None else None,
            announce=announce,
        )


def _held_values(planned: LivePlan, store: Store | None) -> dict[Output, object]:
    """Compute what does not change while the stream runs."""
    nodes = dict.fromkeys(step.node for step in planned.held)
    if not nodes:
        return {}
    graph = planned.plan.graph
    run = execute(plan(graph.until(nodes)), store=store, keep=nodes)
    values = {}
    for output in {output for live in planned.steps for output in live.values.values()}:
        step = planned.plan.steps[output.step]
        port = step.method.node.outputs[output.position].name
        values[output] = run[f"{step.node}.{port}"].at(**step.labels)
    return values


class Session:
    """Runs the live part of a graph on a stream.

    Parameters
    ----------
    plan
    values
        Values of the outputs that are computed once, see `LivePlan.held`.
    source
    address
        The address of the source, as messages and recordings name it.
    outlets
    policy
        ``every``: each frame is computed, and the source waits, or loses frames, if that takes too
        long. ``newest``: if too many wait, all but the last are dropped, and the stream begins
        anew.
    record
        Keeps the packets.
    announce
        Called with what users should know while the stream runs.

    Attributes
    ----------
    plan : LivePlan
    counts : Counts
    is_lost : bool
        Whether the connection to the source is lost, and opened again until it is back.
    is_stopped : bool
        Whether the stream was ended by `stop`, or by an interruption of the program.
    """

    def __init__(
        self,
        plan: LivePlan,
        values: Mapping[Output, object],
        source: Source,
        address: str,
        outlets: Sequence[Outlet],
        *,
        policy: Policy,
        record: PacketFileWriter | None,
        announce: Callable[[str], None],
    ) -> None:
        self.counts = Counts()
        self.plan = plan
        self._latest = {output: Latest(form.numbers) for output, form in plan.running.items()}
        for output, latest in self._latest.items():
            self.counts.running[plan.plan.steps[output.step].name] = latest
        self._values = values
        self._source = source
        self._address = address
        self._outlets = outlets
        self._policy = policy
        self._record = record
        self._announce = announce
        self._watchers: Mapping[Output, Receiver] = {}
        self.is_lost = False
        self.is_stopped = False
        self._waiting: deque[Frame | _Reconnection | _End] = deque()
        self._is_wanted = threading.Event()
        """Whether something waits that the receiving thread does not compute."""
        self._computing = threading.Lock()
        self._stopped = threading.Event()
        self._expected: int | None = None
        self._back = 0
        """Frames in a row whose numbers follow each other, but lie before the expected one."""
        self._before: int | None = None
        """The number of the last of these."""
        self._absent: set[int] = set()
        self._next_tidy = _TIDY
        self._is_behind = True
        """Whether what arrived while the stream was opened is still being worked off."""

    def watch(self, receivers: Mapping[Output, Receiver]) -> None:
        """Have functions called with the frames of outputs, in the thread that computes them."""
        self._watchers = receivers

    @property
    def headers(self) -> Mapping[Output, object]:
        """The values without frames of each streamed output; there are some once frames are."""
        return self._engine.headers

    def stop(self) -> None:
        """End the stream; what has arrived is still computed."""
        self.is_stopped = True
        self._stopped.set()

    def run(self) -> Counts:
        """Compute the stream until it ends, or `stop` is called, or the program is interrupted.

        Raises
        ------
        NodegraphError
            If the source or a sink cannot be opened, or a node fails.
        """
        with ExitStack() as stack:
            stack.enter_context(formats_of(self.plan.plan.graph.registry))
            stack.enter_context(one_thread_each())
            stack.enter_context(self._counting_warnings())
            stack.callback(self._source.close)
            self._header = self._open_source()
            self._missing = streamable_of(type(self._header)).missing(self._header)
            thread = threading.Thread(target=copy_context().run, args=(self._receive,), daemon=True)
            stack.callback(self._end_of, thread)
            if self._record is not None:
                self._record.note_opening(self._header)
            self._engine = self._new_engine()
            for outlet in self._outlets:
                stack.callback(outlet.close)
                outlet.open(self._engine.headers[outlet.output])
            stack.enter_context(_interruptible(self.stop))
            gc.collect(1)  # what is left is old: the youngest are collected without it
            stack.enter_context(gc_paused())  # which would take milliseconds by chance
            self._announce(f"{self._address}: running; an interruption (Ctrl-C) ends the stream")
            thread.start()
            self._compute()
        return self.counts

    def _open_source(self) -> object:
        header = open_end(self._address, self._source.open)
        step = self.plan.plan.steps[self.plan.source.step]
        port = step.method.node.outputs[self.plan.source.position]
        if not isinstance(header, port.type):
            raise NodegraphError(
                f"{self._address}: gives {type(header).__name__}; {step.node}.{port.name} is "
                f"{port.type.__name__}"
            )
        return header

    def _new_engine(self) -> Engine:
        taps = [Tap(outlet.output, partial(outlet.write, self.counts)) for outlet in self._outlets]
        taps += [Tap(output, latest.receive) for output, latest in self._latest.items()]
        taps += [Tap(output, receive) for output, receive in self._watchers.items()]
        return Engine(self.plan, self._header, self._values, taps, self.counts.refused)

    def _receive(self) -> None:
        """Receive packets until the stream ends; the work of the receiving thread."""
        end = _End()
        try:
            with one_thread_here():
                self._receive_until_end()
        except NodegraphError as error:
            end.error = error
        except Exception as error:
            end.error = NodegraphError(f"{self._address}: failed: {error_text(error)}")
        self._leave(end)

    def _leave(self, item: _Reconnection | _End) -> None:
        """Let something wait for the computing thread."""
        self._waiting.append(item)
        self._is_wanted.set()

    def _receive_until_end(self) -> None:
        while not self._stopped.is_set():
            try:
                self._receive_packets()
                break
            except OSError as error:
                self._announce(f"{self._address}: {reason_of(error)}; waiting for it to return")
                self._source.close()
                self.is_lost = True
                self._open_again()
                self.is_lost = False

    def _receive_packets(self) -> None:
        counts, waiting, frames_in = self.counts, self._waiting, self._source.frames
        record, header, stopped = self._record, self._header, self._stopped
        for packet in self._source.packets():
            arrived = time.perf_counter_ns()
            if record is not None:
                record.write(packet, arrived)
            try:
                waiting.extend(map(_sound, frames_in(packet, arrived, header)))
            except ValueError as error:
                if not counts.undecodable:
                    self._announce(f"{self._address}: a packet is left out: {error}")
                counts.undecodable += 1
            if stopped.is_set():
                return
            if self._is_behind or len(waiting) > _BACKLOG or not self._computing.acquire(False):
                self._is_wanted.set()
                while len(waiting) >= _QUEUE and not stopped.is_set():
                    time.sleep(_FULL)
                continue
            try:
                self._work_off()
            except NodegraphError as error:
                self._leave(_End(error, is_of_node=True))
                return
            finally:
                self._computing.release()

    def _open_again(self) -> None:
        while not self._stopped.is_set():
            try:
                header = self._source.open()
            except (OSError, NodegraphError):  # nobody answers yet
                self._source.close()
                self._stopped.wait(RETRY_SECONDS)
                continue
            changed = difference(self._header, header, name="header")
            if changed:
                raise NodegraphError(f"{self._address}: returned as another stream: {changed}")
            self.counts.reconnected += 1
            if self._record is not None:
                self._record.note_opening(header)
            self._leave(_Reconnection())
            return

    def _end_of(self, thread: threading.Thread) -> None:
        self._stopped.set()
        self._source.close()
        if thread.is_alive():
            thread.join(2.0)
        if self._record is not None:
            self._record.close()

    def _compute(self) -> None:
        """Compute what the receiving thread leaves, until the stream ends."""
        while True:
            is_wanted = self._is_wanted.wait(_POLL)
            self._is_wanted.clear()
            self._computing.acquire()  # at the end it is kept: no frame is computed any more
            if self._work_off() or (self._stopped.is_set() and not is_wanted):
                self._engine.drain()
                return
            self._computing.release()

    def _work_off(self) -> bool:
        """Compute what waits; return whether the stream has ended."""
        waiting, newest = self._waiting, self._policy == "newest"
        while waiting:
            item = waiting.popleft()
            if isinstance(item, _End):
                if item.error is not None:
                    if not item.is_of_node:
                        self._engine.drain()
                    raise item.error
                return True
            if isinstance(item, _Reconnection):
                self._begin_anew()
                continue
            if newest and len(waiting) > _BACKLOG:
                item = self._last(item)
            self.counts.received += 1
            self._take(item)
            self._tidy()
        return False

    def _tidy(self) -> None:
        """Collect garbage from time to time."""
        idle = not self._waiting
        if idle:
            self._is_behind = False
        if self.counts.computed >= self._next_tidy + (0 if idle else 10 * _TIDY):
            gc.collect(1)
            self._next_tidy = self.counts.computed + _TIDY

    def _last(self, frame: Frame) -> Frame:
        """Return the last frame before an end or a new connection; those before it are dropped."""
        dropped = 0
        while self._waiting and isinstance(item := self._waiting[0], Frame):
            self._waiting.popleft()
            frame, dropped = item, dropped + 1
        self.counts.received += dropped
        self.counts.dropped += dropped
        self._begin_anew()
        return frame

    def _begin_anew(self) -> None:
        """End the stream as it is, and begin one whose frames know nothing about those before."""
        self._engine.drain()
        self._engine = self._new_engine()
        self._expected = None
        self._absent.clear()
        self.counts.resets += 1

    def _take(self, frame: Frame) -> None:
        """Compute a frame, after those that are missing before it."""
        index, expected = frame.index, self._expected
        if not self.counts.computed:
            self._warm_up(frame)
        if expected is not None and index != expected:
            if abs(index - expected) > JUMP:
                self._announce(f"{self._address}: after frame {expected - 1} comes {index}")
                self._begin_anew()
            elif index < expected and not self._has_restarted(index):
                if index in self._absent:
                    self.counts.late += 1
                    self._absent.discard(index)
                else:
                    self.counts.repeated += 1
                return
            elif index < expected:
                self._announce(f"{self._address}: numbers begin again at {index - _RESTART + 1}")
                self._begin_anew()
            else:
                self._skip(expected, frame)
        self._expected = index + 1
        self._back = 0
        self._engine.push(frame)
        self.counts.computed += 1
        if not self._is_behind:
            self.counts.latencies.add(time.perf_counter_ns() - frame.arrived)

    def _has_restarted(self, index: int) -> bool:
        """Return whether numbers before the expected one have followed each other for a while."""
        follows = self._before is not None and index == self._before + 1
        self._back = self._back + 1 if follows else 1
        self._before = index
        return self._back >= _RESTART

    def _warm_up(self, frame: Frame) -> None:
        """Compute a few frames that nobody sees, so that what is compiled at first use is."""
        engine = Engine(self.plan, self._header, self._values, (), Causes())
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for payload in (frame.payload, self._missing, frame.payload):
                engine.push(Frame(frame.index, 0, 0, payload))
            engine.drain()

    def _skip(self, first: int, frame: Frame) -> None:
        """Compute the frames from one number to before a frame as missing."""
        for index in range(first, frame.index):
            self._engine.push(Frame(index, 0, frame.arrived, self._missing))
            self.counts.computed += 1
            self.counts.missing += 1
        self._absent = {index for index in self._absent if index > frame.index - JUMP}
        self._absent.update(range(first, frame.index))

    @contextmanager
    def _counting_warnings(self) -> Iterator[None]:
        """Count what nodes warn of, which they may do in every frame."""

        def count(message: Warning | str, category: type, file: str, line: int, *_: object) -> None:
            self.counts.warnings.add((file, line), str(message))

        with warnings.catch_warnings():
            warnings.simplefilter("always")
            warnings.showwarning = count  # type: ignore[assignment]
            yield


def _sound(frame: Frame) -> Frame:
    """Return a frame whose number and time are possible; any other is a ValueError."""
    if not 0 <= frame.index < _LARGEST:
        raise ValueError(f"a frame of number {frame.index}")
    if not -_LARGEST <= frame.captured < _LARGEST:
        raise ValueError(f"a frame of {frame.captured} ns")
    return frame


@contextmanager
def _interruptible(stop: Callable[[], None]) -> Iterator[None]:
    """Let the first interruption of the program end the stream, and a second one the program."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    signals = (signal.SIGINT, signal.SIGTERM)
    before: dict[int, Any] = {number: signal.getsignal(number) for number in signals}

    def interrupted(number: int, frame: FrameType | None) -> None:
        stop()
        signal.signal(number, before[number])

    for number in signals:
        signal.signal(number, interrupted)
    try:
        yield
    finally:
        for number in signals:
            signal.signal(number, before[number])
