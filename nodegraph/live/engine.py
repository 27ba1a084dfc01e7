"""Compute the live part of a graph frame by frame, every branch aligned on the same frame."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter
from traceback import walk_tb
from typing import Any

from nodegraph.errors import NodegraphError, Refusal, message_of
from nodegraph.execute.outcome import failure
from nodegraph.live.counts import Causes
from nodegraph.live.forms import live_state, streamable_of
from nodegraph.live.plan import LivePlan, LiveStep
from nodegraph.node.live_form import LiveState
from nodegraph.plan import Output
from nodegraph.plugin.streaming import Frame

Receiver = Callable[[Frame], None]
Step = Callable[[list[Any]], None]
"""Computes one step in one frame: takes payloads from their places, and puts others there."""

_SOURCE, _OPEN = 0, 1
"""Indices of the payload of the source, and of a port left open, which never has a payload."""


@dataclass(frozen=True)
class Tap:
    """Who takes the frames of one output.

    Attributes
    ----------
    output : Output
    receive : callable
        Called with each frame, in order.
    """

    output: Output
    receive: Receiver


class Engine:
    """Computes one stream from its first frame on.

    Parameters
    ----------
    plan
    header
        The header of the stream: the source's value without frames.
    values
        Values of the outputs that are computed once.
    taps
        Who takes the frames of which output.
    refused
        Counts frames that a step refused, with its name and the reason.

    Attributes
    ----------
    headers : mapping of Output to value
        The header of each streamed output.
    """

    def __init__(
        self,
        plan: LivePlan,
        header: object,
        values: Mapping[Output, object],
        taps: Iterable[Tap],
        refused: Causes,
    ) -> None:
        self.headers: dict[Output, object] = {plan.source: header}
        self.count = 0
        slots, behind = {plan.source: _SOURCE}, {plan.source: 0}
        self._payloads: list[object] = [None, None]
        parts: list[_Delay | _Runner] = []
        for live in plan.steps:
            state = _state(live, self.headers, values)
            sources = []
            for output in map(live.streams.get, live.step.method.node.streams):
                source = _OPEN if output is None else slots[output]
                delay = live.behind - live.lookahead - behind[output] if output else 0
                if delay:
                    delayed = self._new_slot()
                    parts.append(_Delay(source, delayed, delay))
                    source = delayed
                sources.append(source)
            headers = state.header if live.step.method.node.splits else (state.header,)
            targets = []
            for position, each in enumerate(headers):
                output = Output(live.step.index, position)
                self.headers[output], behind[output] = each, live.behind
                slots[output] = self._new_slot()
                targets.append(slots[output])
            missing = tuple(
                None if each is None else streamable_of(type(each)).missing(each)
                for each in headers
            )
            parts.append(_Runner(self, live, state, sources, targets, missing, refused))
        self._parts = parts
        self._steps = [part.step() for part in parts]
        self._taps = [(slots[tap.output], behind[tap.output], tap.receive) for tap in taps]
        longest = max((delay for _, delay, _ in self._taps), default=0)
        self._frames: deque[Frame] = deque(maxlen=longest + 1)

    def _new_slot(self) -> int:
        self._payloads.append(None)
        return len(self._payloads) - 1

    def push(self, frame: Frame) -> None:
        """Compute a frame, which follows the one before without a gap.

        Raises
        ------
        NodegraphError
            If a step fails.
        """
        payloads, frames = self._payloads, self._frames
        payloads[_SOURCE] = frame.payload
        frames.append(frame)
        for step in self._steps:
            step(payloads)
        self.count += 1
        for slot, delay, receive in self._taps:
            payload = payloads[slot]
            if payload is not None:
                index, captured, arrived, _ = frames[-1 - delay]
                receive(Frame(index, captured, arrived, payload))

    def drain(self) -> None:
        """Compute what is left, now that no frame follows."""
        rest: dict[int, list[object]] = {_SOURCE: []}
        for part in self._parts:
            rest.update(part.drain(rest))
        frames = list(self._frames)
        for slot, _, receive in self._taps:
            last = frames[len(frames) - len(rest[slot]) :]
            for (index, captured, arrived, _), payload in zip(last, rest[slot], strict=True):
                receive(Frame(index, captured, arrived, payload))


class _Delay:
    """Gives the payloads of an output some frames later, where a step waits for another."""

    def __init__(self, source: int, target: int, delay: int) -> None:
        self._source = source
        self._target = target
        self._delay = delay
        self._waiting: deque[object] = deque()

    def step(self) -> Step:
        """Return the function that does so for one frame."""
        source, target, delay, waiting = self._source, self._target, self._delay, self._waiting

        def step(payloads: list[object]) -> None:
            payload = payloads[source]
            if payload is not None:
                waiting.append(payload)
                if len(waiting) > delay:
                    payloads[target] = waiting.popleft()

        return step

    def drain(self, rest: Mapping[int, list[object]]) -> dict[int, list[object]]:
        """Return the last payloads."""
        return {self._target: [*self._waiting, *rest[self._source]]}


class _Runner:
    """One step at work: from the payloads of its inputs to those of its outputs.

    Parameters
    ----------
    engine
        Counts the frames.
    live, state
    sources
        Where the payload of each port that takes frames lies.
    targets
        Where the payloads of the outputs are put.
    missing
        The payloads of a frame that the step refuses.
    refused
    """

    def __init__(
        self,
        engine: Engine,
        live: LiveStep,
        state: LiveState,
        sources: Sequence[int],
        targets: Sequence[int],
        missing: tuple[object, ...],
        refused: Causes,
    ) -> None:
        self._engine = engine
        self._live = live
        self._state = state
        self._sources = sources
        self._targets = targets
        self._missing = missing
        self._refused = refused
        self._splits = live.step.method.node.splits
        self._first = next(source for source in sources if source != _OPEN)

    def step(self) -> Step:
        """Return the function that computes the step for one frame.

        It is made once, since a look-up of an attribute counts in every frame.
        """
        if self._splits:
            return self._to_many()
        return self._one_to_one() if len(self._sources) == 1 else self._many_to_one()

    def _one_to_one(self) -> Step:
        push, failed = self._state.push, self._failed
        (source,), (target,) = self._sources, self._targets

        def step(payloads: list[object]) -> None:
            payload = payloads[source]
            if payload is not None:
                try:
                    payloads[target] = push(payload)
                except Exception as error:
                    payloads[target] = failed(error)

        return step

    def _many_to_one(self) -> Step:
        push, failed, take = self._state.push, self._failed, itemgetter(*self._sources)
        first, (target,) = self._first, self._targets

        def step(payloads: list[object]) -> None:
            if payloads[first] is not None:  # then the others are there as well
                try:
                    payloads[target] = push(*take(payloads))
                except Exception as error:
                    payloads[target] = failed(error)

        return step

    def _to_many(self) -> Step:
        push, failed, first = self._state.push, self._failed, self._first
        sources, targets = self._sources, self._targets

        def step(payloads: list[object]) -> None:
            if payloads[first] is not None:
                try:
                    results = push(*[payloads[source] for source in sources])
                except Exception as error:
                    results = failed(error)
                if results is not None:
                    for target, payload in zip(targets, results, strict=True):
                        payloads[target] = payload

        return step

    def drain(self, rest: Mapping[int, list[object]]) -> dict[int, list[object]]:
        """Return the last payloads of each output, from those of the inputs."""
        fed = [rest[source] for source in self._sources if source != _OPEN]
        columns = [
            [None] * len(fed[0]) if source == _OPEN else rest[source] for source in self._sources
        ]
        results = []
        lookahead = self._live.lookahead
        first = max(self._engine.count - (self._live.behind - lookahead), 0)
        for taken, row in enumerate(zip(*columns, strict=True), first):
            try:
                result = self._state.push(*row)
            except Exception as error:
                result = self._failed(error, due=taken >= lookahead)
            if result is not None:
                results.append(result)
        rest_of_state = iter(self._state.drain())
        while True:
            try:
                results.append(next(rest_of_state))
            except StopIteration:
                break
            except Exception as error:
                results.append(self._failed(error, due=True))
        rows = results if self._splits else [(result,) for result in results]
        return {
            target: [row[position] for row in rows] for position, target in enumerate(self._targets)
        }

    def _failed(self, error: Exception, *, due: bool | None = None) -> object:
        """Return the payload of a frame that the step refuses, None if none is due yet."""
        if not isinstance(error, Refusal):
            raise self._error(error) from error
        name = self._live.step.name
        *_, (frame, line) = walk_tb(error.__traceback__)
        cause = (name, frame.f_code.co_filename, line)
        self._refused.add(cause, f"{name}: {message_of(error)}")
        if not (self._engine.count >= self._live.behind if due is None else due):
            return None
        return self._missing if self._splits else self._missing[0]

    def _error(self, error: Exception) -> NodegraphError:
        outcome = failure(self._live.step.method.node, error)
        return NodegraphError(
            f"{self._live.step.name}: frame {self._engine.count} of the stream: {outcome.message}"
        )


def _state(
    live: LiveStep, headers: Mapping[Output, object], values: Mapping[Output, object]
) -> LiveState:
    node = live.step.method.node
    ports = {port: headers[live.streams[port]] for port in node.streams if port in live.streams}
    whole = {port: values[output] for port, output in live.values.items()}
    try:
        return live_state(node, ports, whole, live.step.settings)
    except Exception as error:
        outcome = failure(node, error, "its live form")
        raise NodegraphError(f"{live.step.name}: {outcome.message}") from error
