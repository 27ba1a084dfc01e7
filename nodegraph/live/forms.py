"""Live forms at work: what takes frame after frame, and the whole take computed by it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import repeat
from typing import Any

import numpy as np

from nodegraph.errors import NodegraphError, listed
from nodegraph.execute.call import values_of
from nodegraph.live.running_numbers import RunningStream
from nodegraph.node.decorator import Node
from nodegraph.node.live_form import (
    FrameForm,
    LiveState,
    RunningForm,
    StateForm,
    Window,
    WindowForm,
)
from nodegraph.plugin.formats import current_registry
from nodegraph.plugin.streaming import Streamable


def streamable_of(kind: type) -> Streamable:
    """Return how values of a type are split into frames.

    Raises
    ------
    NodegraphError
        If no plugin says how.
    """
    hooks = current_registry().hooks
    known = hooks.kind(kind, "stream")
    if known is not None and known.stream is not None:
        return known.stream()
    names = listed(sorted(each.type.__name__ for each in hooks.having("stream"))) or "none"
    raise NodegraphError(
        f"values of type {kind.__name__} cannot be streamed; there is {names} (plugins add types "
        "by the hook nodegraph_kinds)"
    )


def live_state(
    node: Node,
    headers: Mapping[str, object],
    values: Mapping[str, object],
    settings: Mapping[str, object],
) -> LiveState:
    """Return the state that computes a node frame by frame.

    Parameters
    ----------
    node
        One with a live form.
    headers
        For each port that takes frames, the value without frames.
    values
        The values of other ports.
    settings
        All of them, defaults included.
    """
    if isinstance(node.live, FrameForm):
        return _FrameState(node, headers, {**values, **settings})
    if isinstance(node.live, WindowForm):
        (header,) = headers.values()
        return _WindowState(node.live, header, {**values, **settings}, settings)
    assert node.live is not None
    if isinstance(node.live, RunningForm):
        return RunningStream(node.live, node.live.state(**headers, **values, **settings))
    return node.live.state(**headers, **values, **settings)


def fold(form: WindowForm | StateForm, *streams: object, **rest: object) -> Any:
    """Compute a whole take by a live form, so that the two cannot differ.

    Parameters
    ----------
    form
        The live form of the node.
    *streams
        The values at the ports that take frames, in their order; None for an open one.
    **rest
        The values of other ports, and all settings.

    Returns
    -------
    value, or tuple of values
        The output; of a node with several outputs, each.

    Examples
    --------
    >>> @node("smooth.mean", lookahead=half, live=MEAN)
    ... def mean(recording: Trajectories, *, order: int = 3) -> Trajectories:
    ...     return fold(MEAN, recording, order=order)
    """
    headers = [value if value is None else header_of(value) for value in streams]
    state: LiveState
    if isinstance(form, WindowForm):
        state = _WindowState(form, headers[0], rest, rest)
    elif form.streams:
        state = form.state(**dict(zip(form.streams, headers, strict=True)), **rest)
    else:
        state = form.state(*headers, **rest)
    taken = list(results(state, rows_of(streams)))
    if not isinstance(state.header, tuple):
        return streamable_of(type(state.header)).join(state.header, taken)
    columns = list(zip(*taken, strict=True)) or [()] * len(state.header)
    return tuple(
        streamable_of(type(header)).join(header, column)
        for header, column in zip(state.header, columns, strict=True)
    )


def header_of(value: object) -> object:
    """Return a value without its frames."""
    return streamable_of(type(value)).header(value)


def rows_of(values: Iterable[object]) -> Iterator[tuple[object, ...]]:
    """Yield for each frame the payloads of several values, None for one that is None.

    Raises
    ------
    ValueError
        If they differ in their number of frames.
    """
    columns = [None if each is None else streamable_of(type(each)).split(each) for each in values]
    lengths = {len(column) for column in columns if column is not None}
    if len(lengths) != 1:
        raise ValueError(f"the inputs have {listed(map(str, sorted(lengths)))} frames; they differ")
    for frame in range(*lengths):
        yield tuple([None if column is None else column[frame] for column in columns])


def results(state: LiveState, rows: Iterable[tuple[object, ...]]) -> Iterator[object]:
    """Yield the results of a state for all frames of a stream from its start."""
    for row in rows:
        result = state.push(*row)
        if result is not None:
            yield result
    yield from state.drain()


class _FrameState:
    """Calls a node's function with values of one frame."""

    def __init__(
        self, node: Node, headers: Mapping[str, object], rest: Mapping[str, object]
    ) -> None:
        self._node = node
        self._rest = rest
        self._inputs = [
            (name, header, streamable_of(type(header)).join) for name, header in headers.items()
        ]
        missing = [streamable_of(type(each)).missing(each) for each in headers.values()]
        outputs = self._call(missing)
        self._splits = [streamable_of(type(output)).split for output in outputs]
        each = tuple(map(header_of, outputs))
        self.header = each if node.splits else each[0]

    def push(self, *payloads: object) -> object:
        outputs = self._call(payloads)
        if not self._node.splits:
            return self._splits[0](outputs[0])[0]
        return tuple(split(value)[0] for split, value in zip(self._splits, outputs, strict=True))

    def drain(self) -> Iterable[object]:
        return ()

    def _call(self, payloads: Iterable[object]) -> tuple[object, ...]:
        fed = [payload for payload in payloads if payload is not None]
        inputs = {
            name: join(header, [payload])
            for (name, header, join), payload in zip(self._inputs, fed, strict=True)
        }
        return values_of(self._node, self._node.function(**inputs, **self._rest))


class _WindowState:
    """Holds the frames around one, and calls a window function with them.

    Every frame is written twice, a window's length apart, so that each window lies in one piece.
    """

    def __init__(
        self,
        form: WindowForm,
        header: object,
        rest: Mapping[str, object],
        settings: Mapping[str, object],
    ) -> None:
        before, after = (
            count(settings) if callable(count) else count for count in (form.before, form.after)
        )
        if before is None or after is None:
            raise NodegraphError("its window is unbounded with these settings")
        self.header = header
        self._function = form.function
        self._rest = rest
        self._after = after
        self._missing = streamable_of(type(header)).missing(header)
        self._length = before + 1 + after
        parts = self._missing if isinstance(self._missing, tuple) else (self._missing,)
        self._rings = [
            None if part is None else np.repeat(np.asarray(part)[None], 2 * self._length, axis=0)
            for part in parts
        ]
        self._windows = [
            Window(self._view(slot + 1), before, header) for slot in range(self._length)
        ]
        self._slot = -1
        self._ahead = after
        """Number of frames still needed before the first result."""

    def push(self, payload: object) -> object:
        slot = self._slot = (self._slot + 1) % self._length
        parts = payload if isinstance(payload, tuple) else (payload,)
        for ring, part in zip(self._rings, parts, strict=True):
            if ring is not None:
                ring[slot] = part
                ring[slot + self._length] = part
        if self._ahead:
            self._ahead -= 1
            return None
        return self._function(self._windows[slot], **self._rest)

    def drain(self) -> Iterable[object]:
        # no generator, which would end where the function refuses a frame
        results = map(self.push, repeat(self._missing, self._after))
        return filter(lambda result: result is not None, results)

    def _view(self, start: int) -> object:
        parts = [
            None if ring is None else ring[start : start + self._length] for ring in self._rings
        ]
        kind = type(self._missing)
        return kind(*parts) if isinstance(self._missing, tuple) else parts[0]
