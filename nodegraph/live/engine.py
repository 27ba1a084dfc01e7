"""Compute the live part of a graph frame by frame, every branch aligned on the same frame."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, repeat
from typing import Any

from nodegraph.errors import NodegraphError, Refusal, message_of
from nodegraph.execute.call import failure
from nodegraph.live.forms import live_state, streamable_of
from nodegraph.live.plan import LivePlan, LiveStep
from nodegraph.node.live_form import LiveState
from nodegraph.plan import Output
from nodegraph.plugin.streaming import Frame

Receiver = Callable[[Frame], None]


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
        Of the stream: the source's value without frames.
    values
        Of the outputs that are computed once.
    taps
        Who takes the frames of which output.
    refused
        Counts frames that a step refused, by its name and the reason.

    Attributes
    ----------
    headers : mapping of Output to value
        Of each streamed output.
    """

    def __init__(
        self,
        plan: LivePlan,
        header: Any,
        values: Mapping[Output, Any],
        taps: Iterable[Tap],
        refused: Counter[str],
    ) -> None:
        self.headers: dict[Output, Any] = {plan.source: header}
        slots, behind = {plan.source: 0}, {plan.source: 0}
        self._runners: list[_Runner] = []
        for live in plan.steps:
            state = _state(live, self.headers, values)
            latest = live.behind - live.lookahead
            inputs = [
                _Input(slots[output], latest - behind[output]) if output else None
                for output in map(live.streams.get, live.step.method.node.streams)
            ]
            splits = live.step.method.node.splits
            headers = state.header if splits else (state.header,)
            outputs = [Output(live.step.index, position) for position in range(len(headers))]
            for output, each in zip(outputs, headers, strict=True):
                self.headers[output], behind[output] = each, live.behind
                slots[output] = len(slots)
            targets = [slots[output] for output in outputs]
            missing = tuple(streamable_of(type(each)).missing(each) for each in headers)
            self._runners.append(_Runner(self, live, state, inputs, targets, missing, refused))
        self._payloads: list[Any] = [None] * len(slots)
        self._taps = [(slots[tap.output], behind[tap.output], tap.receive) for tap in taps]
        longest = max((delay for _, delay, _ in self._taps), default=0)
        self._frames: deque[Frame] = deque(maxlen=longest + 1)
        self._steps = [runner.step() for runner in self._runners]
        self.count = 0

    def push(self, frame: Frame) -> None:
        """Compute a frame, which follows the one before without a gap.

        Raises
        ------
        NodegraphError
            If a step fails.
        """
        payloads, frames = self._payloads, self._frames
        payloads[0] = frame.payload
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
        rest: dict[int, list[Any]] = {0: []}
        for runner in self._runners:
            rest.update(runner.drain(rest))
        frames = list(self._frames)
        for slot, _, receive in self._taps:
            last = frames[len(frames) - len(rest[slot]) :]
            for (index, captured, arrived, _), payload in zip(last, rest[slot], strict=True):
                receive(Frame(index, captured, arrived, payload))


class _Input:
    """What a port takes: the newest payload of an output, or the one some frames before it."""

    def __init__(self, slot: int, delay: int) -> None:
        self.slot = slot
        self._delay = delay
        self.waiting: deque[Any] = deque()

    def take(self, payloads: list[Any]) -> Any:
        """Return the payload that is due, or None if there is none yet."""
        payload = payloads[self.slot]
        if not self._delay or payload is None:
            return payload
        self.waiting.append(payload)
        return self.waiting.popleft() if len(self.waiting) > self._delay else None


class _Runner:
    """One step at work: from the payloads of its inputs to those of its outputs.

    Parameters
    ----------
    engine
        Counts the frames.
    live, state
    inputs
        For each port that takes frames; None for an open one.
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
        inputs: Sequence[_Input | None],
        targets: Sequence[int],
        missing: tuple[Any, ...],
        refused: Counter[str],
    ) -> None:
        self._engine = engine
        self._live = live
        self._state = state
        self._inputs = inputs
        self._targets = targets
        self._missing = missing
        self._refused = refused
        self._splits = live.step.method.node.splits

    def step(self) -> Callable[[list[Any]], None]:
        """Return what computes the step in one frame; for one input and one output, without loops.

        It is made once: in a second's frames, each look-up of an attribute counts.
        """
        push, failed = self._state.push, self._failed
        inputs, targets = self._inputs, self._targets
        fed = [each for each in inputs if each is not None]

        if len(inputs) == len(targets) == 1 and not self._splits:
            source, target = fed[0].slot, targets[0]

            def straight(payloads: list[Any]) -> None:
                payload = payloads[source]
                if payload is not None:
                    try:
                        payloads[target] = push(payload)
                    except Exception as error:
                        payloads[target] = failed(error)

            return straight

        def step(payloads: list[Any]) -> None:
            row = [None if each is None else each.take(payloads) for each in inputs]
            if sum(payload is not None for payload in row) < len(fed):
                return
            try:
                result = push(*row)
            except Exception as error:
                result = failed(error)
            if result is not None:
                for target, payload in zip(
                    targets, result if self._splits else (result,), strict=True
                ):
                    payloads[target] = payload

        return step

    def drain(self, rest: Mapping[int, list[Any]]) -> dict[int, list[Any]]:
        """Return the last payloads of each output, from those of the inputs."""
        columns = [
            repeat(None) if each is None else [*each.waiting, *rest[each.slot]]
            for each in self._inputs
        ]
        count = min(len(column) for column in columns if isinstance(column, list))
        results = []
        for row in islice(zip(*columns, strict=False), count):
            try:
                result = self._state.push(*row)
            except Exception as error:
                result = self._failed(error)
            if result is not None:
                results.append(result)
        try:
            results += self._state.drain()
        except Exception as error:
            raise self._error(error) from error
        rows = results if self._splits else [(result,) for result in results]
        return {
            target: [row[position] for row in rows] for position, target in enumerate(self._targets)
        }

    def _failed(self, error: Exception) -> Any:
        """Return the payload of a frame that the step refuses, None if none is due yet."""
        if not isinstance(error, Refusal):
            raise self._error(error) from error
        self._refused[f"{self._live.step.name}: {message_of(error)}"] += 1
        if self._engine.count < self._live.behind:
            return None
        return self._missing if self._splits else self._missing[0]

    def _error(self, error: Exception) -> NodegraphError:
        outcome = failure(self._live.step.method.node, error)
        return NodegraphError(
            f"{self._live.step.name}: frame {self._engine.count} of the stream: {outcome.message}"
        )


def _state(
    live: LiveStep, headers: Mapping[Output, Any], values: Mapping[Output, Any]
) -> LiveState:
    node = live.step.method.node
    ports = {port: headers[live.streams[port]] for port in node.streams if port in live.streams}
    whole = {port: values[output] for port, output in live.values.items()}
    try:
        return live_state(node, ports, whole, live.step.settings)
    except Exception as error:
        outcome = failure(node, error, "its live form")
        raise NodegraphError(f"{live.step.name}: {outcome.message}") from error
